"""Bischoff 2016, sections 3.4, 3.5, 4.1 and 4.2: what it says of the methods, held against small samples of them.

Work is counted in iterations, which are the same on every machine; `nao-kin bench methods` measures time.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.samples import derivative, relative
from nao_kin.documents.thesis.closed_form import best_candidate, left_pipeline_corrected
from nao_kin.documents.thesis.jacobian_methods import eq_3_2_2_1
from nao_kin.documents.thesis.thesis_arms import arm_configurations, described_arm, nao, robot_arm
from nao_kin.ik.methods import METHODS
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.single import solve
from nao_kin.ik.target import Target
from nao_kin.robot.robot import load

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.ik.problem import IKResult

__all__ = [
    "CLAIMS",
    "ITERATIVE",
    "JACOBIAN",
    "SHOWN",
    "TARGETS",
    "Record",
    "as_good_and_cheaper",
    "cheaper",
    "clearly_better",
    "extra_move",
    "far",
    "near",
    "not_so_much_dearer",
]

JACOBIAN: Final = ("transpose_buss", "pinv", "newton", "dls", "sdls", "tsvd", "lm")
"""Methods on the Jacobian; the transpose with the α of (3.2.1.2)."""

ITERATIVE: Final = (*JACOBIAN, "ccd", "ftl", "fabrik")

SHOWN: Final = ("transpose_buss", "pinv", "fabrik")
"""What the thesis calls the methods shown."""

TARGETS: Final = 25
_BUDGET: Final = Budget(iterations=300, restarts=0, patience=300)
_WITHIN: Final = 0.2  # [rad] from start to target, each joint


@dataclass(frozen=True, slots=True)
class Record:
    """What a method made of the targets, from one start each.

    Attributes:
        solved: How many it reached.
        iterations: Median iterations of those; inf if none.
        moved: Median of the largest move of a joint, of those [rad]; inf if none.
    """

    solved: int
    iterations: float
    moved: float


@cache
def near() -> dict[str, Record]:
    """Positions that a posture within 0.2 rad of the start reaches."""
    return _run(_WITHIN, 351)


@cache
def far() -> dict[str, Record]:
    """Positions of any posture from any other."""
    return _run(None, 352)


def _run(within: float | None, seed: int) -> dict[str, Record]:
    chain, rng = robot_arm("left"), np.random.default_rng(seed)
    starts = arm_configurations("left", TARGETS, seed)
    if within is None:
        ends = arm_configurations("left", TARGETS, seed + 10)
    else:
        ends = np.clip(starts + rng.uniform(-within, within, starts.shape), chain.lower, chain.upper)
    records = {}
    for method in ITERATIVE:
        results = [
            solve(chain, chain.pose(q).translation, q_0, method=method, budget=_BUDGET, engine="reference")
            for q, q_0 in zip(ends, starts, strict=True)
        ]
        moves = [float(np.abs(r.q - q_0).max()) for r, q_0 in zip(results, starts, strict=True)]
        records[method] = _record(results, moves)
    return records


def _record(results: list[IKResult], moves: list[float]) -> Record:
    good = [k for k, result in enumerate(results) if result.solved]
    if not good:
        return Record(0, float("inf"), float("inf"))
    iterations = float(np.median([results[k].iterations for k in good]))
    return Record(len(good), iterations, float(np.median([moves[k] for k in good])))


COUNT, _SEED = 25, 350
COUNTED: Final = "iterations of the reference loop; `nao-kin bench methods` measures time"


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


def _iterations(records: Mapping[str, Record]) -> dict[str, float]:
    return {name: record.iterations for name, record in records.items()}


def _reached(records: Mapping[str, Record]) -> dict[str, float]:
    return {name: float(record.solved) for name, record in records.items()}


def _told(records: dict[str, Record], what: Callable[[Record], str]) -> str:
    parts = [f"{name} {what(record)}" for name, record in records.items()]
    return ", ".join(parts) + "."


def cheaper(cost: Mapping[str, float], named: str) -> list[str]:
    """Methods that cost less than the one named."""
    return [name for name, value in cost.items() if value < cost[named]]


def not_so_much_dearer(cost: Mapping[str, float], named: str, times: float) -> list[str]:
    """Methods on the Jacobian that do not cost so many times what the one named does."""
    return [name for name in JACOBIAN if cost[name] < times * cost[named]]


def as_good_and_cheaper(reached: Mapping[str, float], cost: Mapping[str, float], named: str) -> list[str]:
    """Methods on the Jacobian that reach as many targets as the one named and cost less."""
    return [name for name in JACOBIAN if reached[name] >= reached[named] and cost[name] < cost[named]]


def extra_move(moved: Mapping[str, float], named: str) -> float:
    """By which part the joints move farther than with the method that moves them least."""
    return moved[named] / min(moved.values()) - 1.0


def clearly_better(reached: Mapping[str, float], of: int) -> tuple[list[str], float]:
    """Of follow-the-leader and CCD, those that reach clearly more than the best method shown; and how much is chance.

    Clearly: by more than two standard deviations of the difference of two such counts.
    """
    best = max(reached[name] for name in SHOWN)
    chance = 2.0 * math.sqrt(2.0 * best * (1.0 - best / of))
    return [name for name in ("ftl", "ccd") if reached[name] > best + chance], chance


def direct(form: Form) -> Measured:
    """How many ways to the joints take no more iterations than the one named; the closed form takes none."""
    counts = {"closed form": 0.0} | {name: record.iterations for name, record in near().items()}
    before = [name for name, count in counts.items() if count <= counts[form()] and name != form()]
    least = min(record.iterations for record in near().values())
    return Measured(float(len(before)), TARGETS, ", ".join(before), f"Iterative methods take {least:.0f} or more.")


def fewest(form: Form) -> Measured:
    """How many methods take fewer iterations than the one named."""
    records = near()
    before = cheaper(_iterations(records), form())
    return Measured(float(len(before)), TARGETS, ", ".join(before), _told(records, lambda r: f"{r.iterations:.0f}"))


def times_as_long(form: Form) -> Measured:
    """How many methods do not take that many times FABRIK's iterations."""
    records = near()
    ratios = {name: records[name].iterations / records["fabrik"].iterations for name in JACOBIAN}
    short = not_so_much_dearer(_iterations(records), "fabrik", form())
    told = ", ".join(f"{name} {value:.2g}" for name, value in ratios.items())
    return Measured(float(len(short)), len(ratios), ", ".join(short), f"Iterations against fabrik: {told}.")


def more_iterations(form: Form) -> Measured:
    """How many methods on the Jacobian take fewer iterations than FABRIK."""
    records = near()
    fewer = [name for name in cheaper(_iterations(records), form()) if name in JACOBIAN]
    return Measured(float(len(fewer)), TARGETS, ", ".join(fewer), _told(records, lambda r: f"{r.iterations:.0f}"))


def moves_least(form: Form) -> Measured:
    """By which part the joints move farther than with the method that moves them least."""
    records = far()
    extra = extra_move({name: record.moved for name, record in records.items()}, form())
    return Measured(extra, TARGETS, found=_told(records, lambda r: f"{r.moved:.2f} rad"))


def ahead(form: Form) -> Measured:
    """Methods on the Jacobian with at least as many targets in fewer iterations, nearby or far, that are not named."""
    ahead = {
        name
        for records in (near(), far())
        for name in as_good_and_cheaper(_reached(records), _iterations(records), "fabrik")
    }
    told = [_told(r, lambda x: f"{x.solved}/{x.iterations:.0f}") for r in (near(), far())]
    found = f"Reached of {TARGETS} / iterations, near: {told[0]}\nFar: {told[1]}"
    missed = ahead ^ set(form())
    return Measured(float(len(missed)), TARGETS, ", ".join(sorted(missed)), found)


def ahead_of_fabrik_corrected() -> tuple[str, ...]:
    """On these targets."""
    return ("pinv", "newton", "dls", "sdls", "tsvd", "lm")


def not_inferior(form: Form) -> Measured:
    """Those of the two that reach clearly more than the best of transpose, pseudo-inverse and FABRIK."""
    records = far()
    better, chance = clearly_better(_reached(records), TARGETS)
    missed = set(better) ^ set(form())
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


_ASKED: Final = (
    *(("nao_v50_h25", name) for name in ("left_arm", "right_arm", "left_leg", "right_leg", "head")),
    ("jaco2", "arm"),
    ("phantomx", "leg_lf"),
)


def refusals(kinds: tuple[str, ...]) -> Check:
    """A check of the share of chains and kinds of target refused."""

    def check(form: Form) -> Measured:
        cases = [(robot, chain, kind) for robot, chain in _ASKED for kind in kinds]
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


_COUNTED: Final = "iterations of the reference loop; `nao-kin bench methods` measures time"
_NEAR: Final = f"{TARGETS} positions of the NAO's left hand, start within 0.2 rad in each joint"
_FAR: Final = f"{TARGETS} positions of the left hand from any other posture, one start, up to 300 iterations"
_MEASURED: Final = "What a method needs is measured; there is no formula to correct."
_CHAINS: Final = "seven chains of NAO, JACO2 and PhantomX"

CLAIMS: Final = (
    Claim(
        id="000:3.4-natural-pose",
        place="section 3.4, third paragraph",
        said="FABRIK's pose looks natural; read as: no method moves the joints less.",
        formula="largest joint move of FABRIK ≤ 1.1 × the least of all methods",
        printed=fastest,
        check=moves_least,
        reference="median of the largest joint move of each method, targets reached",
        domain=_FAR,
        tolerance=0.1,
        uncorrectable="“Natural” is not defined; by this reading the joints move farther than with other methods.",
    ),
    Claim(
        id="000:3.5-analytic-fastest",
        place="section 3.5, first item",
        said="The closed form takes the least computing time.",
        formula="iterations of the closed form < those of any other method",
        printed=least_work,
        check=direct,
        reference=_COUNTED,
        domain=_NEAR,
        unit="methods",
        tolerance=0.0,
    ),
    Claim(
        id="000:3.5-analytic-stable",
        place="section 3.5, first item",
        said="The closed form is very stable at the border of the reach.",
        formula="(3.3.0.2) to (3.3.0.8), θ_4 corrected, near θ_4 = 0",
        printed=left_pipeline_corrected,
        check=at_the_edge,
        reference="forward kinematics of the described arm (Pinocchio), hand within 1 μm",
        domain=f"{COUNT} postures each with the elbow almost straight; holds for targets that the arm can take",
        unit="m",
        tolerance=1e-6,
    ),
    Claim(
        id="000:3.5-analytic-inflexible",
        place="section 3.5, first item",
        said="The closed form is inflexible: derived by hand, it serves its own chain only.",
        formula="the left arm's equations on the right arm",
        printed=left_pipeline_corrected,
        check=on_the_other_arm,
        reference="share of targets of the right arm solved",
        domain=f"{COUNT} postures of the described right arm",
        tolerance=0.0,
    ),
    Claim(
        id="000:3.5-fabrik-fastest",
        place="section 3.5, second item",
        said="FABRIK is clearly the fastest of the iterative methods.",
        formula="fewest iterations: FABRIK",
        printed=fastest,
        check=fewest,
        reference=_COUNTED,
        domain=_NEAR,
        unit="methods",
        tolerance=0.0,
        correction=Correction(
            fastest_corrected,
            "fewest iterations: Levenberg-Marquardt, level with the undamped steps",
            why="Methods on the Jacobian take fewer iterations on this arm.",
        ),
    ),
    Claim(
        id="000:3.5-fabrik-flexible",
        place="section 3.5, second item",
        said="FABRIK is very flexible: it serves other chains and targets.",
        formula="no chain and no target refused",
        printed=fabrik_refuses,
        check=refusals(("position", "pose")),
        reference="what nao_kin's FABRIK on hinges refuses",
        domain=f"{_CHAINS}, positions and poses",
        tolerance=0.0,
        conventions={"targets are positions, without orientation": refusals(("position",))},
    ),
    Claim(
        id="000:3.5-jacobian-1000",
        place="section 3.5, third item, after Aristidou and Lasenby",
        said="Methods on the Jacobian take 1000 times as long as FABRIK.",
        formula="work on the Jacobian / work of FABRIK = 1000",
        printed=ratio,
        check=times_as_long,
        reference=_COUNTED,
        domain=_NEAR,
        unit="methods",
        tolerance=0.0,
        uncorrectable=_MEASURED,
    ),
    Claim(
        id="000:3.5-jacobian-iterations",
        place="section 3.5, third item",
        said="Methods on the Jacobian need many iterations, because they linearise.",
        formula="iterations on the Jacobian > those of FABRIK",
        printed=fastest,
        check=more_iterations,
        reference=_COUNTED,
        domain=_NEAR,
        unit="methods",
        tolerance=0.0,
        uncorrectable="Only the transpose needs more; Newton's step converges quadratically, FABRIK linearly.",
    ),
    Claim(
        id="000:3.5-jacobian-unstable",
        place="section 3.5, third item",
        said="Inverses make the methods on the Jacobian unstable near singularities.",
        formula="|J⁺ e| → ∞ as σ_min → 0",
        latex=r"|J^\dagger \vec e| \to \infty,\ \sigma_{min} \to 0",
        printed=eq_3_2_2_1,
        check=growth,
        reference="a step that grows as the elbow's bend shrinks; departure from tenfold for a tenth",
        domain="described left arm, elbow bent by 10⁻² to 10⁻⁴ rad; damped methods are not meant",
        tolerance=0.02,
    ),
    Claim(
        id="000:3.5-jacobian-flexible",
        place="section 3.5, third item",
        said="Methods on the Jacobian are very flexible.",
        formula="no chain and no target refused",
        printed=jacobian_refuses,
        check=refusals(("position", "pose")),
        reference="what nao_kin's Levenberg-Marquardt refuses",
        domain=f"{_CHAINS}, positions and poses",
        tolerance=0.0,
    ),
    Claim(
        id="000:4.1-analytic-best-choice",
        place="section 4.1",
        said="For football the closed form is the best choice for simple tasks.",
        formula="for simple tasks: the closed form",
        printed=least_work,
        check=direct,
        reference="none",
        domain="none",
        not_checkable="A judgement of what a team needs; “best” and “simple” name nothing to measure.",
    ),
    Claim(
        id="000:4.1-fabrik-equal",
        place="section 4.1",
        said="FABRIK is at least equal to the methods on the Jacobian.",
        formula="methods as good in fewer iterations: none",
        printed=ahead_of_fabrik,
        check=ahead,
        reference=f"targets reached, and {_COUNTED}",
        domain=f"{_NEAR}; {_FAR}",
        unit="methods",
        tolerance=0.0,
        correction=Correction(
            ahead_of_fabrik_corrected,
            "nearby, every method on the Jacobian but the transpose; far away none",
            why="Near the target they reach as many in fewer iterations; far away FABRIK reaches more.",
        ),
    ),
    Claim(
        id="000:4.1-fabrik-whole-body",
        place="section 4.1",
        said="FABRIK extends to chains over several limbs.",
        formula="left sole to right hand",
        printed=whole_body_method,
        check=whole_body,
        reference="share of positions not reached, judged by Pinocchio",
        domain="10 positions of the right hand from the left sole, one start within half of the limits",
        tolerance=0.1,
    ),
    Claim(
        id="000:4.1-analytic-fixed-base",
        place="section 4.1",
        said="With the closed form the base is the torso and cannot be moved to another joint.",
        formula="no closed form from another base",
        printed=fixed_base,
        check=from_the_foot,
        reference="hand seen from the left sole, forward kinematics (Pinocchio)",
        domain=f"{COUNT} postures of arm and leg; the leg's joints given",
        correction=Correction(
            moved_base,
            "T_torso_hand = (T_base_torso)⁻¹ T_base_hand, then as before",
            latex=r"T_{torso}^{hand} = (T_{base}^{torso})^{-1} T_{base}^{hand}",
            why="Where the joints between are known, one product moves the base; only their own angles stay unsolved.",
        ),
    ),
    Claim(
        id="000:4.2-dls-extends",
        place="section 4.2",
        said="Damped least squares builds on the method of the Jacobian and extends it.",
        formula="Δθ = Jᵀ (J Jᵀ + λ² E)⁻¹ e, λ = 0: Δθ = J⁺ e",
        latex=r"\Delta\theta = J^T (J J^T + \lambda^2 E)^{-1} \vec e",
        printed=damped_step,
        check=towards_pseudo_inverse,
        reference="least squares of (J Δθ − e, λ Δθ) (LAPACK), and the pseudo-inverse for λ = 0",
        domain=f"{COUNT} postures of the NAO's left arm; the formula is the usual one, the thesis prints none",
    ),
    Claim(
        id="000:4.2-ftl-ccd-inferior",
        place="section 4.2",
        said="Follow-the-leader and CCD are variations of the methods shown or inferior to them.",
        formula="reach clearly more than the best of the methods shown: none",
        printed=better_than_shown,
        check=not_inferior,
        reference="targets reached by transpose, pseudo-inverse and FABRIK, two standard deviations for chance",
        domain=_FAR,
        unit="methods",
        tolerance=0.0,
        uncorrectable=_MEASURED,
    ),
)
