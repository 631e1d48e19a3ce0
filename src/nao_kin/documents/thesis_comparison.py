"""Bischoff 2016, sections 3.4, 3.5, 4.1 and 4.2: what it says of the methods, held against small samples of them."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.documents.claim import Measured
from nao_kin.documents.samples import derivative, relative
from nao_kin.documents.thesis_arms import arm_configurations, described_arm, nao, robot_arm
from nao_kin.documents.thesis_inverse import left_pipeline_corrected
from nao_kin.documents.thesis_inverse_checks import best_candidate
from nao_kin.documents.thesis_methods import JACOBIAN, TARGETS, far, near
from nao_kin.ik.methods import METHODS
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.single import solve
from nao_kin.ik.target import Target
from nao_kin.robot.robot import load

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.thesis_methods import Record


COUNT, _SEED = 25, 350
COUNTED: Final = "iterations of the reference loop; `nao-kin bench methods` measures time"
_NEAR: Final = f"{TARGETS} positions of the NAO's left hand, start within 0.2 rad in each joint"
_FAR: Final = f"{TARGETS} positions of the NAO's left hand from any other posture, one start, up to 300 iterations"
_MEASURED: Final = "What a method needs is measured and has no formula to correct."


def least_work() -> str:
    """Section 3.5: what takes the least computing time."""
    return "closed form"


def fastest() -> str:
    """Section 3.5: the fastest of the iterative methods."""
    return "fabrik"


def fastest_corrected() -> str:
    """The one with the fewest iterations on these targets."""
    return "lm"


def ratio() -> float:
    """Section 3.5, quoting Aristidou and Lasenby: methods on the Jacobian take so many times as long as FABRIK."""
    return 1000.0


def ahead_of_fabrik() -> tuple[str, ...]:
    """Section 4.1: methods on the Jacobian that FABRIK does not equal."""
    return ()


def better_than_shown() -> tuple[str, ...]:
    """Section 4.2: of follow-the-leader and CCD, those that are not inferior to the methods shown."""
    return ()


def whole_body_method() -> str:
    """Section 4.1: the best candidate for the whole body."""
    return "fabrik"


def fabrik_refuses(robot: str, chain: str, kind: str) -> bool:
    """Section 3.5: whether FABRIK refuses a chain or a kind of target."""
    return _refused("fabrik", robot, chain, kind)


def jacobian_refuses(robot: str, chain: str, kind: str) -> bool:
    """Section 3.5: the same of a method on the Jacobian."""
    return _refused("lm", robot, chain, kind)


def _refused(method: str, robot: str, chain: str, kind: str) -> bool:
    path = load(robot).chain(chain)
    T = path.pose(np.zeros(len(path.joints)))
    target = Target.of(T if kind == "pose" else T.translation)
    return METHODS[method].refusal(path, target) is not None


def fixed_base(_T_base_hand: Floats, _T_base_torso: Floats) -> Floats | None:
    """Section 4.1: with another base than the torso there is no closed form."""
    return None


def moved_base(T_base_hand: Floats, T_base_torso: Floats) -> Floats:
    """The target seen from the torso, T_torso_base T_base_hand."""
    return np.asarray(np.linalg.inv(T_base_torso) @ T_base_hand)


def damped_step(J: Floats, e: Floats, damping: float) -> Floats:
    """Section 4.2: damped least squares extends the Jacobian method; its step."""
    return np.asarray(J.T @ np.linalg.solve(J @ J.T + damping**2 * np.eye(3), e))


def _told(records: dict[str, Record], what: Callable[[Record], str]) -> str:
    parts = [f"{name} {what(record)}" for name, record in records.items()]
    return ", ".join(parts) + "."


def direct(form: Form) -> Measured:
    """How many ways to the joints take no more iterations than the one named; the closed form takes none."""
    counts = {"closed form": 0.0} | {name: record.iterations for name, record in near().items()}
    before = [name for name, count in counts.items() if count <= counts[form()] and name != form()]
    least = min(record.iterations for record in near().values())
    return Measured(float(len(before)), TARGETS, ", ".join(before), f"Iterative methods take {least:.0f} or more.")


def fewest(form: Form) -> Measured:
    """How many methods take fewer iterations than the one named."""
    records = near()
    before = [name for name, record in records.items() if record.iterations < records[form()].iterations]
    return Measured(float(len(before)), TARGETS, ", ".join(before), _told(records, lambda r: f"{r.iterations:.0f}"))


def times_as_long(form: Form) -> Measured:
    """How many methods do not take that many times FABRIK's iterations."""
    records = near()
    ratios = {name: records[name].iterations / records["fabrik"].iterations for name in JACOBIAN}
    short = [name for name, value in ratios.items() if value < form()]
    told = ", ".join(f"{name} {value:.2g}" for name, value in ratios.items())
    return Measured(float(len(short)), len(ratios), ", ".join(short), f"Iterations against fabrik: {told}.")


def more_iterations(form: Form) -> Measured:
    """How many methods on the Jacobian take fewer iterations than FABRIK."""
    records = near()
    fewer = [name for name in JACOBIAN if records[name].iterations < records[form()].iterations]
    return Measured(float(len(fewer)), TARGETS, ", ".join(fewer), _told(records, lambda r: f"{r.iterations:.0f}"))


def moves_least(form: Form) -> Measured:
    """By which part the joints move farther than with the method that moves them least."""
    records = far()
    least = min(record.moved for record in records.values())
    moved = records[form()].moved
    return Measured(moved / least - 1.0, TARGETS, found=_told(records, lambda r: f"{r.moved:.2f} rad"))


def ahead(form: Form) -> Measured:
    """Methods on the Jacobian with at least as many targets in fewer iterations, nearby or far, that are not named."""
    ahead = {
        name
        for records in (near(), far())
        for name in JACOBIAN
        if records[name].solved >= records["fabrik"].solved and records[name].iterations < records["fabrik"].iterations
    }
    told = [_told(r, lambda x: f"{x.solved}/{x.iterations:.0f}") for r in (near(), far())]
    found = f"Reached of {TARGETS} / iterations, near: {told[0]}\nFar: {told[1]}"
    missed = ahead ^ set(form())
    return Measured(float(len(missed)), TARGETS, ", ".join(sorted(missed)), found)


def ahead_of_fabrik_corrected() -> tuple[str, ...]:
    """On these targets."""
    return ("pinv", "newton", "dls", "sdls", "tsvd", "lm")


def not_inferior(form: Form) -> Measured:
    """Those of the two that reach clearly more than the best of transpose, pseudo-inverse and FABRIK.

    Clearly: by more than two standard deviations of the difference of two such counts.
    """
    records = far()
    best = max(records[name].solved for name in ("transpose_buss", "pinv", "fabrik"))
    chance = 2.0 * math.sqrt(2.0 * best * (1.0 - best / TARGETS))
    better = {name for name in ("ftl", "ccd") if records[name].solved > best + chance}
    missed = better ^ set(form())
    told = _told(records, lambda r: f"{r.solved}")
    found = f"Reached of {TARGETS}: {told} Up to {chance:.1f} more than another is chance."
    return Measured(float(len(missed)), TARGETS, ", ".join(sorted(missed)), found)


def at_the_edge(form: Form) -> Measured:
    """Elbow straightened to its limit and to 10⁻³ and 10⁻⁵ rad: the hand as far out as it gets."""
    arm, worst, lines = described_arm("left"), list[float](), list[str]()
    for bend in (math.radians(2.0), 1e-3, 1e-5):
        errors = []
        for q in arm_configurations("left", COUNT, _SEED):
            q[3] = -bend
            errors.append(best_candidate(form, arm, arm.pose(q), arm.pose)[0])
        lines.append(f"{bend:.2g} rad: {1000.0 * max(errors):.2g} mm")
        worst += errors
    far_out = arm.pose(np.zeros(4))
    far_out[0, 3] += 1e-6
    mm = [1000.0 * x for x in (arm.l1, arm.l3, arm.l4)]
    far_out[:3, 3] *= 1000.0
    beyond = np.isfinite(form(far_out, 1000.0 * arm.shoulder, *mm)).all(axis=1).any()
    tail = "has candidates" if beyond else "has no candidate at all"
    return Measured.worst(
        worst, found=f"Hand off by at most, bent by {', '.join(lines)}.\nA target 1 μm too far {tail}."
    )


def on_the_other_arm(form: Form) -> Measured:
    """Share of the right arm's targets that the left arm's equations solve."""
    arm, solved = described_arm("right"), 0
    for q in arm_configurations("right", COUNT, _SEED):
        far_off, turned = best_candidate(form, arm, arm.pose(q), arm.pose)
        solved += far_off <= 1e-6 and turned <= 1e-6
    return Measured(solved / COUNT, COUNT, found=f"{solved} of {COUNT} targets of the right arm solved.")


_CHAINS: Final = (
    *(("nao_v50_h25", name) for name in ("left_arm", "right_arm", "left_leg", "right_leg", "head")),
    ("jaco2", "arm"),
    ("phantomx", "leg_lf"),
)


def refusals(kinds: tuple[str, ...]) -> Check:
    """A check of the share of chains and kinds of target refused."""

    def check(form: Form) -> Measured:
        cases = [(robot, chain, kind) for robot, chain in _CHAINS for kind in kinds]
        refused = [case for case in cases if form(*case)]
        where = ", ".join(sorted({kind for _, _, kind in refused})) or "none"
        return Measured(
            len(refused) / len(cases), len(cases), found=f"{len(refused)} of {len(cases)} refused: {where}."
        )

    return check


def growth(form: Form) -> Measured:
    """How the step for 1 mm along the arm grows as the elbow straightens: tenfold for a tenth of the bend."""
    arm, steps, damped = described_arm("left"), list[float](), list[float]()
    bends = (1e-2, 1e-3, 1e-4)
    for bend in bends:
        J = derivative(lambda x: arm.pose(x)[:3, 3], np.array([0.3, 0.2, 0.4, -bend]))
        e = 1e-3 * np.linalg.svd(J)[0][:, 2]
        steps.append(float(np.abs(form(J, e)).max()))
        damped.append(float(np.abs(damped_step(J, e, 1e-2)).max()))
    growth = [later / earlier / 10.0 - 1.0 for earlier, later in itertools.pairwise(steps)]
    told = "; ".join(f"{b:g} rad: {s:.3g} rad, damped {d:.2g}" for b, s, d in zip(bends, steps, damped, strict=True))
    return Measured.worst(growth, found=f"Largest joint step for 1 mm outwards, elbow bent by {told}.")


def from_the_foot(form: Form) -> Measured:
    """The left arm solved from the left sole, at random joints of the leg."""
    arm, rng, errors = described_arm("left"), np.random.default_rng(_SEED), list[float]()
    leg = nao().chain("left_leg")
    for q in arm_configurations("left", COUNT, _SEED):
        T_sole_torso = np.linalg.inv(leg.pose(rng.uniform(leg.lower, leg.upper)).homogeneous)
        T_torso_hand = form(T_sole_torso @ arm.pose(q), T_sole_torso)
        if T_torso_hand is None:
            errors.append(1.0)  # all of it is missing
            continue
        far_off, turned = best_candidate(left_pipeline_corrected, arm, T_torso_hand, arm.pose)
        errors.append(max(far_off / (arm.l3 + arm.l4), turned))
    return Measured.worst(errors)


def whole_body(form: Form) -> Measured:
    """Share of positions of the right hand, seen from the left sole, that the method does not reach."""
    chain, rng, reached = nao().chain("l_sole", "RArm"), np.random.default_rng(_SEED), 0
    Q = [rng.uniform(0.5 * chain.lower, 0.5 * chain.upper) for _ in range(20)]
    for q, q_0 in zip(Q[:10], Q[10:], strict=True):
        budget = Budget(iterations=300, restarts=0, patience=300)
        target = chain.pose(q).translation
        reached += solve(chain, target, q_0, method=form(), budget=budget, engine="reference").solved
    return Measured(1.0 - reached / 10, 10, found=f"{reached} of 10 positions reached over {len(chain.joints)} joints.")


def towards_pseudo_inverse(form: Form) -> Measured:
    """Without damping it is the pseudo-inverse's step."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for q in arm_configurations("left", COUNT, _SEED):
        J, e = robot_arm("left").jacobian(q)[:3], rng.uniform(-0.1, 0.1, 3)
        errors.append(relative(form(J, e, 0.0), np.linalg.pinv(J) @ e))
        damping = float(rng.uniform(0.01, 0.1))
        stacked = np.vstack([J, damping * np.eye(4)])
        errors.append(relative(form(J, e, damping), np.linalg.lstsq(stacked, np.append(e, np.zeros(4)), rcond=None)[0]))
    return Measured.worst(errors)
