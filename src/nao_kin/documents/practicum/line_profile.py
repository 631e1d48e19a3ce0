"""Motion along a line in three phases, from first principles: the truth that the practicum's section 2 is held against.

The acceleration is given, phase by phase; velocity and position are its integrals. No formula of the sheet is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from numpy.polynomial import Polynomial

from nao_kin.documents.claim import Claim, Correction, Measured

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.documents.claim import Check, Form

__all__ = ["CLAIMS", "LineMotion", "Short", "motions", "short_motions"]

Short: TypeAlias = "tuple[LineMotion, float, tuple[float, float, float]]"


@dataclass(frozen=True, slots=True)
class LineMotion:
    """Speeding up, cruising, braking to rest; a distance too short for that has no cruise and a lower peak.

    Attributes:
        t: Times t_0, t_1, t_2, t_n [s].
        p: Positions then [m].
        a_0: Acceleration of the first phase [m/s²], positive.
        a_n: Acceleration of the last phase [m/s²], negative; the sheet also calls it a_2.
        peak: Largest speed, reached at t_1 [m/s].
    """

    t: tuple[float, float, float, float]
    p: tuple[float, float, float, float]
    a_0: float
    a_n: float
    peak: float

    @classmethod
    def of(
        cls, accelerations: tuple[float, float, float], durations: tuple[float, float, float], t_0: float, p_0: float
    ) -> LineMotion:
        """Integrates accelerations [m/s²] over the durations [s] of the phases, from rest at p_0 [m] and t_0 [s]."""
        times, positions, speeds = [t_0], [p_0], [0.0]
        for acceleration, duration in zip(accelerations, durations, strict=True):
            speed = Polynomial([acceleration]).integ(k=speeds[-1])
            positions.append(float(speed.integ(k=positions[-1])(duration)))
            speeds.append(float(speed(duration)))
            times.append(times[-1] + duration)
        t, p = (tuple(values) for values in (times, positions))
        return cls(t, p, accelerations[0], accelerations[2], speeds[1])  # type: ignore[arg-type]

    def at(self, t: float) -> tuple[float, float, float]:
        """Position [m], velocity [m/s] and acceleration [m/s²] at a time within the motion [s]."""
        phase = 0 if t <= self.t[1] else 1 if t <= self.t[2] else 2
        acceleration, start = (self.a_0, 0.0, self.a_n)[phase], (0.0, self.peak, self.peak)[phase]
        speed = Polynomial([acceleration]).integ(k=start)
        since = t - self.t[phase]
        return float(speed.integ(k=self.p[phase])(since)), float(speed(since)), acceleration


def motions(count: int, seed: int, t_0: float | None = None, p_0: float | None = None) -> Iterator[LineMotion]:
    """Motions with a cruise: rates and durations at random, unless given also the start in time [s] and place [m]."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        up, cruise, down = rng.uniform(0.2, 2.0, 3)
        peak, start, place = rng.uniform(0.1, 1.0), rng.uniform(0.5, 2.0), rng.uniform(-1.0, 1.0)
        accelerations = (peak / up, 0.0, -peak / down)
        start, place = start if t_0 is None else t_0, place if p_0 is None else p_0
        yield LineMotion.of(accelerations, (up, cruise, down), start, place)


def short_motions(count: int, seed: int, equal: bool = False) -> Iterator[Short]:
    """Motions too short for their allowed speed, each with that speed [m/s] and the times that cruising would need.

    The times are t_1, t_2 and t_n [s] of (28), (33) and (30): from the start at 0, t_1 until the allowed speed, a
    cruise of negative length, and braking from the allowed speed.

    Args:
        count: How many.
        seed: Of the random generator.
        equal: Brake as hard as speeding up, as task 2c says.
    """
    rng = np.random.default_rng(seed)
    for _ in range(count):
        a_0, a_n, allowed = rng.uniform(0.2, 2.0), -rng.uniform(0.2, 2.0), rng.uniform(0.1, 1.0)
        a_n = -a_0 if equal else a_n
        peak = allowed * rng.uniform(0.05, 0.95)
        motion = LineMotion.of((a_0, 0.0, a_n), (peak / a_0, 0.0, peak / -a_n), 0.0, 0.0)
        needed = LineMotion.of((a_0, 0.0, a_n), (allowed / a_0, 0.0, allowed / -a_n), 0.0, 0.0).p[-1]
        t_1 = allowed / a_0
        t_2 = t_1 + (motion.p[-1] - needed) / allowed
        yield motion, allowed, (t_1, t_2, t_2 + allowed / -a_n)


def eq_17(t: float, p_0: float, p_1: float, t_0: float, t_n: float) -> float:
    """(17)."""
    return p_0 + t * (p_1 - p_0) / (t_n - t_0)


def eq_17_corrected(t: float, p_0: float, p_n: float, t_0: float, t_n: float) -> float:
    """(17) for any start, to the end point."""
    return p_0 + (t - t_0) * (p_n - p_0) / (t_n - t_0)


def eq_18(t: float, p_0: float, p_1: float, t_0: float, t_n: float) -> float:
    """(18)."""
    v = (p_1 - p_0) / (t_n - t_0)
    return p_0 + v * t


def eq_19(a_0: float) -> float:
    """(19): the acceleration of the first phase, at any time of it."""
    return a_0


def eq_20(a_0: float, t: float) -> float:
    """(20)."""
    return a_0 * t


def eq_21(a_0: float, t: float) -> float:
    """(21)."""
    return 1 / 2 * a_0 * t**2


def eq_22() -> float:
    """(22)."""
    return 0


def eq_23(v_0: Callable[[float], float], t_1: float) -> float:
    """(23): the speed of the second phase, at any time of it."""
    return v_0(t_1)


def eq_24(p_0: Callable[[float], float], v_0: Callable[[float], float], t: float, t_1: float) -> float:
    """(24)."""
    return p_0(t_1) + v_0(t_1) * (t - t_1)


def eq_25(a_n: float) -> float:
    """(25): the acceleration of the last phase, at any time of it."""
    return a_n


def eq_26(v_1: Callable[[float], float], a_n: float, t: float, t_2: float) -> float:
    """(26)."""
    return v_1(t_2) + a_n * (t - t_2)


def eq_27(p_1: Callable[[float], float], v_1: Callable[[float], float], a_2: float, t: float, t_2: float) -> float:
    """(27)."""
    return p_1(t_2) + v_1(t_2) * (t - t_2) + 1 / 2 * a_2 * (t - t_2) ** 2


def eq_28(v_max: float, a_0: float) -> float:
    """(28): t_1 − t_0."""
    return v_max / a_0


def eq_29(a_2: float, t_1: float) -> float:
    """(29): p_1 − p_0."""
    return 1 / 2 * a_2 * t_1**2


def eq_29_corrected(a_0: float, t_1: float, t_0: float) -> float:
    """p_1 − p_0 with the acceleration of its own phase, and from any start."""
    return 1 / 2 * a_0 * (t_1 - t_0) ** 2


def eq_30(v_max: float, a_2: float) -> float:
    """(30): t_n − t_2."""
    return -v_max / a_2


def eq_31(a_2: float, t_n: float, t_2: float) -> float:
    """(31): p_n − p_2."""
    return -1 / 2 * a_2 * (t_n - t_2) ** 2


def eq_32(p_0: float, p_1: float, p_2: float, p_n: float, v_max: float, t_1: float, t_2: float) -> tuple[float, float]:
    """(32): both expressions for p_2 − p_1."""
    return v_max * (t_2 - t_1), (p_n - p_0) - (p_1 - p_0) - (p_n - p_2)


def eq_33(p_1: float, p_2: float, v_max: float) -> float:
    """(33): t_2 − t_1."""
    return (p_2 - p_1) / v_max


def eq_34(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """(34): t_1,kurz − t_0."""
    return t_1 + abs(a_0) / (abs(a_0) + abs(a_n)) * (t_2 - t_1)


def eq_34_corrected(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """t_1,kurz − t_0, from the peak v² = v_max² + 2 v_max (t_2 − t_1) |a_0||a_n|/(|a_0| + |a_n|) that is left."""
    return sqrt(t_1**2 + 2 * abs(a_n) / (abs(a_0) + abs(a_n)) * t_1 * (t_2 - t_1))


def eq_35(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """(35): t_n,kurz − t_2."""
    return t_1 + abs(a_n) / (abs(a_0) + abs(a_n)) * (t_2 - t_1)


def eq_35_corrected(t_1: float, t_2: float, t_n: float, a_0: float, a_n: float) -> float:
    """t_n,kurz − t_1,kurz: braking begins where speeding up ends, and has its own length t_n − t_2."""
    down = t_n - t_2
    return sqrt(down**2 + 2 * abs(a_0) / (abs(a_0) + abs(a_n)) * down * (t_2 - t_1))


def eq_36(a_0: float, a_n: float, t_0: float, t_1_short: float) -> tuple[float, float]:
    """(36): both expressions for v_max,kurz."""
    return a_0 * (t_1_short - t_0), a_n * (t_1_short - t_0)


def eq_36_corrected(a_0: float, a_n: float, t_0: float, t_1_short: float, t_n_short: float) -> tuple[float, float]:
    """The second in the braking phase, whose acceleration is negative."""
    return a_0 * (t_1_short - t_0), -a_n * (t_n_short - t_1_short)


def short_distance(t_1: float, t_2: float, a_0: float, a_n: float) -> float:
    """Section 2.2 as one procedure: where a motion by (34), (35) and the first of (36) ends, from 0 [m]."""
    up, down = eq_34(t_1, t_2, a_0, a_n), eq_35(t_1, t_2, a_0, a_n)
    v_max = eq_36(a_0, a_n, 0.0, up)[0]
    return v_max * up / 2 + v_max * down / 2


def short_distance_corrected(t_1: float, t_2: float, t_n: float, a_0: float, a_n: float) -> float:
    """The same by the corrected equations."""
    up, down = eq_34_corrected(t_1, t_2, a_0, a_n), eq_35_corrected(t_1, t_2, t_n, a_0, a_n)
    v_max = eq_36_corrected(a_0, a_n, 0.0, up, up + down)[0]
    return v_max * up / 2 + v_max * down / 2


def cruise_is_negative(p_1: float, p_2: float, v_max: float) -> bool:
    """Section 2.2: the case is the one in which (33) is negative."""
    return eq_33(p_1, p_2, v_max) < 0


_COUNT, _SEED = 60, 1
_PHASES: Final = "integrals of an acceleration that is constant in each phase"
_ANY: Final = "60 motions with a cruise, starting at any time and place, at a random time of the phase"

_CLOCK: Final = "the clock starts with the motion, t_0 = 0"
_LINE: Final = "p_1 is the end point and t counts from the start t_0"
_ORIGIN: Final = "clock and position start with the motion, t_0 = 0 and p_0 = 0"


def _over(
    apart: Callable[[Form, LineMotion, float], float],
    phase: int | None = None,
    t_0: float | None = None,
    p_0: float | None = None,
) -> Check:
    """A check over motions with a cruise, each at a random time of a phase, or of the whole motion."""

    def check(form: Form) -> Measured:
        rng, drawn = np.random.default_rng(_SEED + 1), list(motions(_COUNT, _SEED, t_0, p_0))
        first, last = (0, 3) if phase is None else (phase, phase + 1)
        times = [rng.uniform(m.t[first], m.t[last]) for m in drawn]
        return Measured.worst(
            [apart(form, m, t) for m, t in zip(drawn, times, strict=True)],
            lambda i: f"t_0 = {drawn[i].t[0]:.3g} s, t = {times[i]:.3g} s, p_0 = {drawn[i].p[0]:.3g} m",
        )

    return check


def _line(end: int, from_start: bool) -> Check:
    """(17) and (18) against the straight line between start and end.

    Args:
        end: Which p is taken for p_1.
        from_start: Whether t counts from the start of the motion, otherwise from that of the clock.
    """

    def apart(form: Form, m: LineMotion, t: float) -> float:
        share = (t - m.t[0]) / (m.t[3] - m.t[0])
        on_line = (1.0 - share) * m.p[0] + share * m.p[3]
        return float(form(t - m.t[0] if from_start else t, m.p[0], m.p[end], m.t[0], m.t[3])) - on_line

    return _over(apart)


def _place(m: LineMotion) -> Callable[[float], float]:
    return lambda t: m.at(t)[0]


def _speed(m: LineMotion) -> Callable[[float], float]:
    return lambda t: m.at(t)[1]


def _two(found: tuple[float, float], wanted: float) -> float:
    return max(abs(value - wanted) for value in found)


def _claim(number: str, said: str, formula: str, latex: str, form: Form, check: Check, unit: str, **more: Any) -> Claim:
    domain = more.pop("domain", _ANY)
    return Claim(
        id=f"001:eq-{number}",
        place=f"equation ({number})",
        said=said,
        formula=formula,
        latex=latex,
        printed=form,
        check=check,
        reference=_PHASES,
        domain=domain,
        unit=unit,
        **more,
    )


_LINES: Final = (
    _claim(
        "17",
        "A straight line from p_0 to p_n is walked in the time t_n − t_0.",
        "p(t) = p_0 + t (p_1 − p_0)/(t_n − t_0)",
        r"p(t) = p_0 + t \cdot \frac{p_1 - p_0}{t_n - t_0}",
        eq_17,
        _line(end=1, from_start=False),
        "m",
        conventions={_LINE: _line(end=3, from_start=True)},
        domain="60 lines; as it stands with the p_1 and t that the same section defines for its phases",
    ),
    _claim(
        "18",
        "The same with its speed v.",
        "p(t) = p_0 + v t,  v = (p_1 − p_0)/(t_n − t_0)",
        r"p(t) = p_0 + v \cdot t,\quad v = \frac{p_1 - p_0}{t_n - t_0}",
        eq_18,
        _line(end=1, from_start=False),
        "m",
        conventions={_LINE: _line(end=3, from_start=True)},
        domain="60 lines; as it stands with the p_1 and t that the same section defines for its phases",
    ),
)

_SPEEDING_UP: Final = (
    _claim(
        "19",
        "The first phase has a constant acceleration.",
        "a_0 = const",
        r"a_0 = \mathrm{const}",
        eq_19,
        _over(lambda form, m, t: form(m.a_0) - m.at(t)[2], phase=0),
        "m/s²",
    ),
    _claim(
        "20",
        "The speed in the first phase.",
        "v_0(t) = a_0 t",
        r"v_0(t) = a_0 t",
        eq_20,
        _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[1], phase=0),
        "m/s",
        conventions={_CLOCK: _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[1], phase=0, t_0=0.0)},
    ),
    _claim(
        "21",
        "The position in the first phase.",
        "p_0(t) = ½ a_0 t²",
        r"p_0(t) = \frac{1}{2} a_0 t^2",
        eq_21,
        _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[0], phase=0),
        "m",
        conventions={_ORIGIN: _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[0], phase=0, t_0=0.0, p_0=0.0)},
    ),
    _claim(
        "28",
        "How long the first phase takes.",
        "t_1 − t_0 = v_max/a_0",
        r"t_1 - t_0 = \frac{v_{max}}{a_0}",
        eq_28,
        _over(lambda form, m, _: form(m.peak, m.a_0) - (m.t[1] - m.t[0])),
        "s",
    ),
    _claim(
        "29",
        "How far the first phase goes.",
        "p_1 − p_0 = ½ a_2 t_1²",
        r"p_1 - p_0 = \frac{1}{2} a_2 t_1^2",
        eq_29,
        _over(lambda form, m, _: form(m.a_n, m.t[1]) - (m.p[1] - m.p[0])),
        "m",
        correction=Correction(
            eq_29_corrected,
            "p_1 − p_0 = ½ a_0 (t_1 − t_0)²",
            r"p_1 - p_0 = \frac{1}{2} a_0 (t_1 - t_0)^2",
            "a_2 is the braking acceleration, which is negative; the phase has a_0, and starts at t_0.",
            _over(lambda form, m, _: form(m.a_0, m.t[1], m.t[0]) - (m.p[1] - m.p[0])),
        ),
    ),
)

_CRUISE: Final = (
    _claim(
        "22",
        "The second phase has no acceleration.",
        "a_1 = 0",
        r"a_1 = 0",
        eq_22,
        _over(lambda form, m, t: form() - m.at(t)[2], phase=1),
        "m/s²",
    ),
    _claim(
        "23",
        "The speed of the second phase is that at the end of the first, the largest one.",
        "v_1(t) = v_0(t_1) = v_max",
        r"v_1(t) = v_0(t_1) = v_{max}",
        eq_23,
        _over(lambda form, m, t: _two((form(_speed(m), m.t[1]), m.peak), m.at(t)[1]), phase=1),
        "m/s",
    ),
    _claim(
        "24",
        "The position in the second phase.",
        "p_1(t) = p_0(t_1) + v_0(t_1) (t − t_1)",
        r"p_1(t) = p_0(t_1) + v_0(t_1) \cdot (t - t_1)",
        eq_24,
        _over(lambda form, m, t: form(_place(m), _speed(m), t, m.t[1]) - m.at(t)[0], phase=1),
        "m",
    ),
    _claim(
        "32",
        "How far the second phase goes, from its speed and from what the others leave.",
        "p_2 − p_1 = v_max (t_2 − t_1) = (p_n − p_0) − (p_1 − p_0) − (p_n − p_2)",
        r"p_2 - p_1 = v_{max} \cdot (t_2 - t_1) = (p_n - p_0) - (p_1 - p_0) - (p_n - p_2)",
        eq_32,
        _over(lambda form, m, _: _two(form(*m.p, m.peak, m.t[1], m.t[2]), m.p[2] - m.p[1])),
        "m",
    ),
    _claim(
        "33",
        "How long the second phase takes.",
        "t_2 − t_1 = (p_2 − p_1)/v_max",
        r"t_2 - t_1 = \frac{p_2 - p_1}{v_{max}}",
        eq_33,
        _over(lambda form, m, _: form(m.p[1], m.p[2], m.peak) - (m.t[2] - m.t[1])),
        "s",
    ),
)

_BRAKING: Final = (
    _claim(
        "25",
        "The last phase has a constant acceleration.",
        "a_n = const",
        r"a_n = \mathrm{const}",
        eq_25,
        _over(lambda form, m, t: form(m.a_n) - m.at(t)[2], phase=2),
        "m/s²",
    ),
    _claim(
        "26",
        "The speed in the last phase; a_n is negative.",
        "v_n(t) = v_1(t_2) + a_n (t − t_2)",
        r"v_n(t) = v_1(t_2) + a_n (t - t_2)",
        eq_26,
        _over(lambda form, m, t: form(_speed(m), m.a_n, t, m.t[2]) - m.at(t)[1], phase=2),
        "m/s",
    ),
    _claim(
        "27",
        "The position in the last phase, whose acceleration is called a_2 here.",
        "p_n(t) = p_1(t_2) + v_1(t_2) (t − t_2) + ½ a_2 (t − t_2)²",
        r"p_n(t) = p_1(t_2) + v_1(t_2) \cdot (t - t_2) + \frac{1}{2} a_2 (t - t_2)^2",
        eq_27,
        _over(lambda form, m, t: form(_place(m), _speed(m), m.a_n, t, m.t[2]) - m.at(t)[0], phase=2),
        "m",
    ),
    _claim(
        "30",
        "How long the last phase takes; a_2 is negative.",
        "t_n − t_2 = −v_max/a_2",
        r"t_n - t_2 = \frac{-v_{max}}{a_2}",
        eq_30,
        _over(lambda form, m, _: form(m.peak, m.a_n) - (m.t[3] - m.t[2])),
        "s",
    ),
    _claim(
        "31",
        "How far the last phase goes; a_2 is negative.",
        "p_n − p_2 = −½ a_2 (t_n − t_2)²",
        r"p_n - p_2 = -\frac{1}{2} a_2 (t_n - t_2)^2",
        eq_31,
        _over(lambda form, m, _: form(m.a_n, m.t[3], m.t[2]) - (m.p[3] - m.p[2])),
        "m",
    ),
)

_LONG: Final = tuple(sorted((*_LINES, *_SPEEDING_UP, *_CRUISE, *_BRAKING), key=lambda claim: claim.id))


_TRIANGLE: Final = "motions that speed up and brake without a cruise, integrated"
_SHORT: Final = "60 motions too short for their allowed speed, rates 0.2 to 2 m/s², started at t_0 = 0"


def _over_short(apart: Callable[[Form, Short], float]) -> Check:
    """A check over motions too short for their allowed speed."""

    def check(form: Form) -> Measured:
        drawn = list(short_motions(_COUNT, _SEED))
        return Measured.worst(
            [apart(form, each) for each in drawn],
            lambda i: (
                f"{1e3 * drawn[i][0].p[3]:.3g} mm with a_0 = {drawn[i][0].a_0:.3g} and a_n = "
                f"{drawn[i][0].a_n:.3g} m/s², v_max = {drawn[i][1]:.3g} m/s"
            ),
        )

    return check


def _length_of(up: bool) -> Callable[[Form, Short], float]:
    """Deviation of (34), or (35): the length of speeding up, or of braking, of a short motion [s]."""

    def apart(form: Form, short: Short) -> float:
        m, _, (t_1, t_2, _) = short
        length = m.t[1] - m.t[0] if up else m.t[3] - m.t[2]
        return float(form(t_1, t_2, m.a_0, m.a_n)) - length

    return apart


def _end(form: Form) -> Measured:
    """Where motions by section 2.2 end, for braking as hard as speeding up (task 2c)."""
    drawn = list(short_motions(_COUNT, _SEED, equal=True))
    ends = [float(form(t[0], t[1], m.a_0, m.a_n)) for m, _, t in drawn]
    return _ends(drawn, ends)


def _end_corrected(form: Form) -> Measured:
    drawn = list(short_motions(_COUNT, _SEED, equal=True))
    return _ends(drawn, [float(form(*t, m.a_0, m.a_n)) for m, _, t in drawn])


def _ends(drawn: list[Short], ends: list[float]) -> Measured:
    wanted = np.array([m.p[3] for m, _, _ in drawn])
    missed = np.array(ends) - wanted
    return Measured.worst(
        missed,
        lambda i: f"{1e3 * wanted[i]:.4g} mm wanted, {1e3 * ends[i]:.4g} mm reached",
        found=f"Of {len(missed)} motions {int((np.abs(missed) > 1e-6).sum())} end elsewhere: by "
        f"{1e3 * float(np.median(np.abs(missed))):.3g} mm in the median, {1e3 * float(np.abs(missed).max()):.3g} mm at "
        f"worst, on distances of {1e3 * wanted.min():.3g} to {1e3 * wanted.max():.3g} mm.",
    )


def _condition(form: Form) -> Measured:
    """Whether the sign of (33) tells motions that are too short from those that are not."""
    wrong = [bool(form(m.p[1], m.p[2], m.peak)) for m in motions(_COUNT, _SEED)]
    wrong += [bool(form(0.0, 1e-9, 1.0)), not form(1e-9, 0.0, 1.0)]
    for m, allowed, _ in short_motions(_COUNT, _SEED):
        p_1, p_2 = allowed**2 / (2.0 * m.a_0), m.p[3] - allowed**2 / (-2.0 * m.a_n)
        wrong.append(not form(p_1, p_2, allowed))
    return Measured(float(np.mean(wrong)), len(wrong))


def _peaks(form: Form, short: Short) -> float:
    m = short[0]
    return max(abs(float(v) - m.peak) for v in form(m.a_0, m.a_n, m.t[0], m.t[1]))


def _peaks_corrected(form: Form, short: Short) -> float:
    m = short[0]
    return max(abs(float(v) - m.peak) for v in form(m.a_0, m.a_n, m.t[0], m.t[1], m.t[3]))


def _braking_corrected(form: Form, short: Short) -> float:
    m, _, (t_1, t_2, t_n) = short
    return float(form(t_1, t_2, t_n, m.a_0, m.a_n)) - (m.t[3] - m.t[2])


_SHORT_CLAIMS: Final = (
    Claim(
        id="001:eq-34",
        place="equation (34), its number not legible",
        said="How long speeding up takes when the distance is too short for v_max.",
        formula="t_1,kurz − t_0 = t_1 + |a_0|/(|a_0| + |a_n|) (t_2 − t_1)",
        latex=r"t_{1,kurz} - t_0 = t_1 + \frac{|a_0|}{|a_0| + |a_n|} \cdot (t_2 - t_1)",
        printed=eq_34,
        check=_over_short(_length_of(up=True)),
        reference=_TRIANGLE,
        domain=_SHORT,
        unit="s",
        correction=Correction(
            eq_34_corrected,
            "t_1,kurz − t_0 = √(t_1² + 2 |a_n|/(|a_0| + |a_n|) t_1 (t_2 − t_1)),  t_0 = 0",
            r"t_{1,kurz} - t_0 = \sqrt{t_1^2 + \frac{2 |a_n|}{|a_0| + |a_n|} \, t_1 (t_2 - t_1)}",
            "The distance is quadratic in the times, so is what shortens them; and speeding up gives way to the "
            "braking, so |a_n| belongs above.",
        ),
    ),
    Claim(
        id="001:eq-35",
        place="equation (35)",
        said="How long braking takes when the distance is too short for v_max.",
        formula="t_n,kurz − t_2 = t_1 + |a_n|/(|a_0| + |a_n|) (t_2 − t_1)",
        latex=r"t_{n,kurz} - t_2 = t_1 + \frac{|a_n|}{|a_0| + |a_n|} \cdot (t_2 - t_1)",
        printed=eq_35,
        check=_over_short(_length_of(up=False)),
        reference=_TRIANGLE,
        domain=_SHORT,
        unit="s",
        correction=Correction(
            eq_35_corrected,
            "t_n,kurz − t_1,kurz = √((t_n − t_2)² + 2 |a_0|/(|a_0| + |a_n|) (t_n − t_2) (t_2 − t_1))",
            r"t_{n,kurz} - t_{1,kurz} = "
            r"\sqrt{(t_n - t_2)^2 + \frac{2 |a_0|}{|a_0| + |a_n|} (t_n - t_2) (t_2 - t_1)}",
            "As (34); and braking begins where speeding up ends, from its own length t_n − t_2 instead of t_1.",
            _over_short(_braking_corrected),
        ),
    ),
    Claim(
        id="001:eq-36",
        place="equation (36)",
        said="The speed that is reached instead of v_max, from either phase; the true t_1,kurz is put in.",
        formula="v_max,kurz = a_0 (t_1,kurz − t_0) = a_n (t_1,kurz − t_0)",
        latex=r"v_{max,kurz} = a_0 \cdot (t_{1,kurz} - t_0) = a_n \cdot (t_{1,kurz} - t_0)",
        printed=eq_36,
        check=_over_short(_peaks),
        reference=_TRIANGLE,
        domain=_SHORT,
        unit="m/s",
        correction=Correction(
            eq_36_corrected,
            "v_max,kurz = a_0 (t_1,kurz − t_0) = −a_n (t_n,kurz − t_1,kurz)",
            r"v_{max,kurz} = a_0 \cdot (t_{1,kurz} - t_0) = -a_n \cdot (t_{n,kurz} - t_{1,kurz})",
            "The first expression holds; the second needs the length of the braking, and a_n is negative.",
            _over_short(_peaks_corrected),
        ),
    ),
    Claim(
        id="001:2.2-condition",
        place="section 2.2, text",
        said="The distance is too short for v_max exactly if (33) gives a negative time.",
        formula="(p_2 − p_1)/v_max < 0",
        latex=r"\frac{p_2 - p_1}{v_{max}} < 0",
        printed=cruise_is_negative,
        check=_condition,
        reference="whether the motion reaches v_max",
        domain="60 motions with a cruise, 60 too short for one, 1 nm to either side; the share told wrongly",
    ),
    Claim(
        id="001:2.2-short-distance",
        place="section 2.2, (34) to (36)",
        said="By (34) to (36) a short motion ends where it should, braking as hard as speeding up (task 2c).",
        formula="p_n = ½ v_max,kurz (t_1,kurz − t_0) + ½ v_max,kurz (t_n,kurz − t_2)",
        latex=r"p_n = \frac{1}{2} v_{max,kurz} (t_{1,kurz} - t_0) + \frac{1}{2} v_{max,kurz} (t_{n,kurz} - t_2)",
        printed=short_distance,
        check=_end,
        reference="the distance that was asked for",
        domain=_SHORT,
        unit="m",
        correction=Correction(
            short_distance_corrected,
            "the same by (34) to (36) as corrected",
            why="With a_n = −a_0 the wrong share in (34) and (35) does no harm; the missing square root does.",
            check=_end_corrected,
        ),
    ),
)

CLAIMS: Final = (*_LONG, *_SHORT_CLAIMS)
