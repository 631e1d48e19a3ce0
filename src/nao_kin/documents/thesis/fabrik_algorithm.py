"""Bischoff 2016, section 3.4: FABRIK, Algorithm 1 line by line, and (3.4.0.1), as printed.

Points p_1 … p_n are the rows of an array, so p_i is p[i - 1]; likewise d_i. Every block returns new points.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy import dot
from numpy.linalg import norm

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.samples import deviation
from nao_kin.documents.thesis.thesis_arms import arm_configurations, described_arm, robot_arm
from nao_kin.ik.geometric.free_points import fabrik_points
from nao_kin.se3 import rotation_y, rotation_z

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

__all__ = [
    "CLAIMS",
]


def distances(n: int) -> list[tuple[int, int]]:
    """Line 4: the numbers of the two points of every d_i, i = 1, …, n."""
    return [(i + 1, i) for i in range(1, n + 1)]


def distances_corrected(n: int) -> list[tuple[int, int]]:
    """I = 1, …, n − 1."""
    return [(i + 1, i) for i in range(1, n)]


def unreachable(p: Floats, d: Floats, t: Floats) -> Floats:
    """Lines 9 to 16."""
    p, n = p.copy(), len(p)
    for i in range(1, n):
        r_i = norm(t - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i] = (1 - lambda_i) * p[i - 1] + lambda_i * t
    return p


def forward(p: Floats, d: Floats, t: Floats) -> Floats:
    """Lines 24 to 34."""
    p, n = p.copy(), len(p)
    p[n - 1] = t
    for i in range(n - 1, 0, -1):
        r_i = norm(p[i] - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i - 1] = (1 - lambda_i) * p[i] + lambda_i * p[i - 1]
    return p


def backward(p: Floats, d: Floats, b: Floats) -> Floats:
    """Lines 35 to 43 and 40 to 41 of the second block."""
    p, n = p.copy(), len(p)
    p[0] = b
    for i in range(1, n):
        r_i = norm(p[i] - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i - 1] = (1 - lambda_i) * p[i - 1] + lambda_i * p[i]
    return p


def backward_corrected(p: Floats, d: Floats, b: Floats) -> Floats:
    """Line 40 sets p_{i+1}."""
    p, n = p.copy(), len(p)
    p[0] = b
    for i in range(1, n):
        r_i = norm(p[i] - p[i - 1])
        lambda_i = d[i - 1] / r_i
        p[i] = (1 - lambda_i) * p[i - 1] + lambda_i * p[i]
    return p


def goes_on(dif: float, tol: float) -> bool:
    """Line 23: the loop goes on while the distance to the target is above the tolerance."""
    return dif > tol


def base_and_tip(n: int) -> tuple[int, int]:
    """Text and Figure 7: numbers of the base and of the end effector of a chain of n points."""
    return 0, n - 1


def eq_3_4_0_1(d_i: Floats, d_next: Floats) -> Any:
    """(3.4.0.1): cos θ_i."""
    return dot(d_i, d_next) / (norm(d_i) * norm(d_next))


_COUNT, _SEED = 200, 340
_LIMIT: Final = 1000
_TOLERANCE: Final = 1e-6


def _chain(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Points (n, 3) with n from 3 to 7, and their distances."""
    p = np.cumsum(rng.normal(size=(int(rng.integers(3, 8)), 3)), axis=0)
    return p, norm(np.diff(p, axis=0), axis=1)


def _direction(rng: np.random.Generator) -> Floats:
    v = rng.normal(size=3)
    return np.asarray(v / norm(v))


def _index_range(form: Form) -> Measured:
    """How many distances name a point that is not there, or are missing."""
    errors = []
    for n in range(2, 12):
        found, wanted = form(n), [(i + 1, i) for i in range(1, n)]
        errors.append(float(len(set(found) ^ set(wanted))))
    return Measured.worst(
        errors, lambda k: f"n = {k + 2}: d_{k + 2} = |p_{k + 3} − p_{k + 2}|, and there is no p_{k + 3}"
    )


def _stretched(form: Form) -> Measured:
    """The straight line from the base towards a target out of reach."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        p, d = _chain(rng)
        u = _direction(rng)
        t = p[0] + u * d.sum() * rng.uniform(1.01, 3.0)
        line = p[0] + np.outer(np.concatenate([[0.0], np.cumsum(d)]), u)
        errors.append(deviation(form(p, d, t), line) / d.sum())
    return Measured.worst(errors)


def _from_tip(form: Form) -> Measured:
    """Each point on the line from the next one's new place to its own old place, at its distance."""
    rng, errors = np.random.default_rng(_SEED), list[float]()
    for _ in range(_COUNT):
        p, d = _chain(rng)
        t = p[0] + _direction(rng) * d.sum() * rng.uniform(0.0, 1.0)
        wanted = [t]
        for old, length in zip(p[-2::-1], d[::-1], strict=True):
            wanted.append(wanted[-1] + length * (old - wanted[-1]) / norm(old - wanted[-1]))
        errors.append(deviation(form(p, d, t), np.array(wanted[::-1])) / d.sum())
    return Measured.worst(errors)


def _from_base(form: Form) -> Measured:
    """The same from the base outwards, on points that forward reaching has moved."""
    rng, errors, bases, lengths = np.random.default_rng(_SEED), list[float](), list[float](), list[float]()
    for _ in range(_COUNT):
        p, d = _chain(rng)
        b, p = p[0], forward(p, d, p[0] + _direction(rng) * d.sum() * rng.uniform(0.3, 0.9))
        wanted = [b]
        for old, length in zip(p[1:], d, strict=True):
            wanted.append(wanted[-1] + length * (old - wanted[-1]) / norm(old - wanted[-1]))
        found = form(p, d, b)
        errors.append(deviation(found, np.array(wanted)) / d.sum())
        bases.append(float(norm(found[0] - b) / d.sum()))
        lengths.append(float(np.abs(norm(np.diff(found, axis=0), axis=1) - d).max() / d.sum()))
    told = (
        f"After it the base is up to {100.0 * max(bases):.3g} % of the chain's length from where it was, and a link "
        f"up to {100.0 * max(lengths):.3g} % of that too long or short."
    )
    return Measured.worst(errors, found=told)


def _inputs() -> dict[str, list[tuple[Floats, Floats]]]:
    """Chains and targets that line 7 accepts, by what they have in common."""
    rng = np.random.default_rng(_SEED)
    groups: dict[str, list[tuple[Floats, Floats]]] = {"within reach": [], "too near": [], "in one line": []}
    for _ in range(_COUNT // 2):
        p, d = _chain(rng)
        hole = max(0.0, 2.0 * d.max() - d.sum())
        groups["within reach"].append((p, p[0] + _direction(rng) * rng.uniform(hole + 0.05 * d.sum(), 0.95 * d.sum())))
    for _ in range(_COUNT // 4):
        p = np.cumsum(rng.normal(size=(4, 3)), axis=0)
        p[1:] += _direction(rng) * norm(np.diff(p, axis=0), axis=1).sum()  # a long first link
        d = norm(np.diff(p, axis=0), axis=1)
        groups["too near"].append((p, p[0] + _direction(rng) * rng.uniform(0.1, 0.9) * (2.0 * d.max() - d.sum())))
        u = _direction(rng)
        line = np.outer(np.cumsum([0.0, *rng.uniform(0.8, 1.2, 3)]), u)
        groups["in one line"].append((line, u * rng.uniform(1.3, 2.2)))
    return groups


def _ends(run: Callable[[Floats, Floats], tuple[Floats, int]]) -> Measured:
    """How many inputs have not ended with a finite answer that is as near as can be, after 1000 iterations."""
    lines, bad, count = list[str](), 0, 0
    for name, cases in _inputs().items():
        open_ones = 0
        for p, t in cases:
            d = norm(np.diff(p, axis=0), axis=1)
            nearest = max(0.0, 2.0 * float(d.max()) - float(d.sum()) - float(norm(t - p[0])))
            found, iterations = run(p, t)
            missed = float(norm(found[-1] - t)) - nearest
            open_ones += not (iterations < _LIMIT and missed <= 2.0 * _TOLERANCE)
        lines.append(f"{name}: {open_ones} of {len(cases)} do not end")
        bad, count = bad + open_ones, count + len(cases)
    return Measured(float(bad), count, lines[1] + ", " + lines[2], ";\n".join(lines) + ".")


def _loop(form: Form) -> Measured:
    """Lines 22 to 43 with the backward block corrected and the condition as given."""

    def run(p: Floats, t: Floats) -> tuple[Floats, int]:
        d, b = norm(np.diff(p, axis=0), axis=1), p[0]
        for k in range(_LIMIT):
            if not form(float(norm(p[-1] - t)), _TOLERANCE):
                return p, k
            p = backward_corrected(forward(p, d, t), d, b)
        return p, _LIMIT

    return _ends(run)


def _made_right(form: Form) -> Measured:
    return _ends(lambda p, t: form(p, t, _TOLERANCE, _LIMIT))


def _numbers(shift: int) -> Check:
    """Which points of the listing stay and reach, found by running it; the text's numbers may be shifted."""

    def check(form: Form) -> Measured:
        rng, errors = np.random.default_rng(_SEED), list[float]()
        for _ in range(20):
            p, d = _chain(rng)
            moved = backward_corrected(forward(p, d, p[0] + _direction(rng)), d, p[0])
            stays = [i + 1 for i in range(len(p)) if norm(moved[i] - p[i]) < 1e-12]
            base, tip = form(len(p))
            errors += [base + shift - stays[0], tip + shift - len(p)]
        return Measured.worst(errors)

    return check


def _bend(vectors: Callable[[Floats, int], tuple[Floats, Floats]]) -> Check:
    """A plane chain that bends by known angles at its inner points."""

    def check(form: Form) -> Measured:
        rng, errors = np.random.default_rng(_SEED), list[float]()
        for _ in range(_COUNT):
            bends, lengths = rng.uniform(-3.0, 3.0, 4), rng.uniform(0.2, 1.0, 5)
            heading = np.concatenate([[0.3], 0.3 + np.cumsum(bends)])
            steps = lengths[:, None] * np.column_stack([np.cos(heading), np.sin(heading)])
            p = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
            errors += [float(form(*vectors(p, i))) - math.cos(bends[i - 1]) for i in range(1, 5)]
        return Measured.worst(errors)

    return check


def _lengths_of(p: Floats, i: int) -> tuple[Floats, Floats]:
    return np.atleast_1d(norm(p[i] - p[i - 1])), np.atleast_1d(norm(p[i + 1] - p[i]))


def _vectors_of(p: Floats, i: int) -> tuple[Floats, Floats]:
    return p[i] - p[i - 1], p[i + 1] - p[i]


_CHAINS: Final = "200 random chains of 3 to 7 points"

_LINES: Final = (
    Claim(
        id="000:algorithm-1-distances",
        place="Algorithm 1, line 4",
        said="Every d_i is the distance of p_i and p_{i+1}, i from 1 to n.",
        formula="d_i = |p_{i+1} − p_i|, i = 1, …, n",
        latex=r"d_i = |p_{i+1} - p_i|,\ i = 1, \ldots, n",
        printed=distances,
        check=_index_range,
        reference="the links of a chain of n points",
        domain="n from 2 to 11",
        unit="distances",
        tolerance=0.0,
        correction=Correction(
            distances_corrected,
            "d_i = |p_{i+1} − p_i|, i = 1, …, n − 1",
            latex=r"d_i = |p_{i+1} - p_i|,\ i = 1, \ldots, n-1",
            why="n points have n − 1 links; lines 7, 9, 27 and 38 use that many.",
        ),
    ),
    Claim(
        id="000:algorithm-1-unreachable",
        place="Algorithm 1, lines 7 to 16",
        said="A target out of reach is answered by the straight line towards it.",
        formula="λ_i ← d_i / |t − p_i|, p_{i+1} ← (1 − λ_i) p_i + λ_i t, i = 1, …, n − 1",
        latex=r"p_{i+1} \leftarrow (1 - \lambda_i) p_i + \lambda_i t,\ \lambda_i = d_i / |t - p_i|",
        printed=unreachable,
        check=_stretched,
        reference="points at the links' lengths along the line from base to target",
        domain=f"{_CHAINS}, targets 1.01 to 3 lengths away; holds for all that line 7 rejects",
    ),
    Claim(
        id="000:algorithm-1-forward",
        place="Algorithm 1, lines 24 to 34",
        said="Forward reaching puts the tip on the target and the others back along the lines.",
        formula="p_n ← t; λ_i ← d_i / |p_{i+1} − p_i|,\np_i ← (1 − λ_i) p_{i+1} + λ_i p_i, i = n − 1, …, 1",
        latex=r"p_i \leftarrow (1 - \lambda_i) p_{i+1} + \lambda_i p_i,\ \lambda_i = d_i / |p_{i+1} - p_i|",
        printed=forward,
        check=_from_tip,
        reference="each point at its distance from the next one, towards where it was",
        domain=f"{_CHAINS}; holds unless a point lies where the next one comes to lie (r_i = 0)",
    ),
    Claim(
        id="000:algorithm-1-backward",
        place="Algorithm 1, lines 35 to 43 and 40 to 41 of the second block",
        said="Backward reaching puts the base back and the others along the lines from it.",
        formula="p_1 ← b; λ_i ← d_i / |p_{i+1} − p_i|,\np_i = (1 − λ_i) p_i + λ_i p_{i+1}, i = 1, …, n − 1",
        latex=r"p_i = (1 - \lambda_i) p_i + \lambda_i p_{i+1}",
        printed=backward,
        check=_from_base,
        reference="each point at its distance from the one before, towards where it was",
        domain=f"{_CHAINS} after forward reaching. As printed the tip never leaves the target, so that the loop ends at"
        " once, with a chain torn apart",
        correction=Correction(
            backward_corrected,
            "p_{i+1} ← (1 − λ_i) p_i + λ_i p_{i+1}",
            latex=r"p_{i+1} \leftarrow (1 - \lambda_i) p_i + \lambda_i p_{i+1}",
            why="The point to be placed is p_{i+1}; as printed, p_i is moved off the base again.",
        ),
    ),
    Claim(
        id="000:algorithm-1-loop",
        place="Algorithm 1, lines 6, 7 and 23",
        said="Whatever line 7 accepts is iterated until the tip is within the tolerance.",
        formula="while |p_n − t| > tol",
        latex=r"\text{while } |p_n - t| > tol",
        printed=goes_on,
        check=_loop,
        reference="end within 1000 iterations, as near to the target as the links allow",
        domain="200 inputs that line 7 accepts, tolerance 10⁻⁶ of a link, backward block corrected. It ends for targets"
        " farther than the longest link less the others, off the line of a straight chain",
        unit="inputs",
        tolerance=0.0,
        correction=Correction(
            fabrik_points,
            "reject also |p_1 − t| < 2 max d_i − Σ d_i, bend a chain that is in one line "
            "with the target, and bound the iterations (nao_kin.ik.geometric.free_points.fabrik_points)",
            why="A long link leaves a hole about the base that line 7 does not see; on a line nothing ever leaves it.",
            check=_made_right,
        ),
    ),
    Claim(
        id="000:3.4-base-index",
        place="text of section 3.4 and Figure 7",
        said="The base is p_0 and the end effector of three points p_2.",
        formula="base p_0, end effector p_{n−1}",
        latex=r"p_0,\ \ldots,\ p_{n-1}",
        printed=base_and_tip,
        check=_numbers(0),
        reference="the points of the listing that stay and that reach, p_1 and p_n",
        domain="20 random chains",
        unit="1",
        tolerance=0.0,
        conventions={"p_i of the text is p_{i+1} of the listing": _numbers(1)},
    ),
    Claim(
        id="000:3.4.0.1",
        place="equation (3.4.0.1)",
        said="The angle of a joint out of the links beside it, for checking its limits.",
        formula="cos θ_i = (d_i · d_{i+1}) / (|d_i| |d_{i+1}|)",
        latex=r"\cos\theta_i = \frac{\vec d_i \cdot \vec d_{i+1}}{|\vec d_i| \cdot |\vec d_{i+1}|}",
        printed=eq_3_4_0_1,
        check=_bend(_lengths_of),
        reference="plane chains that bend by known angles",
        domain="200 chains of five links; the size of the angle only, so no limits that differ in sign, and of the"
        " NAO's arm only the elbow roll",
        conventions={
            "d_i is the vector from p_{i−1} to p_i, as in Figure 3, not the link's length, as the text has it": _bend(
                _vectors_of
            )
        },
    ),
)


_ARMS, _ARM_SEED = 100, 341
_MM: Final = 1000.0
_ARRIVED: Final = 1e-6  # [m]


def algorithm_1(p: Floats, t: Floats, tol: float) -> tuple[Floats, int]:
    """Algorithm 1, lines 5 to 46, n points with their n − 1 distances; and the rounds of its loop."""
    d, rounds = norm(np.diff(p, axis=0), axis=1), 0
    if norm(p[0] - t) > d.sum():
        return unreachable(p, d, t), rounds
    b, dif = p[0], norm(p[-1] - t)
    while dif > tol:
        p, rounds = backward(forward(p, d, t), d, b), rounds + 1
        dif = norm(p[-1] - t)
    return p, rounds


def angles_back(points: Floats) -> Floats:
    """The text: the joints' angles from the positions, here of shoulder, elbow and hand of the described left arm."""
    upper, fore = np.diff(points, axis=0)
    roll = math.asin(upper[1] / norm(upper))
    pitch = math.atan2(-upper[2], upper[0])
    x, y, z = (rotation_y(pitch) * rotation_z(roll)).rotation.T @ fore
    return np.array([pitch, roll, math.atan2(-z, -y), -math.atan2(math.hypot(y, z), x)])


def _points(q: Floats) -> Floats:
    """Shoulder, elbow and hand of the described left arm (3, 3) [m]."""
    arm = described_arm("left")
    return np.array([arm.shoulder, arm.elbow(q), arm.pose(q)[:3, 3]])


def _on_the_arm(form: Form) -> Measured:
    """Tip, links and base after the algorithm, for hands that the arm can reach, from another posture."""
    postures = arm_configurations("left", 2 * _ARMS, _ARM_SEED)
    errors, rounds, torn = list[float](), list[int](), list[float]()
    for q, q_0 in zip(postures[:_ARMS], postures[_ARMS:], strict=True):
        p, t = _points(q_0), _points(q)[-1]
        found, count = form(p, t, _ARRIVED)
        lengths = norm(np.diff(found, axis=0), axis=1) - norm(np.diff(p, axis=0), axis=1)
        torn.append(_MM * float(np.abs(lengths).max()))
        far = max(0.0, float(norm(found[-1] - t)) - _ARRIVED)
        errors.append(max(_MM * far, _MM * float(norm(found[0] - p[0])), torn[-1]))
        rounds.append(count)
    good = sum(error <= 1e-9 for error in errors)
    found_text = (
        f"{good} of {_ARMS} hands reached with base and links kept; {float(np.median(rounds)):.0f} rounds in the "
        f"median; links too long or short by {float(np.median(torn)):.3g} mm in the median, {max(torn):.3g} mm at most."
    )
    return Measured.worst(errors, found=found_text)


def _back_again(form: Form) -> Measured:
    """Positions of elbow and hand by forward kinematics at the angles found."""
    arm, chain = described_arm("left"), robot_arm("left")
    errors, inside, previous = list[float](), 0, np.zeros(4)
    for k, q in enumerate(arm_configurations("left", 2 * _ARMS, _ARM_SEED)):
        p = _points(q)
        if k % 2:  # what the algorithm returns for this hand, from the posture before
            p, _ = fabrik_points(_points(previous), p[-1], _ARRIVED)
        previous = q
        found = form(p)
        inside += k % 2 and bool(((chain.lower <= found) & (found <= chain.upper)).all())
        errors.append(float(norm(np.array([arm.elbow(found), arm.pose(found)[:3, 3]]) - p[1:], axis=1).max()) / arm.l3)
    return Measured.worst(
        errors, found=f"{inside} of {_ARMS} results of the algorithm are inside the joints' limits: points know none."
    )


def _singular(form: Form) -> Measured:
    """Share of targets on the last but one point that leave numbers that are not finite."""
    rng, bad = np.random.default_rng(_ARM_SEED), 0
    for _ in range(_ARMS):
        p = np.cumsum(rng.normal(size=(4, 3)), axis=0)
        bad += not np.isfinite(form(p, norm(np.diff(p, axis=0), axis=1), p[-2].copy())).all()
    return Measured(bad / _ARMS, _ARMS, "t = p_{n−1}, so r_{n−1} = 0", f"{bad} of {_ARMS} without a finite answer.")


def _patient(p: Floats, t: Floats, tol: float) -> tuple[Floats, int]:
    return fabrik_points(p, t, tol, 100_000)  # an arm that ends up nearly straight takes thousands of rounds


def _without_division(p: Floats, _d: Floats, t: Floats) -> Floats:
    return fabrik_points(p, t, _ARRIVED)[0]


_WHOLE: Final = (
    Claim(
        id="000:algorithm-1",
        place="Algorithm 1",
        said="The algorithm as a whole brings the arm's points to the target.",
        formula="lines 5 to 46",
        printed=algorithm_1,
        check=_on_the_arm,
        reference="tip within the tolerance of the target, base and links unchanged",
        domain=f"shoulder, elbow and hand of the described left arm, {_ARMS} hands it can reach, from other postures,"
        " tolerance 1 μm; n − 1 distances",
        unit="mm",
        correction=Correction(
            _patient,
            "line 40 of the second block sets p_{i+1} (nao_kin.ik.geometric.free_points.fabrik_points)",
            why="The loop ends after one round because the tip is never moved off the target; the links give.",
        ),
    ),
    Claim(
        id="000:3.4-angles-back",
        place="section 3.4, first paragraph",
        said="Once the positions are found, the joints' angles can be computed back from them.",
        formula="θ from p_1 … p_n",
        printed=angles_back,
        check=_back_again,
        reference="elbow and hand by forward kinematics of the described arm (Pinocchio)",
        domain="100 random postures and 100 results of the algorithm; holds for this arm, whose shoulder and elbow turn"
        " about two axes each, and not for chains of hinges in general",
    ),
    Claim(
        id="000:3.4-no-singularities",
        place="section 3.4, third paragraph",
        said="No singularities occur during the iteration.",
        formula="λ_i = d_i / r_i is finite",
        latex=r"\lambda_i = d_i / r_i",
        printed=forward,
        check=_singular,
        reference="finite numbers",
        domain="100 chains of four points, the target on p_{n−1}; elsewhere it holds but for such coincidences",
        tolerance=0.0,
        correction=Correction(
            _without_division,
            "where r_i = 0, keep the link's direction (nao_kin.ik.geometric.free_points.fabrik_points)",
            why="A point on the one it follows leaves no line to put it on, and λ_i divides by 0.",
        ),
    ),
)

CLAIMS: Final = (*_LINES, *_WHOLE)
