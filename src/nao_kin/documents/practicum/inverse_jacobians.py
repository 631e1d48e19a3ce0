"""Practicum, sections 1.4 to 1.8: how (13) to (16) and what the text says of them are held against the JACO2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.chain import random_configurations
from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.practicum import newtons_method as printed
from nao_kin.documents.practicum.practicum_sheet import arm, near_poses, pose_error, singular_configurations
from nao_kin.documents.samples import derivative, deviation, regular_configurations, wrapped

if TYPE_CHECKING:
    from collections.abc import Callable

    import pinocchio as pin

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

    Step = Callable[[Floats, Floats, Floats, Callable[[Floats], float]], Floats]

__all__ = [
    "CLAIMS",
    "combined",
    "descent_step",
    "penrose",
    "scaled_step",
    "shapes",
    "shortest_step",
    "singular_are_taken",
    "small_gain",
    "transpose_nearby",
    "wild_near_singularity",
]

_SEED = 7
_GAINS = (1.0, 0.6, 0.25)


def _position_cases(count: int = 60) -> list[tuple[Floats, Floats]]:
    """Configurations at which the positional Jacobian is far from singular, and an error of position [m]."""
    rng = np.random.default_rng(_SEED)
    return [(q, rng.normal(scale=0.02, size=3)) for q in regular_configurations(arm(), count, _SEED, rows=3)]


def scaled_step(form: Form) -> Measured:
    """(13): J Δq = K e."""
    off = [deviation(J @ (form(q, K, J, e) - q), K * e) for q, J, e, _ in near_poses() for K in _GAINS]
    return Measured.worst(off)


def descent_step(form: Form) -> Measured:
    """(14): the step is −K times the gradient of half the squared error, by five-point differences."""
    off = []
    for q, e in _position_cases():
        wanted = arm().pose(q).translation + e

        def half_square(at: Floats, wanted: Floats = wanted) -> float:
            return 0.5 * float(np.sum((wanted - arm().pose(at).translation) ** 2))

        gradient = derivative(half_square, q)
        off += [deviation(form(q, K, arm().jacobian(q)[:3], e) - q, -K * gradient) for K in _GAINS]
    return Measured.worst(off)


def penrose(form: Form) -> Measured:
    """(15) by the four conditions of Penrose, which only the pseudo-inverse meets."""
    return Measured.worst([_penrose(form, arm().jacobian(q)[:3]) for q, _ in _position_cases()])


def _penrose(form: Form, J: Floats) -> float:
    try:
        P = np.asarray(form(J))
    except np.linalg.LinAlgError:
        P = np.zeros(J.T.shape)  # no value gives back nothing of J
    return max(
        deviation(J @ P @ J, J), deviation(P @ J @ P, P), deviation((J @ P).T, J @ P), deviation((P @ J).T, P @ J)
    )


def shapes(form: Form) -> Measured:
    """The same for wide, square, tall and rank-deficient matrices, singular values between 0.5 and 2 or zero."""
    rng, off, counts = np.random.default_rng(_SEED), list[float](), list[str]()
    for name, rows, columns, rank in (("wide", 3, 6, 3), ("square", 5, 5, 5), ("tall", 6, 4, 4), ("singular", 4, 6, 3)):
        these = [_penrose(form, _matrix(rows, columns, rank, rng)) for _ in range(40)]
        off += these
        counts.append(f"{sum(x < 1e-9 for x in these)} of 40 {name}")
    found = f"It is the pseudo-inverse for {', '.join(counts)} matrices."
    return Measured.worst(off, lambda i: ("3×6", "5×5", "6×4", "4×6 of rank 3")[i // 40], found)


def _matrix(rows: int, columns: int, rank: int, rng: np.random.Generator) -> Floats:
    U, V = (np.linalg.qr(rng.normal(size=(size, rank)))[0] for size in (rows, columns))
    return np.asarray(U @ np.diag(rng.uniform(0.5, 2.0, rank)) @ V.T)


def shortest_step(form: Form) -> Measured:
    """(16): J Δq = K e, with nothing in the null space of J."""
    off = []
    for q, e in _position_cases():
        J = arm().jacobian(q)[:3]
        null_space = np.linalg.svd(J)[2][3:]
        for K in _GAINS:
            step = form(q, K, np.linalg.pinv(J), e) - q
            off += [deviation(J @ step, K * e), deviation(null_space @ step, np.zeros(3))]
    return Measured.worst(off)


def singular_are_taken(form: Form) -> Measured:
    """The stated share of singular configurations that the robot can take against how many it takes."""
    Q = singular_configurations()
    weakest = max(float(np.linalg.svd(arm().jacobian(q), compute_uv=False)[-1]) for q in Q)
    inside = [bool(np.all((q >= arm().lower) & (q <= arm().upper))) for q in Q]
    return Measured(
        abs(float(form()) - float(np.mean(inside))),
        len(Q),
        found=f"{sum(inside)} of {len(Q)} configurations with a smallest singular value below {weakest:.0e} are within "
        "the limits of the joints.",
    )


def wild_near_singularity(form: Form) -> Measured:
    """Share of cases in which 1 mm or mrad, the weakest direction's, is missed or moves no joint by a quarter turn."""
    jumps = []
    for singular in singular_configurations():
        q = singular.copy()
        q[4] += 1e-4
        J = arm().jacobian(q)
        error = 1e-3 * np.linalg.svd(J)[0][:, -1]
        step = form(J) @ error
        jumps.append(float(np.abs(step).max()) if deviation(J @ step, error) < 1e-6 else 0.0)
    calm = sum(not jump > np.pi / 2 for jump in jumps)
    return Measured(
        calm / len(jumps),
        len(jumps),
        found=f"1e-4 rad beside a singularity 1 mm or mrad moves a joint by {np.median(jumps):.0f} rad in the median, "
        f"by {min(jumps):.0f} to {max(jumps):.0f} rad.",
    )


def transpose_nearby(form: Form) -> Measured:
    """Median share of the way left at 1 mm over that at 50 mm, after a step of the best length along it."""
    rng, left = np.random.default_rng(_SEED), dict[tuple[str, float], list[float]]()
    for q, _ in _position_cases():
        J, direction = arm().jacobian(q)[:3], rng.normal(size=3)
        for distance in (0.05, 0.001):
            e = direction * (distance / np.linalg.norm(direction))
            wanted = arm().pose(q).translation + e
            way = J @ (J.T @ e)
            steps = {
                "transpose": form(q, float(e @ way / (way @ way)), J, e),
                "pseudo": printed.eq_16(q, 1.0, printed.eq_15(J), e),
            }
            for name, there in steps.items():
                rest = float(np.linalg.norm(wanted - arm().pose(there).translation))
                left.setdefault((name, distance), []).append(rest / distance)
    share = {key: float(np.median(values)) for key, values in left.items()}
    return Measured(
        share["transpose", 0.001] / share["transpose", 0.05],
        len(left["transpose", 0.05]),
        found=f"After one step of the best length {100 * share['transpose', 0.05]:.0f} % of 50 mm are left and "
        f"{100 * share['transpose', 0.001]:.0f} % of 1 mm; with the pseudo-inverse "
        f"{100 * share['pseudo', 0.05]:.2g} % and {100 * share['pseudo', 0.001]:.2g} %.",
    )


def small_gain(form: Form) -> Measured:
    """How much more often a small K ends at another solution, or 1 if it takes fewer steps."""
    rng, K = np.random.default_rng(_SEED), (1.0, 0.2)
    starts = random_configurations(arm(), 60, rng)
    goals = starts + rng.uniform(-0.4, 0.4, starts.shape)
    other, median = list[float](), list[float]()
    for gain in K:
        ends = [_newton(form, q, arm().pose(goal), gain) for q, goal in zip(starts, goals, strict=True)]
        away = [float(np.abs(wrapped(q - goal)).max()) > 0.5 for (q, _), goal in zip(ends, goals, strict=True)]
        other.append(float(np.mean(away)))
        median.append(float(np.median([steps for _, steps in ends])))
    shares = ", ".join(f"K = {k:g}: {100 * o:.0f} % in {m:.0f}" for k, o, m in zip(K, other, median, strict=True))
    return Measured(
        1.0 if median[1] <= median[0] else max(0.0, other[1] - other[0]),
        len(starts),
        found=f"Ending at another solution than the near one, and median steps: {shares}.",
    )


def _newton(form: Form, q: Floats, wanted: pin.SE3, gain: float) -> tuple[Floats, int]:
    for k in range(200):
        e = pose_error(wanted, q)
        if not np.isfinite(e).all() or np.abs(e).max() < 1e-6:
            return q, k
        q = form(q, gain, arm().jacobian(q), e)
    return q, 200


def combined(pose: bool) -> Check:
    """How much the combination of section 1.8 exceeds the pseudo-inverse alone, in median steps or in wild moves.

    Args:
        pose: Also for the pose; otherwise for positions only.
    """

    def check(form: Form) -> Measured:
        kinds = [("position", 3), ("pose", 6)] if pose else [("position", 3)]
        found = [_race(form, rows) for _, rows in kinds]
        text = " ".join(f"For the {name}: {told}" for (name, _), (_, told) in zip(kinds, found, strict=True))
        return Measured(max(excess for excess, _ in found), 40 * len(kinds), found=text)

    return check


def _race(form: Form, rows: int) -> tuple[float, str]:
    rng = np.random.default_rng(_SEED)
    pairs = [random_configurations(arm(), 2, rng) for _ in range(40)]
    rules: dict[str, Step] = {
        "pseudo": lambda q, J, e, _: _pseudo(q, J, e),
        "combined": lambda q, J, e, error: form(_transpose(q, J, e), _pseudo(q, J, e), error),
    }
    steps, moves = dict[str, float](), dict[str, float]()
    for name, rule in rules.items():
        runs = [_run(rule, q, arm().pose(goal), rows) for q, goal in pairs]
        steps[name] = float(np.median([count for count, _ in runs]))
        moves[name] = float(np.percentile([move for _, move in runs], 95))
    return (
        max(0.0, steps["combined"] / steps["pseudo"] - 1.0, moves["combined"] / moves["pseudo"] - 1.0),
        f"{steps['combined']:.0f} steps in the median, {steps['pseudo']:.0f} with the pseudo-inverse alone; one run in "
        f"twenty has a joint move by more than {moves['combined']:.2g} rad in a step, {moves['pseudo']:.2g} rad alone.",
    )


def _transpose(q: Floats, J: Floats, e: Floats) -> Floats:
    way = J @ (J.T @ e)
    return np.asarray(printed.eq_14(q, float(e @ way / (way @ way)), J, e))


def _pseudo(q: Floats, J: Floats, e: Floats) -> Floats:
    return np.asarray(printed.eq_16(q, 1.0, printed.eq_15(J), e))


def _run(rule: Step, q: Floats, wanted: pin.SE3, rows: int) -> tuple[int, float]:
    """Steps until 1 mm and mrad, at most the 128 of task 1e, and the largest move of a joint in a step [rad]."""

    def error(at: Floats) -> Any:
        return np.linalg.norm(pose_error(wanted, at)[:rows])

    largest = 0.0
    for k in range(128):
        e = pose_error(wanted, q)[:rows]
        if np.linalg.norm(e) < 1e-3:
            return k, largest
        there = rule(q, arm().jacobian(q)[:rows], e, error)
        largest, q = max(largest, float(np.abs(there - q).max())), there
    return 128, largest


_PINOCCHIO: Final = "Pinocchio on the JACO2's model"
_POSITIONS: Final = "60 configurations with a regular positional Jacobian, errors of about 30 mm, K of 1, 0.6 and 0.25"
_MEASURED_TOO: Final = "; on larger samples by nao-kin bench methods"

CLAIMS: Final = (
    Claim(
        id="001:eq-13",
        place="equation (13)",
        said="Newton's iteration with steps scaled by K.",
        formula="q_{n+1} = q_n + K J⁻¹ e(q)",
        latex=r"q_{n+1} = q_n + K \cdot J^{-1} e(q)",
        printed=printed.eq_13,
        check=scaled_step,
        reference=_PINOCCHIO + ": J Δq = K e",
        domain="100 regular configurations, poses 0.05 rad away, K of 1, 0.6 and 0.25",
    ),
    Claim(
        id="001:1.4-small-K",
        place="section 1.4, text",
        said="A small K makes a jump to another solution less likely, and takes more steps.",
        formula="K ↓  ⇒  jumps ↓, steps ↑",
        latex=r"K \downarrow \;\Rightarrow\; \text{jumps} \downarrow,\; \text{steps} \uparrow",
        printed=printed.eq_13,
        check=small_gain,
        reference=_PINOCCHIO + ", runs of (13) with K = 1 and K = 0.2",
        domain="60 starts up to 0.4 rad from a solution in every joint; the growth of the share that ends at another"
        + _MEASURED_TOO,
    ),
    Claim(
        id="001:eq-14",
        place="equation (14)",
        said="The transpose in place of the inverse, a step of steepest descent.",
        formula="q_{n+1} = q_n + K Jᵀ e(q)",
        latex=r"q_{n+1} = q_n + K \cdot J^T e(q)",
        printed=printed.eq_14,
        check=descent_step,
        reference=_PINOCCHIO + ": −K times the gradient of ½|e|², by five-point differences",
        domain=_POSITIONS + "; it converges for K below 2/σ², σ the largest singular value of J",
    ),
    Claim(
        id="001:1.6-small-distances",
        place="section 1.6, text",
        said="For small distances the transpose is accurate enough; taken as: a smaller share of the way is left.",
        formula="|e| → 0  ⇒  K Jᵀ e ≈ J⁻¹ e",
        latex=r"|e| \to 0 \;\Rightarrow\; K \, J^T e \approx J^{-1} e",
        printed=printed.eq_14,
        check=transpose_nearby,
        reference=_PINOCCHIO + ", one step",
        domain="60 configurations; share left of 1 mm over share left of 50 mm, of which at most half would be accurate"
        + _MEASURED_TOO,
        tolerance=0.5,
        uncorrectable="The step is linear in e, so the share it leaves does not depend on the distance; (16) is what "
        "is accurate for small ones.",
    ),
    Claim(
        id="001:eq-15",
        place="equation (15)",
        said="The pseudo-inverse.",
        formula="J⁺ = Jᵀ (J Jᵀ)⁻¹",
        latex=r"J^+ = J^T (J J^T)^{-1}",
        printed=printed.eq_15,
        check=penrose,
        reference="the four conditions of Penrose",
        domain="3×6 positional Jacobians at 60 regular configurations; it needs full row rank",
    ),
    Claim(
        id="001:1.7-n-by-m",
        place="section 1.7, text before (15)",
        said="The pseudo-inverse of (15) is valid for matrices of any shape too.",
        formula="J⁺ = Jᵀ (J Jᵀ)⁻¹  for J of n × m",
        latex=r"J^+ = J^T (J J^T)^{-1},\quad J \in \mathbb{R}^{n \times m}",
        printed=printed.eq_15,
        check=shapes,
        reference="the four conditions of Penrose",
        domain="40 random matrices each, wide, square, tall and rank-deficient; it holds for those of full row rank",
        correction=Correction(
            printed.eq_15_any,
            "J⁺ = V Σ⁺ Uᵀ  from  J = U Σ Vᵀ",
            r"J^+ = V \, \Sigma^+ \, U^T, \quad J = U \, \Sigma \, V^T",
            "J Jᵀ has no inverse if J has more rows than columns, or dependent rows.",
        ),
    ),
    Claim(
        id="001:eq-16",
        place="equation (16)",
        said="Newton's iteration with the pseudo-inverse.",
        formula="q_{n+1} = q_n + K J⁺ e(q)",
        latex=r"q_{n+1} = q_n + K \cdot J^+ e(q)",
        printed=printed.eq_16,
        check=shortest_step,
        reference=_PINOCCHIO + ": J Δq = K e, and nothing of Δq in the null space of J",
        domain=_POSITIONS,
    ),
    Claim(
        id="001:1.7-singularities",
        place="section 1.7, text",
        said="Singularities are positions that the robot cannot take.",
        formula="share of singular configurations that can be taken = 0",
        printed=printed.singularities_taken,
        check=singular_are_taken,
        reference=_PINOCCHIO + " and its limits",
        domain="50 configurations with det J = 0, found along the fifth joint",
        correction=Correction(
            printed.singularities_taken_corrected,
            "share = 1: positions from which the hand cannot move in every direction",
            why="At a singularity J loses rank; the robot can stand there.",
        ),
    ),
    Claim(
        id="001:1.7-unstable",
        place="section 1.7, text after (16)",
        said="Near singularities the pseudo-inverse makes joints jump although the hand hardly moves.",
        formula="|J⁺ e| ≫ |e|",
        latex=r"|J^+ e| \gg |e|",
        printed=printed.eq_15,
        check=wild_near_singularity,
        reference=_PINOCCHIO,
        domain="50 configurations 1e-4 rad beside a singularity, |e| = 1e-3 m, rad along the weakest direction; the "
        "share in which no joint moves by a quarter turn",
    ),
    Claim(
        id="001:1.8-combination",
        place="section 1.8, text",
        said="Taking the better of transpose and pseudo-inverse needs fewer steps and suppresses instabilities.",
        formula="q_{n+1} = the one of q_n + K Jᵀ e and q_n + J⁺ e with the smaller |e(q)|",
        latex=r"q_{n+1} = \underset{q \in \{q_n + K J^T e,\; q_n + J^+ e\}}{\operatorname{argmin}} |e(q)|",
        printed=printed.combination,
        check=combined(pose=True),
        reference=_PINOCCHIO + ", whole runs beside the pseudo-inverse alone",
        domain="40 starts and targets anywhere, at most 128 steps to 1 mm and mrad, K of the best length; how much it "
        "exceeds the pseudo-inverse alone" + _MEASURED_TOO,
        conventions={"only the position is wanted, as in tasks 1d to 1g": combined(pose=False)},
    ),
)
