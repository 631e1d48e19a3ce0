"""Maps against what the chain's own kinematics says of the same configurations, and against areas known in advance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numba
import numpy as np
import pytest

import nao_kin as nk
from nao_kin.kernels.reaching import configurations
from nao_kin.workspace import mapping
from nao_kin.workspace.sampling import samples_of
from tests.conftest import robot
from tests.kernels.paths import odd_robot

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.chain import Chain

SAMPLES = 3000


def planar_arm(first: float, second: float) -> nk.DHChain:
    """Two links in the plane z = 0, both joints all around."""
    rows = [{"a": a, "alpha": 0.0, "d": 0.0, "theta": 0.0, "lower": -np.pi, "upper": np.pi} for a in (first, second)]
    return nk.DHChain.from_table(rows, "standard", name="planar")


def chain_of(name: str, folder: Path) -> Chain:
    model, _, frames = name.partition(":")
    return odd_robot(folder).chain("base", "tip") if model == "odd" else robot(model).chain(*frames.split(":"))


def manipulability(J: np.ndarray) -> float:
    return float(np.prod(np.linalg.svd(J)[1])) if J.shape[1] >= J.shape[0] else 0.0


def smallest(J: np.ndarray) -> float:
    return float(np.linalg.svd(J)[1].min()) if J.shape[1] >= J.shape[0] else 0.0


@pytest.mark.parametrize(
    "name", ["nao:left_arm", "nao:torso:CameraTop_frame", "nao:right_leg", "jaco2:arm", "phantomx:leg_lf", "odd"]
)
@pytest.mark.parametrize(
    ("measure", "axes", "oracle"),
    [("manipulability", "xyz", manipulability), ("smallest_singular_value", "xyz", smallest),
     ("manipulability", "xz", manipulability), ("smallest_singular_value", "y", smallest)],
)  # fmt: skip
def test_cubes_hold_what_the_chain_says_of_the_same_configurations(name, measure, axes, oracle, tmp_path: Path) -> None:
    chain, rows = chain_of(name, tmp_path), ["xyz".index(axis) for axis in axes]
    reach = nk.reachability(chain, SAMPLES, measure=measure, axes=axes, seed=4)
    found: dict[tuple[int, ...], list[float]] = {}
    faces = 1.0
    for q in configurations(samples_of(chain, seed=4), 0, SAMPLES):
        place = chain.pose(q).translation / reach.voxel
        faces = min(faces, np.abs(place - np.round(place)).min())
        found.setdefault(tuple(np.floor(place).astype(int)), []).append(oracle(chain.jacobian(q)[rows]))
    assert faces > 1e-9, "a sample on a face of a cube may fall on either side: take another seed"
    assert int(reach.reached.sum()) == len(found)
    size = max(1e-3, float(reach.greatest.max()))
    for cell, values in found.items():
        index = tuple(np.array(cell) - reach.corner)
        assert reach.counts[index] == len(values)
        # From J Jᵀ a measure of 0 is rounding's square root.
        assert reach.greatest[index] == pytest.approx(max(values), abs=1e-7 * size)
        assert reach.mean[index] == pytest.approx(np.mean(values), abs=1e-7 * size)


def test_a_planar_arm_reaches_its_annulus() -> None:
    reach = nk.reachability(planar_arm(0.5, 0.3), 2_000_000, voxel=0.02, axes="xy")
    assert reach.counts.shape[2] == 1
    radius = np.linalg.norm(reach.centres[:, :2], axis=1)
    half = 0.02 / math.sqrt(2.0)
    assert radius.min() > 0.2 - half
    assert radius.max() < 0.8 + half
    grid = 0.02 * (np.mgrid[-45:45, -45:45].reshape(2, -1).T + 0.5)
    centre = np.linalg.norm(grid, axis=1)
    within = np.column_stack([grid, np.zeros(len(grid))])[(centre > 0.2 + half) & (centre < 0.8 - half)]
    assert reach.share(within) == 1.0
    area, borders = math.pi * (0.8**2 - 0.2**2), 2.0 * math.pi * (0.8 + 0.2)
    assert area < reach.volume / reach.voxel < area + 2.0 * half * borders


def test_a_planar_arms_manipulability_is_the_sine_of_its_elbow() -> None:
    arm = planar_arm(0.5, 0.3)
    reach = nk.reachability(arm, 1_000_000, voxel=0.02, axes="xy")
    # w = a₁ a₂ |sin q₂|, whose mean over a turn is 2/π; its standard error is a₁ a₂ √(1/2 − 4/π²) / √N.
    mean = float((reach.mean * reach.counts).sum() / reach.samples)
    assert mean == pytest.approx(0.15 * 2.0 / math.pi, abs=5 * 0.15 * 0.31 / 1000)
    assert reach.greatest.max() == pytest.approx(0.15, abs=1e-7)
    # By the cosine rule the radius says where the elbow stands.
    for centre, greatest in zip(reach.centres, reach.greatest[reach.reached], strict=True):
        r = np.linalg.norm(centre[:2]) + np.array([-1.0, 0.0, 1.0]) * 0.02 / math.sqrt(2.0)
        cosine = np.clip((r**2 - 0.5**2 - 0.3**2) / 0.3, -1.0, 1.0)
        best = 0.0 if cosine.min() * cosine.max() > 0.0 else 1.0  # a cube that holds a right angle
        assert greatest <= 0.15 * max(best, np.sqrt(1.0 - cosine**2).max()) + 1e-9
    assert nk.reachability(arm, 1000, axes="xyz").greatest.max() < 1e-7  # it never leaves its plane


def test_mirrored_arms_have_mirrored_maps() -> None:
    model = robot("nao")
    left, right = (nk.reachability(model.chain(f"{side}_arm"), 400_000, voxel=0.02) for side in ("left", "right"))
    mirror = np.array([1.0, -1.0, 1.0])
    for one, other in ((left, right), (right, left)):
        often = one.centres[one.counts[one.reached] >= 30]  # chance does not miss these, as it does the border
        assert other.share(often * mirror) == 1.0
    assert right.volume == pytest.approx(left.volume, rel=0.02)
    np.testing.assert_allclose(right.extent[::-1, 1] * -1.0, left.extent[:, 1], atol=0.02 + 1e-9)
    common = left.contains(right.centres * mirror)
    best = left.measured(right.centres * mirror)[common] - right.measured(right.centres)[common]
    assert np.quantile(np.abs(best), 0.9) < 0.05 * left.greatest.max()


def test_neither_chunks_nor_threads_nor_memory_for_them_change_a_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    chain = robot("nao").chain("left_arm")
    whole = nk.reachability(chain, 50_000)
    assert all(whole.same_as(nk.reachability(chain, 50_000, chunk=chunk)) for chunk in (1 + 2**15, 7777, 50_000))
    threads = numba.get_num_threads()
    try:
        numba.set_num_threads(1)
        assert whole.same_as(nk.reachability(chain, 50_000))
    finally:
        numba.set_num_threads(threads)
    monkeypatch.setattr(mapping, "_CELLS_OF_ALL_THREADS", 1)
    assert whole.same_as(nk.reachability(chain, 50_000))
    assert not whole.same_as(nk.reachability(chain, 50_000, seed=1))


def test_more_samples_only_add() -> None:
    chain = robot("nao").chain("torso", "CameraTop_frame")
    few, many = (nk.reachability(chain, samples, voxel=0.002, seed=7) for samples in (1000, 20_000))
    assert many.share(few.centres) == 1.0
    assert (many.measured(few.centres) >= few.measured(few.centres)).all()
    assert (many.measured(few.centres, "counts") >= few.measured(few.centres, "counts")).all()


def test_a_sliding_joint_alone_has_a_map_and_one_without_end_has_none() -> None:
    row = {"a": 0.0, "alpha": 0.0, "d": 0.0, "theta": 0.0, "kind": "prismatic"}
    ended = nk.DHChain.from_table([row | {"lower": -0.1, "upper": 0.3}], "standard")
    reach = nk.reachability(ended, 10_000, voxel=0.01, axes="z")
    assert reach.extent[:, 2].tolist() == pytest.approx([-0.1, 0.3])
    assert (reach.greatest[reach.reached] == 1.0).all()
    assert reach.unit == "1"
    with pytest.raises(nk.NaoKinError, match="limits for every sliding joint"):
        nk.reachability(nk.DHChain.from_table([row], "standard"), 1000)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"samples": 0}, "samples: expected a whole number from 1"),
        ({"samples": 1.5}, "samples: expected"),
        ({"samples": 2**31}, "samples: expected"),
        ({"chunk": 0}, "chunk: expected"),
        ({"voxel": 0.0}, "voxel: expected a finite number > 0"),
        ({"voxel": math.nan}, "voxel: expected"),
        ({"voxel": 1e-4}, "voxel: expected at least 0.00"),
        ({"voxel": 1e-300}, "voxel: expected at least"),
        ({"measure": "manipulabilty"}, "Did you mean 'manipulability'"),
        ({"axes": "zx"}, "axes: expected some of x, y and z"),
        ({"axes": ""}, "axes: expected"),
        ({"client": object()}, "client: expected a distributed.Client, got object"),
    ],
)
def test_what_makes_no_sense_is_refused_by_name(wrong: dict[str, object], said: str) -> None:
    with pytest.raises(nk.NaoKinError, match=said):
        nk.reachability(robot("nao").chain("left_arm"), **({"samples": 100} | wrong))  # type: ignore[arg-type]


def test_the_voxel_that_a_refusal_names_will_do() -> None:
    chain = robot("nao").chain("torso", "CameraTop_frame")
    with pytest.raises(nk.NaoKinError) as refused:
        nk.reachability(chain, 10, voxel=1e-5)
    least = float(str(refused.value).split("least ")[1].split(" ")[0])
    assert nk.reachability(chain, 10, voxel=least).samples == 10


def test_a_tip_that_stays_needs_a_voxel() -> None:
    row = {"a": 0.0, "alpha": 0.0, "d": 0.0, "theta": 0.0}
    chain = nk.DHChain.from_table([row], "standard")
    with pytest.raises(nk.NaoKinError, match="stays in one place"):
        nk.reachability(chain, 10)
    assert nk.reachability(chain, 10, voxel=0.1).volume == pytest.approx(1e-3)
