"""What a hexapod is asked to do."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from nao_kin.arrays import positive, vector
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.motion.hexapod.footfall import GAITS, BodyCourse, Gait

__all__ = ["WalkCommand"]

_MOST_SAMPLES: Final = 200_000
_SWING: Final = 0.5  # [s]
_LEAST_SAMPLES: Final = 5  # a swing


@dataclass(frozen=True, slots=True)
class WalkCommand:
    """What a hexapod is to do: stand, walk, and stand again.

    Attributes:
        gait: A name in `nao_kin.motion.hexapod.footfall.GAITS`, or a rhythm of your own.
        velocity: Forward and to the left, in the body's axes (2,) [m/s].
        turn: Turn rate, counter-clockwise seen from above [rad/s].
        duration: How long the body moves [s]; smooth start and stop, of a cycle each at most, are part of it.
        body: Pose of the body against its usual one while it walks: x, y, z [m], roll, pitch, yaw [rad]. It is taken
            up before the first step and given up after the last, for a cycle each.
        step_height: How high a foot is lifted [m].
        cycle: Time in which every leg steps once [s]; by default as long as leaves half a second to a swing.
        spread: Distance of the feet from the coxa axes when it stands [m].
        height: Height of the body's frame above the ground when it stands [m].
        sample_time: Time between samples [s].
        margin: How far inside the polygon of its feet the centre of mass must stay [m].

    Raises:
        InvalidInputError: A number is of the wrong kind, size or sign.
        UnknownNameError: There is no such gait; carries near matches.
    """

    gait: str | Gait = "tripod"
    velocity: tuple[float, float] = (0.04, 0.0)
    turn: float = 0.0
    duration: float = 10.0
    body: tuple[float, float, float, float, float, float] = (0.0,) * 6
    step_height: float = 0.03
    cycle: float | None = None
    spread: float = 0.141
    height: float = 0.09
    sample_time: float = 0.01
    margin: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.gait, Gait) and str(self.gait) not in GAITS:
            raise UnknownNameError("gait", self.gait, GAITS)
        if self.cycle is not None:
            object.__setattr__(self, "cycle", positive(self.cycle, "cycle", "[s]"))
        units = {"duration": "[s]", "step_height": "[m]", "spread": "[m]", "height": "[m]", "sample_time": "[s]"}
        for name, unit in units.items():
            object.__setattr__(self, name, positive(getattr(self, name), name, unit))
        vx, vy = vector(self.velocity, "velocity", 2).tolist()
        x, y, z, roll, pitch, yaw = vector(self.body, "body", 6).tolist()
        turn, margin = vector([self.turn, self.margin], "turn and margin", 2).tolist()
        values = {"velocity": (vx, vy), "body": (x, y, z, roll, pitch, yaw), "turn": turn, "margin": margin}
        for name, value in values.items():
            object.__setattr__(self, name, value)
        swing = (1.0 - self.rhythm.duty) * self.period
        if swing < _LEAST_SAMPLES * self.sample_time:
            expected = f"at most a {_LEAST_SAMPLES}th of a swing, which takes {swing:g} s"
            raise InvalidInputError("sample_time", expected, f"{self.sample_time:g} s")
        if self.duration + 4.0 * self.period > _MOST_SAMPLES * self.sample_time:
            raise InvalidInputError("duration", f"at most {_MOST_SAMPLES} samples", f"{self.duration:g} s")

    @property
    def rhythm(self) -> Gait:
        """The gait itself."""
        return self.gait if isinstance(self.gait, Gait) else GAITS[self.gait]

    @property
    def period(self) -> float:
        """Time of a cycle [s], as asked for or by default."""
        return _SWING / (1.0 - self.rhythm.duty) if self.cycle is None else self.cycle

    @property
    def course(self) -> BodyCourse:
        """How the body moves over the ground."""
        return BodyCourse(self.velocity, self.turn, self.duration, min(self.period, 0.5 * self.duration))

    def at_speed(self, share: float) -> WalkCommand:
        """The same at a multiple of the speed, straight on and turning."""
        vx, vy = self.velocity
        return replace(self, velocity=(share * vx, share * vy), turn=share * self.turn)
