"""MATLAB example: how its equations and solutions are held against the position of a camera on a yaw and a pitch joint.

The position comes from rotations and a translation by Pinocchio, its inverse from the law of a rotating vector; no
formula of the example is used.
"""

from __future__ import annotations

from math import acos, atan2, hypot, pi
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from nao_kin.documents.claim import Measured
from nao_kin.documents.samples import deviation, wrapped

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

__all__ = [
    "EXAMPLE",
    "Case",
    "both",
    "cases",
    "conditions",
    "equations",
    "every_theta_2",
    "on_the_axis",
    "pairs_of",
    "position",
    "rank",
    "real",
    "rows_meet",
    "table",
    "theta_1",
    "theta_2",
    "two_solutions",
    "yc",
]

_COUNT, _SEED = 300, 9
EXAMPLE = (53.9, 67.9, -5.0)
"""CameraX, CameraZ and NeckOffsetZ of the verification run [mm]."""


class Case(NamedTuple):
    """A camera, two angles [rad] and where the camera then is, lengths in any unit."""

    x: float
    z: float
    neck: float
    t1: float
    t2: float
    at: Floats

    @property
    def radius(self) -> float:
        """Signed distance from the yaw axis: negative if the camera hangs over backwards."""
        return float(pin.utils.rotate("z", -self.t1)[0] @ (self.at - (0.0, 0.0, self.neck)))


def position(x: float, z: float, neck: float, t1: float, t2: float) -> Floats:
    """Where a camera at (x, 0, z) behind a yaw t1 and a pitch t2 [rad] at height `neck` is (3,)."""
    R = pin.utils.rotate("z", t1) @ pin.utils.rotate("y", t2)
    return np.asarray(np.add(R @ (x, 0.0, z), (0.0, 0.0, neck)))


def cases(t2: float | None = None, xc: float | None = None, seed: int = _SEED) -> list[Case]:
    """Random cameras and angles, at least 0.05 rad away from where two solutions meet.

    Args:
        t2: Pitch of all of them [rad], if it is given.
        xc: 0 for cameras in the plane x = 0, that is with a yaw of ±π/2.
        seed: Of the random generator.
    """
    rng, found = np.random.default_rng(seed), list[Case]()
    while len(found) < _COUNT:
        x, z, neck = rng.uniform((20.0, 20.0, -150.0), (100.0, 100.0, 150.0))
        t1, pitch = rng.uniform(-pi, pi, 2)
        t1 = t1 if xc is None else float(np.copysign(pi / 2, t1))
        pitch = pitch if t2 is None else t2
        double = abs(float(wrapped(2.0 * (pitch + atan2(x, z))))) / 2.0
        if min(double, abs(t1), pi - abs(t1), abs(abs(pitch) - pi) if t2 is None else 1.0) > 0.05:
            at = position(x, z, neck, t1, pitch)
            found.append(Case(x, z, neck, t1, pitch, at if xc is None else at * (0.0, 1.0, 1.0)))
    return found


def pairs_of(case: Case) -> list[tuple[float, float]]:
    """All pairs (θ_1, θ_2) [rad] that bring the camera to its place, from the turning of a vector: the truth."""
    r, phi = hypot(case.x, case.z), atan2(case.x, case.z)
    between = acos(min(1.0, max(-1.0, (case.at[2] - case.neck) / r)))
    found = []
    for t2 in (between - phi, -between - phi):
        side = 1.0 if float(position(case.x, case.z, 0.0, 0.0, t2)[0]) >= 0.0 else -1.0
        found.append((atan2(side * case.at[1], side * case.at[0]), float(wrapped(t2))))
    return found


def on_the_axis() -> list[Case]:
    """Random cameras pitched until they are on the yaw axis."""
    return [
        Case(c.x, c.z, c.neck, c.t1, -atan2(c.x, c.z), np.array([0.0, 0.0, c.neck + hypot(c.x, c.z)])) for c in cases()
    ]


def real(value: Any) -> float:
    """A number, not a number where it is not real."""
    return float(np.real(value)) if abs(np.imag(value)) < 1e-9 * (1.0 + abs(value)) else float("nan")


def _apart(rows: tuple[Any, ...], wanted: list[float]) -> float:
    """Largest distance of an angle wanted to the nearest row, and of a row to the nearest angle wanted [rad]."""
    gaps = np.abs(wrapped(np.subtract.outer([real(row) for row in rows], wanted)))
    return float(max(gaps.min(axis=0).max(), gaps.min(axis=1).max()))


def _told(drawn: list[Case]) -> Callable[[int], str]:
    def where(i: int) -> str:
        c = drawn[i]
        return f"CameraX {c.x:.1f}, CameraZ {c.z:.1f}, NeckOffsetZ {c.neck:.1f}, θ_1 {c.t1:.3f}, θ_2 {c.t2:.3f}"

    return where


def equations(form: Form) -> Measured:
    """What is left of the three equations at true positions, by the length of the arm."""
    drawn = cases()
    off = [deviation(form(c.t1, c.t2, *c.at, c.x, c.z, c.neck), np.zeros(3)) / hypot(c.x, c.z) for c in drawn]
    return Measured.worst(off, _told(drawn))


def rank(form: Form) -> Measured:
    """The stated number of free coordinates against the rank of the position's derivative."""
    off = []
    for c in cases():
        out, up = position(c.x, c.z, 0.0, c.t1, c.t2), position(c.x, c.z, 0.0, c.t1, c.t2 + pi / 2)
        turning = np.array([np.cross((0.0, 0.0, 1.0), out), up])
        off.append(form() - np.linalg.matrix_rank(turning))
    return Measured.worst(off)


def theta_2(form: Form) -> Measured:
    """Both rows against both true pitches."""
    drawn = cases()
    off = [_apart(form(c.x, c.z, c.neck, c.at[2]), [t2 for _, t2 in pairs_of(c)]) for c in drawn]
    return Measured.worst(off, _told(drawn))


def theta_1(form: Form) -> Measured:
    """Both rows against the true yaw and its mirror, at the true pitch."""
    drawn = cases()
    off = [_apart(form(c.x, c.z, c.at[0], c.t2), [c.t1, -c.t1]) for c in drawn]
    return Measured.worst(off, _told(drawn), _backwards(drawn))


def _backwards(drawn: list[Case]) -> str:
    """What becomes of the rows if roots are real ones only."""
    count = sum(c.radius < 0.0 for c in drawn)
    return (
        f"In {count} of {len(drawn)} cases the camera is behind the yaw axis: there both roots are imaginary and only "
        "their product is real, so code with real roots finds no solution."
    )


def yc(form: Form) -> Measured:
    """y_c of rows 2 and 3 at the yaws ±arccos, of rows 7 and 8 at ±π/2, relative to the camera's distance."""
    drawn = cases()
    off = []
    for c in drawn:
        yaw = acos(c.at[0] / c.radius)
        angles = (yaw, -yaw, pi / 2, -pi / 2)
        wanted = [position(c.x, c.z, c.neck, t1, c.t2)[1] for t1 in angles]
        off.append(deviation([real(y) for y in form(c.x, c.z, c.at[0], c.t2)], wanted) / hypot(c.x, c.z))
    return Measured.worst(off, _told(drawn))


def rows_meet(arguments: Callable[[Case], tuple[float, ...]], drawn: Callable[[], list[Case]]) -> Check:
    """A check of rows (θ_1, y_c): how far each is from x_c and from its own y_c, by the camera's distance."""

    def check(form: Form) -> Measured:
        sample, off = drawn(), list[float]()
        for c in sample:
            rows = np.atleast_2d(np.array([[real(value) for value in row] for row in form(*arguments(c))]))
            for t1, y in rows:
                there = position(c.x, c.z, c.neck, t1, c.t2)
                off.append(deviation(there[:2], (c.at[0], y)) / hypot(c.x, c.z))
        each = len(off) // len(sample)
        return Measured.worst(off, lambda i: _told(sample)(i // each))

    return check


def both(one: Check, other: Check) -> Check:
    """The worse of two checks."""

    def check(form: Form) -> Measured:
        a, b = one(form), other(form)
        worse = a if a.residual >= b.residual else b
        return Measured(worse.residual, a.samples + b.samples, worse.where, worse.found)

    return check


def conditions(form: Form) -> Measured:
    """Share of cases in which the condition says something else than the roots of the half angle's equation do."""
    rng, wrong = np.random.default_rng(_SEED), []
    edge = [(3.0, 4.0, 1.0, 6.0), (3.0, 4.0, 1.0, -4.0), (3.0, 4.0, 1.0, -3.0), (3.0, 4.0, 1.0, 6.0 + 1e-6)]
    drawn = [*edge, *rng.uniform((20.0, 20.0, -150.0, -300.0), (100.0, 100.0, 150.0, 300.0), (_COUNT, 4))]
    for x, z, neck, zc in drawn:
        up = zc - neck
        roots = np.roots([up + z, 2.0 * x, up - z])
        wrong.append(bool(form(x, z, neck, zc)) != (len(roots) == 2 and float(np.abs(roots.imag).max()) < 1e-6))
    return Measured(
        float(np.mean(wrong)), len(wrong), found=f"{sum(wrong)} of {len(wrong)} told wrongly, at the edge and off it."
    )


def every_theta_2(form: Form) -> Measured:
    """True pitches [rad] against the nearest of the form's at the excluded height; π if there is none."""
    rng, off = np.random.default_rng(_SEED), []
    for x, z, neck in rng.integers(20, 100, (_COUNT, 3)).astype(float):
        c = Case(x, z, neck, 0.0, pi, np.array([-x, 0.0, neck - z]))
        rows = form(x, z, neck, neck - z)
        for _, t2 in pairs_of(c):
            off.append(min((abs(float(wrapped(real(row) - t2))) for row in rows), default=pi))
    lost = sum(x > 1e-6 for x in off)
    return Measured.worst(
        off, found=f"{lost} of {len(off)} solutions are lost; one is θ_2 = π, the other 2 arctan(CameraZ/CameraX)."
    )


def table(form: Form) -> Measured:
    """The printed table against the pairs that bring the camera to the same place [rad]."""
    rows, off, lines = form(), list[float](), list[str]()
    known = [(pi / 4, pi / 8), (pi / 6, -pi / 12), (pi / 8, pi / 16), (pi / 10, -pi / 10)]
    for k, (t1, t2) in enumerate(known):
        case = Case(*EXAMPLE, t1, t2, position(*EXAMPLE, t1, t2))
        truth = sorted(pairs_of(case), key=lambda pair: abs(pair[0] - t1))
        for row, pair in zip(rows[2 * k : 2 * k + 2], truth, strict=True):
            off.append(deviation(row, (t1, t2, *pair)))
            lines.append("  ".join(f"{x:9.5f}" for x in (*row, *pair)))
    head = "θ_1 known, θ_2 known, θ_1 derived, θ_2 derived as printed; θ_1, θ_2 exactly"
    return Measured.worst(off, lambda i: f"row {i + 1}", "\n".join([head, *lines]))


def two_solutions(form: Form) -> Measured:
    """Share of poses of the head for which the run does not give exactly the two true pairs."""
    rng, wrong, inside = np.random.default_rng(_SEED), [], 0
    yaw, low, high = np.radians((119.5, -38.5, 29.5))
    for t1, t2 in rng.uniform((-yaw, low), (yaw, high), (_COUNT, 2)):
        case = Case(*EXAMPLE, t1, t2, position(*EXAMPLE, t1, t2))
        truth, found = pairs_of(case), form(tuple(case.at), *EXAMPLE)
        apart = [[max(abs(wrapped(np.subtract(a, b)))) for a in found] for b in truth]
        wrong.append(len(found) != 2 or max(min(row) for row in apart) > 1e-6)
        inside += sum(abs(a) <= yaw and low <= b <= high for a, b in truth) > 1
    told = f"{len(wrong) - sum(wrong)} of {len(wrong)} poses have exactly two; both are within limits for {inside}."
    return Measured(float(np.mean(wrong)), len(wrong), found=told)
