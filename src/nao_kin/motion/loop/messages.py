"""The streaming protocol's messages: msgpack maps with their length in front, and what a command may say.

A frame is the length of its body in four bytes, most significant first, and the body, one msgpack map. Whatever comes
from a peer is refused rather than guessed: nothing is clamped, converted or completed without a word.
"""

from __future__ import annotations

import io
import math
import struct
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import umsgpack

from nao_kin.errors import FrameError, UnknownNameError

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.robot.motors import Motors

__all__ = ["MAX_FRAME", "FrameReader", "Message", "command", "encode", "target_of"]

Message: TypeAlias = dict[str, Any]

MAX_FRAME: Final = 65_536
"""Most bytes a frame's body may have; a command of all motors of a NAO has about 600."""

_LENGTH: Final = struct.Struct(">I")
_COMMAND_KEYS: Final = ("position", "cycle")


def encode(message: Message) -> bytes:
    """A message as a frame.

    Raises:
        FrameError: It is larger than `MAX_FRAME`.
    """
    body: bytes = umsgpack.packb(message)
    if len(body) > MAX_FRAME:
        raise FrameError(f"{len(body)} bytes, where {MAX_FRAME} are allowed")
    return _LENGTH.pack(len(body)) + body


class FrameReader:
    """Puts messages together from bytes as they come."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    @property
    def pending(self) -> int:
        """Bytes of a message that is not complete yet."""
        return len(self._buffer)

    def feed(self, data: bytes) -> list[Message | FrameError]:
        """The messages that are complete now, in their order; those that cannot be read as errors.

        After a fatal error nothing can be read any more.
        """
        self._buffer += data
        found: list[Message | FrameError] = []
        while len(self._buffer) >= _LENGTH.size:
            (length,) = _LENGTH.unpack_from(self._buffer)
            if not 0 < length <= MAX_FRAME:
                self._buffer.clear()
                found.append(FrameError(f"a length of {length} bytes, where 1 to {MAX_FRAME} are allowed", fatal=True))
                break
            end = _LENGTH.size + length
            if len(self._buffer) < end:
                break
            body = bytes(self._buffer[_LENGTH.size : end])
            del self._buffer[:end]
            try:
                found.append(_decode(body))
            except FrameError as error:
                found.append(error)
        return found


def _decode(body: bytes) -> Message:
    stream = io.BytesIO(body)
    try:
        message = umsgpack.unpack(stream)
    except (umsgpack.UnpackException, ArithmeticError, RecursionError, TypeError, ValueError) as error:
        raise FrameError(f"no msgpack ({type(error).__name__})") from None
    if stream.tell() != len(body):
        raise FrameError(f"{len(body) - stream.tell()} bytes after the end of the map")
    if not isinstance(message, dict):
        raise FrameError(f"a map is expected, not {type(message).__name__}")
    return message


def command(position: dict[str, float], cycle: int | None = None) -> Message:
    """The message that commands motors to positions [rad or m]; the others keep their targets."""
    return {"position": position} if cycle is None else {"position": position, "cycle": cycle}


def target_of(message: Message, motors: Motors, last: Floats) -> Floats:
    """What a command asks for: motor values (n,), those that it does not name as they were.

    Limits are not looked at here; the guard does.

    Args:
        message: A message from the peer.
        motors: The robot's motors.
        last: The target before (n,).

    Raises:
        FrameError: A key that is not known, no positions, or a value that is not a finite number, by name.
        UnknownNameError: A joint that is no motor; carries near matches.
    """
    for key in message:
        if key not in _COMMAND_KEYS:
            raise FrameError(f"there is no key {_shown(key)}; known: {', '.join(_COMMAND_KEYS)}")
    position, cycle = message.get("position"), message.get("cycle", 0)
    if not isinstance(position, dict) or not position:
        raise FrameError("'position' has to be a map of joints to values, with one joint at least")
    if isinstance(cycle, bool) or not isinstance(cycle, int):
        raise FrameError("'cycle' has to be a whole number")
    target, names = last.copy(), motors.joint_names
    for name, value in position.items():
        if name not in names:
            raise UnknownNameError("motor", _shown(name).strip("'"), names, motors.robot.name)
        target[names.index(name)] = _number(value, name)
    return target


def _number(value: object, joint: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise FrameError(f"{joint} has to be a number [rad or m], not {type(value).__name__}")
    try:
        number = float(value)
    except OverflowError:  # not by msgpack, which has no whole number that large
        number = math.inf
    if not math.isfinite(number):
        raise FrameError(f"{joint} = {number} is not finite")
    return number


def _shown(key: object) -> str:
    """A key from a peer, short and printable."""
    return ascii(key)[:60]
