"""Bischoff 2016, section 3.4: Algorithm 1 as a whole on the NAO's arm, and what the text says around it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.linalg import norm

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.thesis_arms import arm_configurations, described_arm, robot_arm
from nao_kin.documents.thesis_fabrik import backward, forward, unreachable
from nao_kin.ik.geometric.free_points import fabrik_points
from nao_kin.se3 import rotation_y, rotation_z

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Form

__all__ = ["CLAIMS"]

_COUNT, _SEED = 100, 341
_MM: Final = 1000.0
_TOLERANCE: Final = 1e-6  # [m]


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
    postures = arm_configurations("left", 2 * _COUNT, _SEED)
    errors, rounds, torn = list[float](), list[int](), list[float]()
    for q, q_0 in zip(postures[:_COUNT], postures[_COUNT:], strict=True):
        p, t = _points(q_0), _points(q)[-1]
        found, count = form(p, t, _TOLERANCE)
        lengths = norm(np.diff(found, axis=0), axis=1) - norm(np.diff(p, axis=0), axis=1)
        torn.append(_MM * float(np.abs(lengths).max()))
        far = max(0.0, float(norm(found[-1] - t)) - _TOLERANCE)
        errors.append(max(_MM * far, _MM * float(norm(found[0] - p[0])), torn[-1]))
        rounds.append(count)
    good = sum(error <= 1e-9 for error in errors)
    found_text = (
        f"{good} of {_COUNT} hands reached with base and links kept; {float(np.median(rounds)):.0f} rounds in the "
        f"median; links too long or short by {float(np.median(torn)):.3g} mm in the median, {max(torn):.3g} mm at most."
    )
    return Measured.worst(errors, found=found_text)


def _back_again(form: Form) -> Measured:
    """Positions of elbow and hand by forward kinematics at the angles found."""
    arm, chain = described_arm("left"), robot_arm("left")
    errors, inside, previous = list[float](), 0, np.zeros(4)
    for k, q in enumerate(arm_configurations("left", 2 * _COUNT, _SEED)):
        p = _points(q)
        if k % 2:  # what the algorithm returns for this hand, from the posture before
            p, _ = fabrik_points(_points(previous), p[-1], _TOLERANCE)
        previous = q
        found = form(p)
        inside += k % 2 and bool(((chain.lower <= found) & (found <= chain.upper)).all())
        errors.append(float(norm(np.array([arm.elbow(found), arm.pose(found)[:3, 3]]) - p[1:], axis=1).max()) / arm.l3)
    return Measured.worst(
        errors, found=f"{inside} of {_COUNT} results of the algorithm are inside the joints' limits: points know none."
    )


def _singular(form: Form) -> Measured:
    """Share of targets on the last but one point that leave numbers that are not finite."""
    rng, bad = np.random.default_rng(_SEED), 0
    for _ in range(_COUNT):
        p = np.cumsum(rng.normal(size=(4, 3)), axis=0)
        bad += not np.isfinite(form(p, norm(np.diff(p, axis=0), axis=1), p[-2].copy())).all()
    return Measured(bad / _COUNT, _COUNT, "t = p_{n−1}, so r_{n−1} = 0", f"{bad} of {_COUNT} without a finite answer.")


def _patient(p: Floats, t: Floats, tol: float) -> tuple[Floats, int]:
    return fabrik_points(p, t, tol, 100_000)  # an arm that ends up nearly straight takes thousands of rounds


def _without_division(p: Floats, _d: Floats, t: Floats) -> Floats:
    return fabrik_points(p, t, _TOLERANCE)[0]


CLAIMS: Final = (
    Claim(
        id="000:algorithm-1",
        place="Algorithm 1",
        said="The algorithm as a whole brings the arm's points to the target.",
        formula="lines 5 to 46",
        printed=algorithm_1,
        check=_on_the_arm,
        reference="tip within the tolerance of the target, base and links unchanged",
        domain=f"shoulder, elbow and hand of the described left arm, {_COUNT} hands it can reach, from other postures,"
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
