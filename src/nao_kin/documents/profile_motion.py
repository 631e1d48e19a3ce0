"""Motion along a line in three phases, from first principles: the truth that the practicum's section 2 is held against.

The acceleration is given, phase by phase; velocity and position are its integrals. No formula of the sheet is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.polynomial import Polynomial

if TYPE_CHECKING:
    from collections.abc import Iterator

Short: TypeAlias = "tuple[Motion, float, tuple[float, float, float]]"

__all__ = ["Motion", "Short", "motions", "short_motions"]


@dataclass(frozen=True, slots=True)
class Motion:
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
    ) -> Motion:
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


def motions(count: int, seed: int, t_0: float | None = None, p_0: float | None = None) -> Iterator[Motion]:
    """Motions with a cruise: rates and durations at random, unless given also the start in time [s] and place [m]."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        up, cruise, down = rng.uniform(0.2, 2.0, 3)
        peak, start, place = rng.uniform(0.1, 1.0), rng.uniform(0.5, 2.0), rng.uniform(-1.0, 1.0)
        accelerations = (peak / up, 0.0, -peak / down)
        start, place = start if t_0 is None else t_0, place if p_0 is None else p_0
        yield Motion.of(accelerations, (up, cruise, down), start, place)


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
        motion = Motion.of((a_0, 0.0, a_n), (peak / a_0, 0.0, peak / -a_n), 0.0, 0.0)
        needed = Motion.of((a_0, 0.0, a_n), (allowed / a_0, 0.0, allowed / -a_n), 0.0, 0.0).p[-1]
        t_1 = allowed / a_0
        t_2 = t_1 + (motion.p[-1] - needed) / allowed
        yield motion, allowed, (t_1, t_2, t_2 + allowed / -a_n)
