"""MATLAB example: its equations, the solutions of its solver and the table of its verification run, as printed.

Rows are counted from 1 as the example counts them. Roots are complex where MATLAB's are: a product of two imaginary
ones is a real number, and for a camera that looks backwards the solutions need it.
"""

from __future__ import annotations

from math import acos, atan2, hypot, pi
from typing import TYPE_CHECKING, Any, Final, NamedTuple, TypeAlias

import numpy as np
import pinocchio as pin
from numpy import arctan as atan
from numpy import cos, sin, tan
from numpy.lib.scimath import sqrt

from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.samples import deviation, wrapped

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form

__all__ = [
    "CLAIMS",
    "EXAMPLE",
    "Case",
    "both",
    "cases",
    "conditions",
    "eqns",
    "equations",
    "every_theta_2",
    "free_coordinates",
    "on_the_axis",
    "pairs_of",
    "position",
    "rank",
    "real",
    "result_table",
    "row_6",
    "rows_1_5",
    "rows_4_7_8_9",
    "rows_meet",
    "table",
    "theta_1",
    "theta_1_sol",
    "theta_1_unsimplified",
    "theta_2",
    "theta_2_all",
    "theta_2_all_corrected",
    "theta_2_conds",
    "theta_2_sol",
    "two_solutions",
    "verification",
    "yc",
    "yc_sol",
]

Pair: TypeAlias = "tuple[Any, Any]"
"""θ_1 [rad] and y_c of a row."""


def eqns(
    t1: float, t2: float, xc: float, yc: float, zc: float, CameraX: float, CameraZ: float, NeckOffsetZ: float
) -> tuple[float, float, float]:
    """eq1, eq2 and eq3, all of which are to be zero."""
    return (
        xc * cos(t1) - CameraZ * sin(t2) - CameraX * cos(t2) + yc * sin(t1),
        yc * cos(t1) - xc * sin(t1),
        zc - NeckOffsetZ - CameraZ * cos(t2) + CameraX * sin(t2),
    )


def free_coordinates() -> int:
    """How many of x_c, y_c, z_c can be chosen: x_c and z_c, and y_c follows."""
    return 2


def theta_2_sol(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> tuple[Any, Any]:
    """Both rows with k = 0 [rad]."""
    root = sqrt(CameraX**2 + CameraZ**2 - NeckOffsetZ**2 + 2 * NeckOffsetZ * zc - zc**2)
    return (
        -2 * atan((CameraX - root) / (CameraZ - NeckOffsetZ + zc)),
        -2 * atan((CameraX + root) / (CameraZ - NeckOffsetZ + zc)),
    )


def theta_2_conds(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> bool:
    """The condition of both rows."""
    return CameraZ + zc != NeckOffsetZ and (NeckOffsetZ - zc) ** 2 <= CameraX**2 + CameraZ**2


def theta_2_all(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> tuple[Any, ...]:
    """Every θ_2 that the example finds [rad]: both rows where their condition holds."""
    holds = theta_2_conds(CameraX, CameraZ, NeckOffsetZ, zc)
    return theta_2_sol(CameraX, CameraZ, NeckOffsetZ, zc) if holds else ()


def theta_2_all_corrected(CameraX: float, CameraZ: float, NeckOffsetZ: float, zc: float) -> tuple[float, ...]:
    """θ_2 [rad] from z_c − NeckOffsetZ = r cos(θ_2 + φ), without the half angle, which has no tangent at π."""
    r, phi = hypot(CameraX, CameraZ), atan2(CameraX, CameraZ)
    between = acos((zc - NeckOffsetZ) / r)
    return between - phi, -between - phi


def theta_1_sol(CameraX: float, CameraZ: float, xc: float, t2: float) -> tuple[Any, Any]:
    """Rows 2 and 3 of the simplified theta_1_sol [rad]."""
    s1 = 2 * atan(
        sqrt(CameraX * cos(t2) - xc + CameraZ * sin(t2))
        * sqrt(xc + CameraX * cos(t2) + CameraZ * sin(t2))
        / (xc + CameraX * cos(t2) + CameraZ * sin(t2))
    )
    return s1, -s1


def theta_1_unsimplified(CameraX: float, CameraZ: float, xc: float, t2: float) -> tuple[Any, Any]:
    """The same before the substitution [rad]; its fraction bars and roots are lost in print and read so."""
    sigma_5 = tan(t2 / 2) ** 2
    sigma_4 = CameraX + xc - CameraX * sigma_5 + xc * sigma_5 + 2 * CameraZ * tan(t2 / 2)
    sigma_3 = sqrt(-(xc - CameraX + CameraX * sigma_5 + xc * sigma_5 - 2 * CameraZ * tan(t2 / 2))) * sqrt(sigma_4)
    s2 = 2 * atan((sigma_3 / (sigma_5 + 1) + sigma_5 * sigma_3 / (sigma_5 + 1)) / sigma_4)
    return s2, -s2


def yc_sol(CameraX: float, CameraZ: float, xc: float, t2: float) -> tuple[Any, Any, Any, Any]:
    """Rows 2, 3, 7 and 8 of yc_sol."""
    T = tan(t2 / 2)
    y1 = (
        sqrt(-(xc - CameraX + CameraX * T**2 + xc * T**2 - 2 * CameraZ * T))
        * sqrt(CameraX + xc - CameraX * T**2 + xc * T**2 + 2 * CameraZ * T)
        / (T**2 + 1)
    )
    y2 = (-CameraX * T**2 + 2 * CameraZ * T + CameraX) / (T**2 + 1)
    return y1, -y1, y2, -y2


def rows_1_5(CameraX: float, xc: float) -> tuple[Pair, Pair]:
    """Rows 1 and 5 of theta_1_sol and yc_sol."""
    w = sqrt(CameraX + xc) * sqrt(CameraX - xc) / (CameraX - xc)
    y = sqrt(CameraX + xc) * sqrt(CameraX - xc)
    return (-2 * atan(w), y), (2 * atan(w), -y)


def rows_4_7_8_9(CameraX: float, CameraZ: float, t2: float) -> tuple[Pair, Pair, Pair, Pair]:
    """Rows 4, 7, 8 and 9 of theta_1_sol and yc_sol."""
    T = tan(t2 / 2)
    y2 = (-CameraX * T**2 + 2 * CameraZ * T + CameraX) / (T**2 + 1)
    return (-pi / 2, CameraX), (pi / 2, y2), (-pi / 2, -y2), (pi / 2, -CameraX)


def row_6() -> tuple[Pair]:
    """Row 6 of theta_1_sol and yc_sol, after the parameter x is set to 0."""
    return ((0, 0),)


def verification(
    known: tuple[float, float, float], CameraX: float, CameraZ: float, NeckOffsetZ: float
) -> list[tuple[float, float]]:
    """The verification run for one position (x, y, z): the pairs (θ_1, θ_2) [rad] that it accepts.

    The conditions of theta_1_sol are not printed; a row counts here if it is a real number.
    """
    x_known, y_known, z_known = known
    pairs = []
    for t2 in theta_2_all(CameraX, CameraZ, NeckOffsetZ, z_known):
        for t1, y_derived in _nine_rows(CameraX, CameraZ, x_known, t2):
            if np.isreal(t1) and abs(y_known - y_derived) < max(100 * 2.2e-16, 1e-6 * abs(y_known)):
                pairs.append((float(np.real(t1)), float(t2)))
    return pairs


def _nine_rows(CameraX: float, CameraZ: float, xc: float, t2: float) -> Iterator[Pair]:
    first, fifth = rows_1_5(CameraX, xc)
    second, third = zip(theta_1_sol(CameraX, CameraZ, xc, t2), yc_sol(CameraX, CameraZ, xc, t2)[:2], strict=True)
    fourth, *others = rows_4_7_8_9(CameraX, CameraZ, t2)
    yield from (first, second, third, fourth, fifth, *row_6(), *others)


def result_table() -> tuple[tuple[float, float, float, float], ...]:
    """θ_1 and θ_2 known, θ_1 and θ_2 derived [rad]."""
    return (
        (0.7854, 0.3927, 0.7854, 0.3927),
        (0.7854, 0.3927, -2.3562, -1.7346),
        (0.5236, -0.2618, 0.5236, -0.2618),
        (0.5236, -0.2618, -2.618, -1.0801),
        (0.3927, 0.19635, 0.3927, 0.19635),
        (0.3927, 0.19635, -2.7489, -1.5383),
        (0.31416, -0.31416, 0.31416, -0.31416),
        (0.31416, -0.31416, -2.8274, -1.0278),
    )


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


_CAMERA: Final = "the position of a camera on a yaw and a pitch joint, by Pinocchio's rotations"
_ANY: Final = "300 random cameras, necks and angles in ±π, 0.05 rad away from double solutions"
_BACK: Final = "θ_2 = π, where tan(θ_2/2) has no value: the branch that these rows are for"


def _rows_7_8(form: Form) -> Measured:
    check = rows_meet(lambda c: (c.x, c.z, c.t2), lambda: cases(xc=0.0))
    return check(lambda *lengths: form(*lengths)[1:3])


_EQUATIONS: Final = (
    Claim(
        id="004:eqns",
        place="step 3",
        said="Three equations that vanish where the head has the angles.",
        formula="eq1 = x_c cos θ_1 − CameraZ sin θ_2 − CameraX cos θ_2 + y_c sin θ_1\n"
        "eq2 = y_c cos θ_1 − x_c sin θ_1\n"
        "eq3 = z_c − NeckOffsetZ − CameraZ cos θ_2 + CameraX sin θ_2",
        latex=r"\begin{pmatrix} x_c \cos\theta_1 - CameraZ \sin\theta_2 - CameraX \cos\theta_2 + y_c \sin\theta_1 \\ "
        r"y_c \cos\theta_1 - x_c \sin\theta_1 \\ z_c - NeckOffsetZ - CameraZ \cos\theta_2 + CameraX \sin\theta_2 "
        r"\end{pmatrix}",
        printed=eqns,
        check=equations,
        reference=_CAMERA,
        domain=_ANY,
    ),
    Claim(
        id="004:3-free-coordinates",
        place="step 3, text",
        said="Of x_c, y_c and z_c two can be chosen; the third follows.",
        formula="2 of 3",
        printed=free_coordinates,
        check=rank,
        reference="the rank of the position's derivative by the two angles",
        domain=_ANY,
    ),
    Claim(
        id="004:theta_2_sol",
        place="step 3, theta_2_sol",
        said="The two pitches for a height z_c.",
        formula="θ_2 = −2 atan((CameraX ∓ √(CameraX² + CameraZ² − NeckOffsetZ²\n"
        "      + 2 NeckOffsetZ z_c − z_c²))/(CameraZ − NeckOffsetZ + z_c))",
        latex=r"\theta_2 = -2 \arctan \frac{CameraX \mp \sqrt{CameraX^2 + CameraZ^2 - NeckOffsetZ^2 + "
        r"2\,NeckOffsetZ\,z_c - z_c^2}}{CameraZ - NeckOffsetZ + z_c}",
        printed=theta_2_sol,
        check=theta_2,
        reference=_CAMERA,
        domain=_ANY + "; where CameraZ + z_c = NeckOffsetZ see 004:theta_2-lost",
        unit="rad",
    ),
    Claim(
        id="004:theta_2_conds",
        place="step 3, theta_2_conds",
        said="When the two rows of theta_2_sol are real numbers.",
        formula="CameraZ + z_c ≠ NeckOffsetZ  and  (NeckOffsetZ − z_c)² ≤ CameraX² + CameraZ²",
        latex=r"CameraZ + z_c \neq NeckOffsetZ \;\wedge\; (NeckOffsetZ - z_c)^2 \leq CameraX^2 + CameraZ^2",
        printed=theta_2_conds,
        check=conditions,
        reference="the roots of the quadratic equation of tan(θ_2/2)",
        domain="300 heights in and out of reach; exactly at its end, 1e-6 beyond it, at the excluded one",
    ),
    Claim(
        id="004:theta_2-lost",
        place="step 3, theta_2_sol with theta_2_conds",
        said="Under their condition the rows are all solutions of eq3, k being set to 0.",
        formula="θ_2 = theta_2_sol  if  theta_2_conds",
        printed=theta_2_all,
        check=every_theta_2,
        reference=_CAMERA,
        domain="300 cameras at the excluded height, CameraZ + z_c = NeckOffsetZ",
        unit="rad",
        correction=Correction(
            theta_2_all_corrected,
            "θ_2 = ±arccos((z_c − NeckOffsetZ)/√(CameraX² + CameraZ²)) − atan2(CameraX, CameraZ)",
            r"\theta_2 = \pm\arccos \frac{z_c - NeckOffsetZ}{\sqrt{CameraX^2 + CameraZ^2}} - "
            r"\operatorname{atan2}(CameraX, CameraZ)",
            "The half angle has no tangent at θ_2 = π, and takes the other solution of that height with it.",
        ),
    ),
)

_ROWS: Final = (
    Claim(
        id="004:theta_1_sol",
        place="step 3, theta_1_sol, rows 2 and 3",
        said="The two yaws for x_c, once the pitch is known.",
        formula="θ_1 = ±2 atan(√(ρ − x_c) √(x_c + ρ)/(x_c + ρ)),\nρ = CameraX cos θ_2 + CameraZ sin θ_2",
        latex=r"\theta_1 = \pm 2 \arctan \frac{\sqrt{\rho - x_c} \sqrt{x_c + \rho}}{x_c + \rho},\quad "
        r"\rho = CameraX \cos\theta_2 + CameraZ \sin\theta_2",
        printed=theta_1_sol,
        check=theta_1,
        reference=_CAMERA,
        domain=_ANY + ", complex roots",
        unit="rad",
    ),
    Claim(
        id="004:theta_1-unsimplified",
        place="step 3, theta_1_sol before the substitution, rows 2 and 3",
        said="The same before it is simplified; its roots and fraction bars are not legible and read as they must be.",
        formula="θ_1 = ±2 atan((σ_3/(σ_5 + 1) + σ_5 σ_3/(σ_5 + 1))/σ_4),\n"
        "σ_3 = √(−x_c + CameraX − CameraX σ_5 − x_c σ_5 + 2 CameraZ tan(θ_2/2)) √σ_4,\n"
        "σ_4 = CameraX + x_c − CameraX σ_5 + x_c σ_5 + 2 CameraZ tan(θ_2/2),\nσ_5 = tan²(θ_2/2)",
        printed=theta_1_unsimplified,
        check=theta_1,
        reference=_CAMERA,
        domain=_ANY + ", complex roots",
        unit="rad",
    ),
    Claim(
        id="004:yc_sol",
        place="step 3, yc_sol, rows 2, 3, 7 and 8",
        said="The y_c that goes with each yaw.",
        formula="y_c = ±√(−(x_c − CameraX + CameraX T² + x_c T² − 2 CameraZ T))\n"
        "      √(CameraX + x_c − CameraX T² + x_c T² + 2 CameraZ T)/(T² + 1)\n"
        "y_c = ±(−CameraX T² + 2 CameraZ T + CameraX)/(T² + 1),  T = tan(θ_2/2)",
        latex=r"y_c = \pm\frac{\sqrt{-(x_c - CameraX + CameraX T^2 + x_c T^2 - 2 CameraZ T)} \sqrt{CameraX + x_c - "
        r"CameraX T^2 + x_c T^2 + 2 CameraZ T}}{T^2 + 1},\quad y_c = \pm\frac{-CameraX T^2 + 2 CameraZ T + CameraX}"
        r"{T^2 + 1}",
        printed=yc_sol,
        check=yc,
        reference=_CAMERA,
        domain=_ANY + ", rows 2 and 3 at the yaws of 004:theta_1_sol, rows 7 and 8 at ±π/2; complex roots",
    ),
    Claim(
        id="004:theta_1-rows-1-5",
        place="step 3, theta_1_sol and yc_sol, rows 1 and 5",
        said="Two more yaws, without the pitch.",
        formula="θ_1 = ∓2 atan(w),  y_c = ±√(CameraX + x_c) √(CameraX − x_c),\n"
        "w = √(CameraX + x_c) √(CameraX − x_c)/(CameraX − x_c)",
        latex=r"\theta_1 = \mp 2 \arctan \frac{\sqrt{CameraX + x_c} \sqrt{CameraX - x_c}}{CameraX - x_c},\quad "
        r"y_c = \pm\sqrt{CameraX + x_c} \sqrt{CameraX - x_c}",
        printed=rows_1_5,
        check=rows_meet(lambda c: (c.x, c.at[0]), cases),
        reference=_CAMERA,
        domain=_ANY,
        conventions={_BACK: rows_meet(lambda c: (c.x, c.at[0]), lambda: cases(t2=pi))},
    ),
    Claim(
        id="004:theta_1-rows-4-7-8-9",
        place="step 3, theta_1_sol and yc_sol, rows 4, 7, 8 and 9",
        said="The yaws ±π/2.",
        formula="(θ_1, y_c) = (−π/2, CameraX), (π/2, y_2), (−π/2, −y_2), (π/2, −CameraX)",
        latex=r"(\theta_1, y_c) = (-\tfrac{\pi}{2}, CameraX),\; (\tfrac{\pi}{2}, y_2),\; (-\tfrac{\pi}{2}, -y_2),\; "
        r"(\tfrac{\pi}{2}, -CameraX)",
        printed=rows_4_7_8_9,
        check=rows_meet(lambda c: (c.x, c.z, c.t2), cases),
        reference=_CAMERA,
        domain=_ANY,
        conventions={
            "x_c = 0, and for rows 4 and 9 also θ_2 = π": both(
                rows_meet(lambda c: (c.x, c.z, c.t2), lambda: cases(t2=pi, xc=0.0)),
                _rows_7_8,
            )
        },
    ),
    Claim(
        id="004:theta_1-row-6",
        place="step 3, theta_1_sol and yc_sol, row 6",
        said="A yaw of 0; before the parameter x was set to 0, any yaw.",
        formula="(θ_1, y_c) = (0, 0)",
        latex=r"(\theta_1, y_c) = (0, 0)",
        printed=row_6,
        check=rows_meet(lambda _: (), cases),
        reference=_CAMERA,
        domain=_ANY,
        conventions={
            "the camera is on the yaw axis, where every yaw is a solution": rows_meet(lambda _: (), on_the_axis)
        },
    ),
)

_RUN: Final = (
    Claim(
        id="004:result-table",
        place="step 4, table T",
        said="Eight rows: four pairs of angles, and the two pairs that the inverse finds for each.",
        formula="θ_1 known  θ_2 known  θ_1 derived  θ_2 derived  (8 rows)",
        printed=result_table,
        check=table,
        reference="the true pairs that bring the camera to the same position",
        domain="the four pairs of the run, CameraX = 53.9, CameraZ = 67.9, NeckOffsetZ = −5",
        unit="rad",
        tolerance=5e-5,
    ),
    Claim(
        id="004:4-two-solutions",
        place="step 4, text and listing",
        said="For every pair of angles the run finds two pairs, one of them the one that it began with.",
        formula="|y_known − y_derived| < max(100 eps, 1e-6 |y_known|)",
        latex=r"|y_{known} - y_{derived}| < \max(100\,\mathrm{eps},\; 10^{-6} |y_{known}|)",
        printed=verification,
        check=two_solutions,
        reference="the true pairs that bring the camera to the same position",
        domain="300 poses inside the head's limits, lengths of the run; the share of poses for which it does not",
    ),
)

CLAIMS: Final = (*_EQUATIONS, *_ROWS, *_RUN)
