"""Where and when the feet of a walking hexapod go, and where its body is meanwhile: a plan, without any joints.

Time counts from the first lift-off; in the plane of the ground the body moves as a twist says that is constant but for
a smooth start and stop. A foot stands still on the ground, and a swing brings it to where it will be in its usual place
under the body half-way through its next stance, so the body pushes as far past a foot as it reached ahead of it. Both
are exact for turns too, since the poses are those of the twist's own arc and no straight pieces.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.loop.profile import minimum_jerk

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from nao_kin.arrays import Floats

__all__ = ["GAITS", "LEGS", "BodyCourse", "Gait", "Steps", "steps"]

_INSTANT: Final = 1e-9  # a share of a swing this small is none

LEGS: Final = ("lf", "lm", "lr", "rf", "rm", "rr")
"""Left and right, front, middle and rear."""


@dataclass(frozen=True, slots=True)
class Gait:
    """A rhythm of six legs.

    Attributes:
        name: What it is called.
        duty: The duty factor: the share of a cycle that each foot is on the ground.
        lift_off: When each leg lifts its foot, as a share of a cycle.
        down: How many feet are on the ground at any time, at least.
    """

    name: str
    duty: float
    lift_off: Mapping[str, float]
    down: int

    def __post_init__(self) -> None:
        if not 0.0 < self.duty < 1.0:
            raise InvalidInputError("duty factor", "a number between 0 and 1", repr(self.duty))
        for leg, phase in self.lift_off.items():
            if leg not in LEGS:
                raise UnknownNameError("leg", leg, LEGS, f"gait {self.name}")
            if not 0.0 <= phase < 1.0:
                raise InvalidInputError(f"lift-off of {leg}", "a share of a cycle, 0 ≤ share < 1", repr(phase))
        if absent := [leg for leg in LEGS if leg not in self.lift_off]:
            raise InvalidInputError("lift_off", "a share of a cycle for each leg", f"none for {', '.join(absent)}")


# Wilson 1966, Insect walking: on each side waves run from rear to front, and the two legs of a segment are half a cycle
# apart. The gaits differ in how much of the cycle a foot is on the ground, and so in how far the waves overlap.
_ROWS: Final = (
    #  name      duty   lf     lm     lr     rf     rm     rr   feet down
    ("tripod", 1 / 2, 0 / 2, 1 / 2, 0 / 2, 1 / 2, 0 / 2, 1 / 2, 3),
    ("ripple", 2 / 3, 4 / 6, 2 / 6, 0 / 6, 1 / 6, 5 / 6, 3 / 6, 4),
    ("wave", 5 / 6, 2 / 6, 1 / 6, 0 / 6, 5 / 6, 4 / 6, 3 / 6, 5),
)
GAITS: Final = {
    str(name): Gait(str(name), duty, dict(zip(LEGS, phases, strict=True)), down) for name, duty, *phases, down in _ROWS
}


@dataclass(frozen=True, slots=True)
class BodyCourse:
    """How the body moves over the ground, seen in the plane.

    Attributes:
        velocity: Forward and to the left, in the body's own axes (2,) [m/s].
        turn: Turn rate, counter-clockwise seen from above [rad/s].
        duration: From the first motion to the last [s].
        ramp: How long it takes to reach full speed, and to lose it again [s].
    """

    velocity: tuple[float, float]
    turn: float
    duration: float
    ramp: float

    def travelled(self, time: Floats) -> Floats:
        """For how long at full speed the body would have moved as far (N,) [s]."""
        t = np.clip(time, 0.0, self.duration)
        return t - self._lost(t) - (0.5 * self.ramp - self._lost(self.duration - t))

    def _lost(self, time: Floats) -> Floats:
        """What starting up costs by then [s]: the integral of 1 − (3u² − 2u³), u being time over ramp."""
        u = np.minimum(time / self.ramp, 1.0)
        return np.asarray(self.ramp * (u - u**3 + 0.5 * u**4))

    def poses(self, time: Floats) -> Floats:
        """Where the body is (N, 3): x, y [m] and heading [rad], from (0, 0, 0): the exponential of the twist."""
        s = self.travelled(time)
        angle = self.turn * s
        # sin a / a and (1 − cos a) / a, both without a division by zero
        ahead, aside = np.sinc(angle / np.pi), np.sin(0.5 * angle) * np.sinc(0.5 * angle / np.pi)
        (vx, vy), columns = self.velocity, [np.zeros_like(s), np.zeros_like(s), angle]
        columns[0], columns[1] = s * (vx * ahead - vy * aside), s * (vx * aside + vy * ahead)
        return np.stack(columns, axis=-1)

    def carried(self, time: Floats, place: Floats) -> Floats:
        """Where a point fixed to the body, (2,) in its axes, is on the ground (N, 2) [m]."""
        x, y, heading = self.poses(time).T
        c, s = np.cos(heading), np.sin(heading)
        return np.stack([x + c * place[0] - s * place[1], y + s * place[0] + c * place[1]], axis=-1)


@dataclass(frozen=True, eq=False, slots=True)
class Steps:
    """The steps of one foot.

    Attributes:
        lift: When they begin (k,) [s], ascending.
        land: When they end (k,) [s].
        places: Where the foot stands on the ground before, between and after them (k + 1, 2) [m].
    """

    lift: Floats
    land: Floats
    places: Floats

    def at(self, time: Floats, height: float) -> tuple[Floats, NDArray[np.bool_]]:
        """Where the foot is (N, 3) [m], and when it is on the ground (N,).

        A swing is a quintic along and a sextic up: it leaves and meets the ground at rest, without acceleration.
        """
        k = np.searchsorted(self.lift, time, side="right") - 1
        points = np.zeros((len(time), 3))
        points[:, :2] = self.places[0]
        begun = k >= 0
        step = k[begun]
        u = (time[begun] - self.lift[step]) / (self.land[step] - self.lift[step])
        # Where one foot lands as another one lifts, rounding must not have both in the air.
        u = np.where(u < _INSTANT, 0.0, np.where(u > 1.0 - _INSTANT, 1.0, u))
        start, end = self.places[step], self.places[step + 1]
        along = minimum_jerk(u)[:, None]
        # A foot that stands is at its place to the last bit: adding the whole difference would round.
        points[begun, :2] = np.where(u[:, None] < 1.0, start + along * (end - start), end)
        points[begun, 2] = height * (4.0 * u * (1.0 - u)) ** 3
        down = np.ones(len(time), dtype=bool)
        down[begun] = (u == 0.0) | (u == 1.0)
        return points, down


def steps(course: BodyCourse, gait: Gait, cycle: float, leg: str, home: Floats) -> Steps:
    """The steps of a leg: in the gait's rhythm while the body moves, and then until the foot is in its usual place.

    Args:
        course: How the body moves.
        gait: The rhythm.
        cycle: Time of a cycle [s].
        leg: Which one.
        home: The foot's usual place under the body, in its axes (2,) [m].
    """
    swing, stance = (1.0 - gait.duty) * cycle, gait.duty * cycle
    count = int(np.ceil(course.duration / cycle)) + 2
    lift = np.asarray((np.arange(count) + gait.lift_off[leg]) * cycle, dtype=np.float64)
    aims = course.carried(lift + swing + 0.5 * stance, home)
    places = np.vstack([course.carried(np.zeros(1), home), aims])
    # After the body has stopped all aims are the same place, and a foot that is there stays.
    goes = (lift < course.duration) | (np.linalg.norm(np.diff(places, axis=0), axis=1) > 0.0)
    return Steps(lift[goes], lift[goes] + swing, np.vstack([places[:1], aims[goes]]))
