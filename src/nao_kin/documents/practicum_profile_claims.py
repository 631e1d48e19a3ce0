"""Practicum, section 2.1: what (17) to (33) are held against, and how."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.documents import practicum_profile as printed
from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.profile_motion import Motion, motions

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.documents.claim import Check, Form

__all__ = ["CLAIMS"]

_COUNT, _SEED = 60, 1
_PHASES: Final = "integrals of an acceleration that is constant in each phase"
_ANY: Final = "60 motions with a cruise, starting at any time and place, at a random time of the phase"

_CLOCK: Final = "the clock starts with the motion, t_0 = 0"
_LINE: Final = "p_1 is the end point and t counts from the start t_0"
_ORIGIN: Final = "clock and position start with the motion, t_0 = 0 and p_0 = 0"


def _over(
    apart: Callable[[Form, Motion, float], float],
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

    def apart(form: Form, m: Motion, t: float) -> float:
        share = (t - m.t[0]) / (m.t[3] - m.t[0])
        on_line = (1.0 - share) * m.p[0] + share * m.p[3]
        return float(form(t - m.t[0] if from_start else t, m.p[0], m.p[end], m.t[0], m.t[3])) - on_line

    return _over(apart)


def _place(m: Motion) -> Callable[[float], float]:
    return lambda t: m.at(t)[0]


def _speed(m: Motion) -> Callable[[float], float]:
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
        printed.eq_17,
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
        printed.eq_18,
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
        printed.eq_19,
        _over(lambda form, m, t: form(m.a_0) - m.at(t)[2], phase=0),
        "m/s²",
    ),
    _claim(
        "20",
        "The speed in the first phase.",
        "v_0(t) = a_0 t",
        r"v_0(t) = a_0 t",
        printed.eq_20,
        _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[1], phase=0),
        "m/s",
        conventions={_CLOCK: _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[1], phase=0, t_0=0.0)},
    ),
    _claim(
        "21",
        "The position in the first phase.",
        "p_0(t) = ½ a_0 t²",
        r"p_0(t) = \frac{1}{2} a_0 t^2",
        printed.eq_21,
        _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[0], phase=0),
        "m",
        conventions={_ORIGIN: _over(lambda form, m, t: form(m.a_0, t) - m.at(t)[0], phase=0, t_0=0.0, p_0=0.0)},
    ),
    _claim(
        "28",
        "How long the first phase takes.",
        "t_1 − t_0 = v_max/a_0",
        r"t_1 - t_0 = \frac{v_{max}}{a_0}",
        printed.eq_28,
        _over(lambda form, m, _: form(m.peak, m.a_0) - (m.t[1] - m.t[0])),
        "s",
    ),
    _claim(
        "29",
        "How far the first phase goes.",
        "p_1 − p_0 = ½ a_2 t_1²",
        r"p_1 - p_0 = \frac{1}{2} a_2 t_1^2",
        printed.eq_29,
        _over(lambda form, m, _: form(m.a_n, m.t[1]) - (m.p[1] - m.p[0])),
        "m",
        correction=Correction(
            printed.eq_29_corrected,
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
        printed.eq_22,
        _over(lambda form, m, t: form() - m.at(t)[2], phase=1),
        "m/s²",
    ),
    _claim(
        "23",
        "The speed of the second phase is that at the end of the first, the largest one.",
        "v_1(t) = v_0(t_1) = v_max",
        r"v_1(t) = v_0(t_1) = v_{max}",
        printed.eq_23,
        _over(lambda form, m, t: _two((form(_speed(m), m.t[1]), m.peak), m.at(t)[1]), phase=1),
        "m/s",
    ),
    _claim(
        "24",
        "The position in the second phase.",
        "p_1(t) = p_0(t_1) + v_0(t_1) (t − t_1)",
        r"p_1(t) = p_0(t_1) + v_0(t_1) \cdot (t - t_1)",
        printed.eq_24,
        _over(lambda form, m, t: form(_place(m), _speed(m), t, m.t[1]) - m.at(t)[0], phase=1),
        "m",
    ),
    _claim(
        "32",
        "How far the second phase goes, from its speed and from what the others leave.",
        "p_2 − p_1 = v_max (t_2 − t_1) = (p_n − p_0) − (p_1 − p_0) − (p_n − p_2)",
        r"p_2 - p_1 = v_{max} \cdot (t_2 - t_1) = (p_n - p_0) - (p_1 - p_0) - (p_n - p_2)",
        printed.eq_32,
        _over(lambda form, m, _: _two(form(*m.p, m.peak, m.t[1], m.t[2]), m.p[2] - m.p[1])),
        "m",
    ),
    _claim(
        "33",
        "How long the second phase takes.",
        "t_2 − t_1 = (p_2 − p_1)/v_max",
        r"t_2 - t_1 = \frac{p_2 - p_1}{v_{max}}",
        printed.eq_33,
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
        printed.eq_25,
        _over(lambda form, m, t: form(m.a_n) - m.at(t)[2], phase=2),
        "m/s²",
    ),
    _claim(
        "26",
        "The speed in the last phase; a_n is negative.",
        "v_n(t) = v_1(t_2) + a_n (t − t_2)",
        r"v_n(t) = v_1(t_2) + a_n (t - t_2)",
        printed.eq_26,
        _over(lambda form, m, t: form(_speed(m), m.a_n, t, m.t[2]) - m.at(t)[1], phase=2),
        "m/s",
    ),
    _claim(
        "27",
        "The position in the last phase, whose acceleration is called a_2 here.",
        "p_n(t) = p_1(t_2) + v_1(t_2) (t − t_2) + ½ a_2 (t − t_2)²",
        r"p_n(t) = p_1(t_2) + v_1(t_2) \cdot (t - t_2) + \frac{1}{2} a_2 (t - t_2)^2",
        printed.eq_27,
        _over(lambda form, m, t: form(_place(m), _speed(m), m.a_n, t, m.t[2]) - m.at(t)[0], phase=2),
        "m",
    ),
    _claim(
        "30",
        "How long the last phase takes; a_2 is negative.",
        "t_n − t_2 = −v_max/a_2",
        r"t_n - t_2 = \frac{-v_{max}}{a_2}",
        printed.eq_30,
        _over(lambda form, m, _: form(m.peak, m.a_n) - (m.t[3] - m.t[2])),
        "s",
    ),
    _claim(
        "31",
        "How far the last phase goes; a_2 is negative.",
        "p_n − p_2 = −½ a_2 (t_n − t_2)²",
        r"p_n - p_2 = -\frac{1}{2} a_2 (t_n - t_2)^2",
        printed.eq_31,
        _over(lambda form, m, _: form(m.a_n, m.t[3], m.t[2]) - (m.p[3] - m.p[2])),
        "m",
    ),
)

CLAIMS: Final = tuple(sorted((*_LINES, *_SPEEDING_UP, *_CRUISE, *_BRAKING), key=lambda claim: claim.id))
