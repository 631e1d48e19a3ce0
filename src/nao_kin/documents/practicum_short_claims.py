"""Practicum, section 2.2: what (34) to (36) are held against, and where a motion by them ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.documents import practicum_profile as printed
from nao_kin.documents.claim import Claim, Correction, Measured
from nao_kin.documents.profile_motion import motions, short_motions

if TYPE_CHECKING:
    from collections.abc import Callable

    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.profile_motion import Short

__all__ = ["CLAIMS"]

_COUNT, _SEED = 60, 1
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


CLAIMS: Final = (
    Claim(
        id="001:eq-34",
        place="equation (34), its number not legible",
        said="How long speeding up takes when the distance is too short for v_max.",
        formula="t_1,kurz − t_0 = t_1 + |a_0|/(|a_0| + |a_n|) (t_2 − t_1)",
        latex=r"t_{1,kurz} - t_0 = t_1 + \frac{|a_0|}{|a_0| + |a_n|} \cdot (t_2 - t_1)",
        printed=printed.eq_34,
        check=_over_short(_length_of(up=True)),
        reference=_TRIANGLE,
        domain=_SHORT,
        unit="s",
        correction=Correction(
            printed.eq_34_corrected,
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
        printed=printed.eq_35,
        check=_over_short(_length_of(up=False)),
        reference=_TRIANGLE,
        domain=_SHORT,
        unit="s",
        correction=Correction(
            printed.eq_35_corrected,
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
        printed=printed.eq_36,
        check=_over_short(_peaks),
        reference=_TRIANGLE,
        domain=_SHORT,
        unit="m/s",
        correction=Correction(
            printed.eq_36_corrected,
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
        printed=printed.cruise_is_negative,
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
        printed=printed.short_distance,
        check=_end,
        reference="the distance that was asked for",
        domain=_SHORT,
        unit="m",
        correction=Correction(
            printed.short_distance_corrected,
            "the same by (34) to (36) as corrected",
            why="With a_n = −a_0 the wrong share in (34) and (35) does no harm; the missing square root does.",
            check=_end_corrected,
        ),
    ),
)
