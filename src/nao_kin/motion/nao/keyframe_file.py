"""The TOML format of keyframes: named postures, and when each is taken.

docs/walking.md describes it. What is wrong in a file is refused with its line, before anything moves.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

import numpy as np

from nao_kin.arrays import positive, vector
from nao_kin.errors import InvalidInputError, KeyframeFileError, UnknownNameError, near_matches
from nao_kin.robot.known import robot_names
from nao_kin.robot.robot import Robot, load
from nao_kin.toml_file import TomlFile

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

__all__ = ["EXAMPLE", "Between", "Keyframe", "Keyframes", "TooFast", "parse_keyframes", "read_keyframes"]

EXAMPLE: Final = Path(__file__).with_name("wave.toml")
"""A NAO that waves its right hand."""

Between: TypeAlias = Literal["cubic", "stop"]
TooFast: TypeAlias = Literal["refuse", "slow"]

_TOP: Final = ("robot", "name", "angles", "lengths", "between", "too_fast", "sample_time", "posture", "keyframe")
_CHOICES: Final = {
    "angles": ("rad", "deg"),
    "lengths": ("m", "mm"),
    "between": ("cubic", "stop"),
    "too_fast": ("refuse", "slow"),
}
_MOST_KEYS: Final = 1000
_LONGEST: Final = 3600.0  # [s]
_CLOSEST: Final = 1e-3  # [s]
_ROUNDING: Final = 1e-9  # [rad, m] a value in degrees may round beyond the end of its range


@dataclass(frozen=True, slots=True)
class Keyframe:
    """A posture and when it is taken.

    Attributes:
        time: When [s], from the start of the motion.
        posture: Name of the posture.
    """

    time: float
    posture: str


@dataclass(frozen=True, eq=False, slots=True)
class Keyframes:
    """What a file of keyframes says, in radians and metres.

    Attributes:
        robot: The robot it is for.
        name: What a person calls it.
        postures: Name to joint values [rad or m]; a posture names what it moves, and the rest stays as it was.
        keys: The keyframes, in the order of time.
        between: ``"cubic"`` passes through the keyframes on one smooth curve; ``"stop"`` comes to rest at each.
        too_fast: What to do where a joint would be too fast: refuse, or take longer.
        sample_time: Time between samples [s].

    Raises:
        InvalidInputError: No keyframes, times that do not increase, or a choice that there is not.
        UnknownNameError: A keyframe takes a posture that there is not.
    """

    robot: Robot
    name: str
    postures: Mapping[str, Mapping[str, float]]
    keys: tuple[Keyframe, ...]
    between: Between = "cubic"
    too_fast: TooFast = "refuse"
    sample_time: float = 0.01

    def __post_init__(self) -> None:
        for name in ("between", "too_fast"):
            if getattr(self, name) not in _CHOICES[name]:
                raise InvalidInputError(name, " or ".join(_CHOICES[name]), _short(getattr(self, name)))
        positive(self.sample_time, "sample_time", "[s]")
        for key in self.keys:
            if key.posture not in self.postures:
                raise UnknownNameError("posture", key.posture, self.postures, self.name)
        times = vector([key.time for key in self.keys], "times of keyframes", len(self.keys))
        if not len(times) or times[0] < 0.0 or (np.diff(times) < _CLOSEST).any():
            raise InvalidInputError("keyframes", f"times ≥ 0, each {_CLOSEST:g} s or more after the last", str(times))


def read_keyframes(path: str | os.PathLike[str], robot: Robot | None = None) -> Keyframes:
    """A file of keyframes.

    Args:
        path: The file.
        robot: The robot to play it on, instead of the one that the file names.

    Raises:
        KeyframeFileError: Unreadable or malformed, or a posture that the robot cannot take; carries the line.
        MissingExtraError: The robot's files come with an optional extra.
    """
    return _Reader(TomlFile.read(path, KeyframeFileError, "file of keyframes"), robot).keyframes()


def parse_keyframes(text: str, robot: Robot | None = None, path: str = "<keyframes>") -> Keyframes:
    """The same from text.

    Raises:
        KeyframeFileError, MissingExtraError: See `read_keyframes`.
    """
    return _Reader(TomlFile.parse(text, path, KeyframeFileError, "file of keyframes"), robot).keyframes()


class _Reader:
    """Checks parsed TOML against the format and the robot."""

    def __init__(self, file: TomlFile, robot: Robot | None) -> None:
        self.file, self.data, self.error = file, file.data, file.error
        file.known_keys(self.data, _TOP, "", 0)
        for key, allowed in _CHOICES.items():
            if key in self.data and self.data[key] not in allowed:
                raise self.error("", 0, key, f"{key}: expected {' or '.join(allowed)}, got {_short(self.data[key])}.")
        if "angles" not in self.data:
            raise self.error("", 0, "", "angles is missing: 'rad' or 'deg'.")
        self.robot = self.named_robot() if robot is None else robot
        self.joints = self.robot.shown_joints

    def named_robot(self) -> Robot:
        name = self.data.get("robot")
        if name not in robot_names():  # never a path: a file from elsewhere must not choose what is opened here
            near = near_matches(str(name), robot_names())
            hint = f" Did you mean {near[0]!r}?" if near else ""
            reason = "robot is missing" if name is None else f"robot: {_short(name)} is no known robot"
            raise self.error("", 0, "robot", f"{reason}; expected a name as nao-kin robots lists them.{hint}")
        return load(name)

    def keyframes(self) -> Keyframes:
        data = self.data
        if not isinstance(name := data.get("name", ""), str):
            raise self.error("", 0, "name", f"name: expected text, got {_short(name)}.")
        sample_time = self.number(data.get("sample_time", 0.01), "", 0, "sample_time")
        if not 1e-4 <= sample_time <= 1.0:
            raise self.error("", 0, "sample_time", f"sample_time: expected 0.0001 to 1 s, got {sample_time:g}.")
        postures = self.postures(data.get("posture"))
        keys = self.keys(data.get("keyframe"), postures)
        options = {key: data[key] for key in ("between", "too_fast") if key in data}
        return Keyframes(self.robot, name, postures, keys, sample_time=sample_time, **options)

    def postures(self, found: object) -> dict[str, dict[str, float]]:
        if not isinstance(found, dict) or not found:
            raise self.error("", 0, "posture", "expected at least one table [posture.NAME] of joints and values.")
        return {name: self.posture(name, joints) for name, joints in found.items()}

    def posture(self, name: str, joints: object) -> dict[str, float]:
        section = f"posture.{name}"
        if not isinstance(joints, dict):
            raise self.error("posture", 1, name, f"{section}: expected joints and values, got {_short(joints)}.")
        values = {joint: self.value(section, joint, value) for joint, value in joints.items()}
        try:
            self.robot.expand(values)
        except InvalidInputError as contradiction:  # a follower that does not go with its leader
            raise self.error(section, 1, "", f"{section}: {contradiction}") from None
        return values

    def value(self, section: str, joint: str, given: object) -> float:
        if joint not in self.joints:
            unknown = UnknownNameError("moving joint", joint, self.joints, self.robot.name)
            raise self.error(section, 1, joint, f"{section}: {unknown}")
        value = self.number(given, section, 1, joint)
        if self.joints[joint].kind != "prismatic":
            value = math.radians(value) if self.data["angles"] == "deg" else value
        elif "lengths" not in self.data:
            raise self.error(
                section, 1, joint, f"{section}: {joint} slides, so the file must say lengths: 'm' or 'mm'."
            )
        else:
            value *= 1e-3 if self.data["lengths"] == "mm" else 1.0
        lower, upper = self.joints[joint].lower, self.joints[joint].upper
        if not lower - _ROUNDING <= value <= upper + _ROUNDING:
            reason = f"{joint} = {value:.6g} is outside [{lower:.6g}, {upper:.6g}] (rad, m)."
            raise self.error(section, 1, joint, f"{section}: {reason}")
        return value

    def keys(self, found: object, postures: Mapping[str, object]) -> tuple[Keyframe, ...]:
        if not isinstance(found, list) or not found:
            raise self.error("", 0, "keyframe", "expected at least one [[keyframe]] with a posture and a time.")
        if len(found) > _MOST_KEYS:
            raise self.error("keyframe", _MOST_KEYS + 1, "", f"expected at most {_MOST_KEYS} keyframes.")
        keys: list[Keyframe] = []
        for number, key in enumerate(found, start=1):
            keys.append(self.key(key, number, postures, keys))
        return tuple(keys)

    def key(self, key: object, number: int, postures: Mapping[str, object], before: Sequence[Keyframe]) -> Keyframe:
        if not isinstance(key, dict):
            raise self.error("keyframe", number, "", f"[[keyframe]] {number}: expected a table, got {_short(key)}.")
        self.file.known_keys(key, ("posture", "time"), "keyframe", number)
        if missing := [name for name in ("posture", "time") if name not in key]:
            raise self.error("keyframe", number, "", f"[[keyframe]] {number}: {' and '.join(missing)} missing.")
        if not isinstance(name := key["posture"], str) or name not in postures:
            unknown = UnknownNameError("posture", _short(name).strip("'\""), postures)
            raise self.error("keyframe", number, "posture", f"[[keyframe]] {number}: {unknown}")
        time = self.number(key["time"], "keyframe", number, "time")
        if not 0.0 <= time <= _LONGEST:
            raise self.error("keyframe", number, "time", f"time: expected 0 to {_LONGEST:g} s, got {time:g}.")
        if before and time < before[-1].time + _CLOSEST:
            reason = f"time: expected {_CLOSEST:g} s or more after {before[-1].time:g} s, the one before, got {time:g}."
            raise self.error("keyframe", number, "time", reason)
        return Keyframe(time, name)

    def number(self, value: object, section: str, number: int, key: str) -> float:
        fine = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300
        if not fine or not math.isfinite(float(value)):  # type: ignore[arg-type]
            raise self.error(section, number, key, f"{key}: expected a finite number, got {_short(value)}.")
        return float(value)  # type: ignore[arg-type]


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
