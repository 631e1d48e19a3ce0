"""Frames survive any cut, and whatever is not a command is refused by name."""

from __future__ import annotations

import struct

import numpy as np
import pytest
import umsgpack

from nao_kin.errors import FrameError, NaoKinError, UnknownNameError
from nao_kin.motion.loop.messages import MAX_FRAME, FrameReader, command, encode, target_of
from nao_kin.robot.motors import Motors
from tests.conftest import robot

MESSAGES = [
    {"position": {"HeadYaw": 0.25}, "cycle": 7},
    {"position": {"LHand": 1, "RHand": 0.5}},
    {"a": [1, "é", None]},
]


def framed(body):
    return struct.pack(">I", len(body)) + body


@pytest.mark.parametrize("size", [1, 2, 3, 5, 64, 1000])
def test_messages_come_whole_however_the_bytes_are_cut(size):
    data, reader = b"".join(map(encode, MESSAGES)), FrameReader()
    found = [message for i in range(0, len(data), size) for message in reader.feed(data[i : i + size])]
    assert found == MESSAGES
    assert reader.pending == 0


def test_a_truncated_message_is_never_a_message():
    data = encode(MESSAGES[0])
    for end in range(len(data)):
        reader = FrameReader()
        assert reader.feed(data[:end]) == []
        assert reader.pending == end


BAD_BODIES = {
    "no msgpack": b"\xc1",
    "cut off inside": umsgpack.packb(MESSAGES[0])[:-1],
    "bytes after the end": umsgpack.packb(MESSAGES[0]) + b"\x00",
    "a map is expected, not list": umsgpack.packb([1, 2]),
    "a map is expected, not int": b"\x01",
    "endless array": b"\xdd\xff\xff\xff\xff",
    "endless map": b"\xdf\xff\xff\xff\xff",
    "endless text": b"\xdb\xff\xff\xff\xff",
    "nested beyond all measure": b"\x91" * 60_000,
    "a map as key": b"\x81\x80\x01",
    "the same key twice": b"\x82\xa1a\x01\xa1a\x02",
    "text that is no UTF-8": b"\x81\xa1\xff\x01",
}


@pytest.mark.parametrize("body", BAD_BODIES.values(), ids=BAD_BODIES)
def test_a_body_that_is_no_map_is_refused_and_the_next_message_read(body):
    first, second = FrameReader().feed(framed(body) + encode(MESSAGES[0]))
    assert isinstance(first, FrameError)
    assert not first.fatal
    assert second == MESSAGES[0]


@pytest.mark.parametrize("length", [0, MAX_FRAME + 1, 2**32 - 1])
def test_a_length_beyond_the_limit_ends_the_stream_before_anything_is_stored(length):
    reader = FrameReader()
    (found,) = reader.feed(struct.pack(">I", length) + b"x" * 100)
    assert isinstance(found, FrameError)
    assert found.fatal
    assert reader.pending == 0


def test_random_bytes_are_refused_and_nothing_else_happens(rng):
    for _ in range(300):
        body = rng.bytes(int(rng.integers(1, 60)))
        for found in FrameReader().feed(framed(body)):
            assert isinstance(found, (dict, FrameError))


def test_what_is_too_large_is_not_sent():
    with pytest.raises(FrameError, match="allowed"):
        encode({"position": {f"joint_{i}": 0.0 for i in range(10_000)}})


BAD_COMMANDS = {
    "NaN": ({"position": {"HeadYaw": float("nan")}}, "HeadYaw = nan is not finite"),
    "infinite": ({"position": {"HeadYaw": float("-inf")}}, "HeadYaw = -inf is not finite"),
    "text": ({"position": {"HeadYaw": "0.1"}}, "HeadYaw has to be a number .* not str"),
    "truth": ({"position": {"HeadYaw": True}}, "HeadYaw has to be a number .* not bool"),
    "nothing": ({"position": {"HeadYaw": None}}, "HeadYaw has to be a number .* not NoneType"),
    "a list": ({"position": [0.1, 0.2]}, "'position' has to be a map"),
    "no joints": ({"position": {}}, "one joint at least"),
    "no position": ({"cycle": 1}, "'position' has to be a map"),
    "another key": ({"position": {"HeadYaw": 0.0}, "velocity": {}}, "no key 'velocity'; known: position, cycle"),
    "a cycle of text": ({"position": {"HeadYaw": 0.0}, "cycle": "1"}, "'cycle' has to be a whole number"),
    "a number as key": ({1: 2}, "no key 1"),
}


@pytest.mark.parametrize(("message", "reason"), BAD_COMMANDS.values(), ids=BAD_COMMANDS)
def test_a_command_that_is_not_one_is_refused_by_name(message, reason):
    motors = Motors.of(robot("nao"))
    last = np.zeros(len(motors.joints))
    with pytest.raises(FrameError, match=reason):
        target_of(message, motors, last)
    assert not last.any()


@pytest.mark.parametrize(
    ("joint", "near"), [("HeadYawn", "HeadYaw"), ("RHipYawPitch", "LHipYawPitch"), (3, "Known"), ("\x1b[2J", "Known")]
)
def test_a_joint_that_is_no_motor_is_refused_with_near_matches(joint, near):
    motors = Motors.of(robot("nao"))
    with pytest.raises(UnknownNameError) as caught:
        target_of({"position": {joint: 0.1}}, motors, np.zeros(len(motors.joints)))
    assert near in str(caught.value)
    assert str(caught.value).isprintable()
    assert isinstance(caught.value, NaoKinError)


def test_a_whole_number_beyond_floats_is_refused():
    motors = Motors.of(robot("nao"))
    with pytest.raises(FrameError, match="HeadYaw = inf is not finite"):
        target_of(command({"HeadYaw": 10**400}), motors, np.zeros(len(motors.joints)))


def test_a_command_changes_what_it_names_and_nothing_else():
    motors = Motors.of(robot("nao"))
    last = np.linspace(-0.1, 0.1, len(motors.joints))
    target = target_of(command({"LElbowRoll": -0.5, "HeadYaw": 1}), motors, last)
    expected = last.copy()
    expected[motors.index("LElbowRoll")], expected[motors.index("HeadYaw")] = -0.5, 1.0
    assert (target == expected).all()
