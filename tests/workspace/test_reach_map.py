"""What a map answers, and that its file comes back as it went, or is refused."""

from __future__ import annotations

import contextlib
import io
import pickle
import re
import zipfile
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.kernels.reaching import configurations
from nao_kin.workspace.sampling import samples_of
from tests.conftest import needs, robot

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


@pytest.fixture(scope="module")
def reach() -> nk.ReachMap:
    return nk.reachability(robot("nao").chain("left_arm"), 30_000, voxel=0.02)


def test_it_contains_its_own_samples_and_nothing_else(reach: nk.ReachMap) -> None:
    chain = robot("nao").chain("left_arm")
    tips = chain.poses(configurations(samples_of(chain), 0, 30_000))[:, :3, 3]
    assert reach.share(tips) == 1.0
    assert reach.contains(reach.centres).all()
    assert len(reach.centres) == int(reach.reached.sum())
    low, high = reach.extent
    assert (low <= tips.min(axis=0)).all()
    assert (high >= tips.max(axis=0)).all()
    assert (tips.min(axis=0) - low <= reach.voxel).all()
    assert (high - tips.max(axis=0) <= reach.voxel).all()
    everywhere = np.stack(np.meshgrid(*[np.arange(-0.5, 0.5, 0.02) + 0.01] * 3), axis=-1).reshape(-1, 3)
    assert reach.contains(everywhere).sum() == reach.reached.sum()
    assert reach.volume == pytest.approx(reach.contains(everywhere).sum() * 0.02**3)
    assert reach.measured(everywhere, "counts").sum() == reach.samples == 30_000


def test_one_point_gives_one_answer_and_far_ones_are_outside(reach: nk.ReachMap) -> None:
    assert reach.contains(reach.centres[0]).shape == ()
    assert bool(reach.contains(reach.centres[0]))
    assert not reach.contains([[1e300, 0.0, 0.0], [-5.0, 0.0, 0.0]]).any()
    assert reach.measured([9.0, 9.0, 9.0]) == 0.0
    assert reach.share([[9.0, 9.0, 9.0], reach.centres[0]]) == 0.5


@pytest.mark.parametrize("points", [[0.0, 1.0], [[np.nan, 0.0, 0.0]], "abc", [[[0.0, 0.0, 0.0]]]])
def test_what_is_no_point_is_refused(reach: nk.ReachMap, points: Any) -> None:
    with pytest.raises(nk.NaoKinError, match="points: expected"):
        reach.contains(points)


def test_no_points_have_no_share_and_no_measure_has_no_layer(reach: nk.ReachMap) -> None:
    with pytest.raises(nk.NaoKinError, match="at least one point"):
        reach.share(np.zeros((0, 3)))
    with pytest.raises(nk.NaoKinError, match="layer: expected"):
        reach.layer("best")  # type: ignore[arg-type]
    bare = nk.reachability(robot("nao").chain("left_arm"), 1000, measure="none")
    assert bare.unit == ""
    with pytest.raises(nk.NaoKinError, match="without a measure"):
        bare.layer("mean")
    assert bare.plot() is not None


def test_it_says_itself_in_numbers(reach: nk.ReachMap) -> None:
    text = reach._repr_html_()
    for part in ("LArm", "torso", "30000", "0.02 m", "m³/rad³"):
        assert part in text
    assert "nao_v50_h25 left_arm" in repr(reach)


@pytest.mark.parametrize("measure", ["manipulability", "smallest_singular_value", "none"])
def test_a_saved_map_comes_back_to_the_last_bit(measure, tmp_path: Path) -> None:
    reach = nk.reachability(robot("nao").chain("left_arm"), 5000, measure=measure, axes="xy", sampling="even", seed=8)
    back = nk.ReachMap.load(reach.save(tmp_path / "reach.map"))
    assert back.same_as(reach)
    assert back.contains(reach.centres).all()


def saved(reach: nk.ReachMap, path: Path, **changed: Any) -> Path:
    with np.load(reach.save(path)) as file:
        fields = {name: file[name] for name in file.files} | changed
    with path.open("wb") as file:
        np.savez(file, **{name: value for name, value in fields.items() if value is not None})
    return path


def negative(counts: np.ndarray) -> np.ndarray:
    return np.where(counts == counts.max(), -1, counts)


@pytest.mark.parametrize(
    ("field", "change", "said"),
    [
        ("counts", lambda _: None, "expected the arrays"),
        ("counts", lambda a: a[0], "counts in .*: expected numbers (nx, ny, nz)"),
        ("counts", lambda a: a.astype(float), "counts in"),
        ("counts", negative, "counts ≥ 0"),
        ("counts", lambda a: np.pad(a, 1), "some on every side"),
        ("counts", lambda a: a * 0, "some on every side"),
        ("counts", lambda _: np.array([os_system()], dtype=object), "counts in"),
        ("mean", lambda a: a[:-1], "as counts"),
        ("mean", lambda a: a * np.nan, "finite numbers"),
        ("greatest", lambda a: a - 1.0, "finite numbers"),
        ("voxel", lambda _: np.float64(0.0), "voxel in"),
        ("voxel", lambda _: np.float64(np.inf), "voxel in"),
        ("voxel", lambda a: a[None], "voxel in .*: expected a number"),
        ("corner", lambda a: a[:2], "corner in .*: expected 3 whole numbers"),
        ("corner", lambda a: a + 2**40, "not farther"),
        ("seed", lambda _: np.int64(-1), "seed in"),
        ("measure", lambda _: np.array("beauty"), "measure in"),
        ("sampling", lambda _: np.array("dice"), "sampling in"),
        ("axes", lambda _: np.array("w"), "axes in"),
        ("chain", lambda _: np.array("x" * 2000), "chain in .*: expected a short text"),
        ("chain", lambda _: np.array("\ud800"), "chain in .*: expected text that is Unicode"),
        ("unit", lambda _: np.array("\udfff"), "unit in .*: expected text that is Unicode"),
        ("counts", lambda a: np.where(a > 0, 2**62, 0), "counts in .*: expected counts ≥ 0, at most 2147483647 in all"),
        ("voxel", lambda _: np.float64(1e300), "voxel in"),
        ("format", lambda _: np.int64(2), "format in .*: expected version 1"),
    ],
)
def test_a_file_that_contradicts_itself_is_refused(reach, field, change: Callable[[Any], Any], said, tmp_path) -> None:
    with np.load(reach.save(tmp_path / "good.npz")) as file:
        value = file[field]
    path = saved(reach, tmp_path / "bad.npz", **{field: change(value)})
    with pytest.raises(nk.NaoKinError, match=said.replace("(", r"\(").replace(")", r"\)")):
        nk.ReachMap.load(path)


class os_system:  # noqa: N801 - what a pickle would run
    def __reduce__(self) -> tuple[Any, ...]:
        return exec, ("raise SystemExit('executed')",)


def with_counts(reach: nk.ReachMap, path: Path, content: bytes) -> Path:
    """A saved map whose counts are these bytes."""
    original = io.BytesIO(reach.save(path).read_bytes())
    with zipfile.ZipFile(original) as before, zipfile.ZipFile(path, "w") as after:
        for entry in before.namelist():
            after.writestr(entry, content if entry == "counts.npy" else before.read(entry))
    return path


def test_text_beyond_unicode_is_refused(reach: nk.ReachMap, tmp_path: Path) -> None:
    raw = np.array([2**32 - 1], dtype="<u4").view("<U1")[0:1].reshape(())
    with pytest.raises(nk.NaoKinError, match=r"bad\.npz"):
        nk.ReachMap.load(saved(reach, tmp_path / "bad.npz", chain=raw))


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_damage_is_refused_or_read_but_never_more(reach: nk.ReachMap, method: int, tmp_path: Path) -> None:
    path, packed = reach.save(tmp_path / "good.npz"), io.BytesIO()
    with zipfile.ZipFile(path) as before, zipfile.ZipFile(packed, "w", method) as after:
        for entry in before.namelist():
            after.writestr(entry, before.read(entry))
    for seed in range(60):
        content = bytearray(packed.getvalue())
        for at in np.random.default_rng(seed).integers(0, len(content), 3):
            content[at] ^= 0x5A
        path.write_bytes(content)
        with contextlib.suppress(nk.NaoKinError):
            nk.ReachMap.load(path)


def header(shape: str, kind: str = "<i8", version: bytes = b"\x01\x00") -> bytes:
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode().ljust(117) + b"\n"
    return b"\x93NUMPY" + version + len(text).to_bytes(2, "little") + text


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"not an array",
        header("(4096, 4096, 4096)"),
        header("(-4, -4, 4)"),
        header("(4, 4, 4)"),
        header("(4, 4, 4)", "|O") + pickle.dumps(os_system()),
        header("(4, 4, 4)", version=b"\x03\x00"),
        header("__import__('os').abort()"),
        header("("),
        header("(" * 5000),
        header("-" * 9000 + "1"),
    ],
)
def test_a_hostile_array_is_refused_before_memory_is_asked_for(reach: nk.ReachMap, content: bytes, tmp_path) -> None:
    path = with_counts(reach, tmp_path / "bad.npz", content)
    with pytest.raises(nk.NaoKinError, match=r"bad\.npz"):
        nk.ReachMap.load(path)


def test_what_is_no_archive_is_refused(reach: nk.ReachMap, tmp_path: Path) -> None:
    path = tmp_path / "reach.npz"
    whole = reach.save(path).read_bytes()
    for content in (b"", b"hello", whole[: len(whole) // 2], whole[:200] + b"\xff" * 300 + whole[500:]):
        path.write_bytes(content)
        with pytest.raises(nk.NaoKinError, match=r"reach\.npz"):
            nk.ReachMap.load(path)
    with pytest.raises(FileNotFoundError):
        nk.ReachMap.load(tmp_path / "none.npz")


def test_its_picture_has_axes_units_and_a_legend(reach: nk.ReachMap, tmp_path: Path) -> None:
    needs("matplotlib")
    for figure, unit in ((reach.plot(), "m³/rad³"), (reach.plot("counts", through=reach.centres[50]), "1")):
        *views, bar = figure.axes
        labels = [(axes.get_xlabel(), axes.get_ylabel()) for axes in views]
        assert labels == [("x [m]", "y [m]"), ("x [m]", "z [m]"), ("y [m]", "z [m]")]
        assert f"[{unit}]" in bar.get_ylabel()
        assert [text.get_text() for text in figure.legends[0].get_texts()] == ["origin of torso"]
        figure.savefig(tmp_path / "reach.png")
        assert (tmp_path / "reach.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(nk.NaoKinError, match="through: expected a point between"):
        reach.plot(through=[5.0, 0.0, 0.0])


def test_its_picture_shows_the_layers(reach: nk.ReachMap) -> None:
    needs("matplotlib")
    for across, image in zip(((0, 1), (0, 2), (1, 2)), [a.images[0] for a in reach.plot().axes[:3]], strict=True):
        (along,) = {0, 1, 2} - set(across)
        shown = np.ma.filled(image.get_array(), 0.0).T
        np.testing.assert_array_equal(np.nan_to_num(shown), reach.greatest.max(axis=along))
    sums = np.nan_to_num(np.ma.filled(reach.plot("counts").axes[0].images[0].get_array(), 0.0)).T
    np.testing.assert_array_equal(sums, reach.counts.sum(axis=2))


def test_its_fields_cannot_be_set(reach: nk.ReachMap) -> None:
    with pytest.raises(AttributeError, match=re.escape("voxel")):
        reach.voxel = 1.0  # type: ignore[misc]
