"""The loop on a clock of its own: deadlines, the last safe target, refusals; and over real sockets on this machine."""

from __future__ import annotations

import contextlib
import socket
import stat
import struct

import numpy as np
import pytest

from nao_kin.collision import CollisionModel, Plane
from nao_kin.errors import InvalidInputError
from nao_kin.motion.loop.guard import Guard
from nao_kin.motion.loop.messages import MAX_FRAME, command, encode
from nao_kin.motion.loop.plants import VelocityServos
from nao_kin.motion.loop.servo import Gains
from nao_kin.motion.loop.stream import SimulatedDrive, StreamLoop
from nao_kin.motion.loop.transports import InProcess, SocketClient, SocketServer
from tests.conftest import robot

START = (0.3, 3.0, 2.0, 0.5, -0.5, 0.2)


class FakeClock:
    """Time passes only by sleeping, and by being told to."""

    def __init__(self):
        self.time = 100.0

    def now(self):
        return self.time

    def sleep_until(self, instant):
        self.time = max(self.time, instant)


def jaco2_guard():
    return Guard(CollisionModel(robot("jaco2"), margin=0.01, planes=[Plane("table")]), START)


def loop(transport=None, drive=False):
    guard, clock = jaco2_guard(), FakeClock()
    transport = InProcess() if transport is None else transport
    plant = VelocityServos(guard.motors)
    driven = SimulatedDrive(plant, Gains(12.0, feed_forward=True), guard.q, guard.period) if drive else None
    return StreamLoop(guard, transport, driven, clock), transport, clock


def test_the_newest_valid_command_counts_and_others_are_counted():
    stream, peer, _ = loop()
    for angle in (0.31, 0.32, 0.33):
        peer.peer_send(command({"joint_1": angle}))
    cycle = stream.cycle()
    assert cycle.state == "following"
    assert cycle.target == pytest.approx([0.33, *START[1:]], abs=0.0)
    assert (stream.statistics.met, stream.statistics.passed_over) == (1, 2)


def test_a_refused_command_does_not_replace_the_valid_one_before_it():
    stream, peer, _ = loop()
    peer.peer_send(command({"joint_1": 0.31}))
    peer.peer_send(command({"joint_1": float("nan")}))
    cycle = stream.cycle()
    assert cycle.state == "following"
    assert cycle.target[0] == 0.31
    assert (stream.statistics.met, stream.statistics.refused, stream.statistics.passed_over) == (1, 1, 0)


def test_deadlines_are_counted_from_the_first_command_on():
    stream, peer, _ = loop()
    assert {stream.cycle().state for _ in range(5)} == {"waiting"}
    assert (stream.statistics.met, stream.statistics.missed) == (0, 0)
    for _ in range(3):
        peer.peer_send(command({"joint_1": 0.31}))
        stream.cycle()
        stream.cycle()
    assert (stream.statistics.met, stream.statistics.missed, stream.statistics.cycles) == (3, 3, 11)


def test_when_the_peer_stalls_misses_are_counted_and_the_last_safe_target_is_held():
    stream, peer, _ = loop(drive=True)
    angles = 0.3 + 0.2 * np.sin(np.linspace(0.0, 1.2, 80))
    for angle in angles:
        peer.peer_send(command({"joint_1": float(angle)}))
        stream.cycle()
    assert stream.guard.velocity.any()  # it stalls in full motion
    stalled = [stream.cycle() for _ in range(150)]
    assert (stream.statistics.met, stream.statistics.missed) == (80, 150)
    assert {cycle.state for cycle in stalled} == {"holding"}
    held = np.array([angles[-1], *START[1:]])
    assert all((cycle.target == held).all() for cycle in stalled)
    assert stalled[-1].q == pytest.approx(held, abs=1e-12)
    assert stalled[-1].measured == pytest.approx(held, abs=1e-6)
    assert max(cycle.q[0] for cycle in stalled) <= held[0] + 1e-12  # it does not run on beyond it


def test_a_target_in_the_table_is_not_safe_and_is_stopped_before_while_the_peer_is_silent():
    stream, peer, _ = loop()
    into_table = list(START)
    into_table[1] = 5.2
    peer.peer_send(command({"joint_2": 5.2}))
    cycles = [stream.cycle() for _ in range(600)]
    assert cycles[-1].state == "blocked"
    assert "table" in cycles[-1].blocked_by
    assert not stream.guard.velocity.any()
    collisions = stream.guard.clearance.collisions
    assert min(collisions.measure(cycle.q).min() for cycle in cycles) >= 0.005
    assert collisions.measure(np.array(into_table)).min() < 0.0
    peer.peer_send(command({"joint_2": 3.0}))  # the way back is free
    assert [stream.cycle() for _ in range(600)][-1].q == pytest.approx(START, abs=1e-12)


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (command({"joint_7": 0.1}), "joint_7"),
        (command({"joint_2": 0.5}), "joint_2 = 0.5 is outside"),
        (command({"joint_2": 1e308}), "joint_2"),
        (command({"joint_2": float("inf")}), "joint_2 = inf"),
        ({"position": {"joint_1": 0.1}, "torque": {}}, "'torque'"),
        ({}, "'position'"),
    ],
)
def test_bad_commands_are_refused_said_and_change_nothing(message, reason):
    stream, peer, _ = loop()
    peer.peer_send(message)
    cycle = stream.cycle()
    assert (cycle.target == START).all()
    assert not stream.guard.velocity.any()
    assert (stream.statistics.refused, stream.statistics.met) == (1, 0)
    (said,) = peer.peer_receive()
    assert reason in said["last_refusal"]
    assert said["refused"] == 1


def test_a_loop_that_comes_late_skips_cycles_and_never_catches_up():
    stream, peer, clock = loop()
    for k in range(20):
        peer.peer_send(command({"joint_1": 1.5}))
        before = stream.guard.q.copy()
        if k == 10:
            clock.time += 3.5 * stream.guard.period
        cycle = stream.cycle()
        step = np.abs(cycle.q - before)
        assert (step <= stream.guard.max_velocity * stream.guard.period * (1 + 1e-9)).all()
    statistics = stream.statistics
    assert (statistics.cycles, statistics.skipped, statistics.met, statistics.missed) == (20, 2, 20, 0)
    assert statistics.worst_lateness == pytest.approx(2.5 * stream.guard.period)
    assert cycle.number == 21
    stream.cycle()
    assert clock.time == pytest.approx(100.0 + 22 * stream.guard.period)  # on the old grid again


def test_measurements_tell_the_peer_where_the_robot_is():
    stream, peer, _ = loop(drive=True)
    peer.peer_send(command({"joint_1": 0.5}))
    for _ in range(30):
        cycle = stream.cycle()
    said = peer.peer_receive()
    assert [message["cycle"] for message in said] == list(range(30))
    assert said[-1]["time"] == pytest.approx(29 * 0.012)
    assert tuple(said[-1]["position"]) == stream.guard.motors.joint_names
    assert list(said[-1]["position"].values()) == cycle.measured.tolist()
    assert encode(said[-1])


@pytest.fixture(params=["unix", "tcp"])
def server(request, tmp_path):
    with SocketServer(tmp_path / "robot" if request.param == "unix" else ("localhost", 0)) as made:
        yield made


def received(server, messages=0, refused=0):
    """What has come once as much has come as is expected."""
    found, faults = [], []
    for _ in range(200_000):
        new = server.receive()
        found += new.messages
        faults += new.refused
        if len(found) >= messages and len(faults) >= refused and (messages or refused or server.connected):
            return found, faults
    raise AssertionError((found, faults))


def test_commands_and_measurements_go_over_a_socket(server):
    stream, _, _ = loop(server)
    with SocketClient(server.address) as client:
        received(server)
        for k in range(20):
            client.send(command({"joint_1": 0.3 + 0.001 * k}, k))
            while stream.statistics.met <= k:
                stream.cycle()
        message = client.receive()
        while message["cycle"] < stream.statistics.cycles - 1:
            message = client.receive()
        assert message["state"] == "following"
        assert stream.target[0] == 0.3 + 0.001 * 19
        assert stream.statistics.refused == 0


def test_a_peer_that_leaves_may_come_again(server):
    stream, _, _ = loop(server)
    for angle in (0.31, 0.32):
        with SocketClient(server.address) as client:
            client.send(command({"joint_1": angle}))
            while stream.target[0] != angle:
                stream.cycle()
        while server.connected:
            stream.cycle()
    assert stream.statistics.met == 2
    assert stream.cycle().state == "holding"


def test_a_peer_that_leaves_within_a_message_is_told_of(server):
    client = SocketClient(server.address)
    client._socket.sendall(encode(command({"joint_1": 0.31}))[:-3])
    received(server)
    client.close()
    _, (reason,) = received(server, refused=1)
    assert "left within a message" in reason
    with SocketClient(server.address) as another:
        another.send(command({"joint_1": 0.32}))
        assert received(server, messages=1)[0] == [command({"joint_1": 0.32})]


def test_a_frame_too_large_ends_the_connection_and_the_next_peer_is_welcome(server):
    with SocketClient(server.address) as client:
        client.send(command({"joint_1": 0.31}))
        client._socket.sendall(struct.pack(">I", MAX_FRAME + 1))
        messages, (reason,) = received(server, messages=1, refused=1)
    assert messages == [command({"joint_1": 0.31})]
    assert "a length of 65537 bytes" in reason
    assert not server.connected
    with SocketClient(server.address) as another:
        another.send(command({"joint_1": 0.32}))
        assert received(server, messages=1)[0] == [command({"joint_1": 0.32})]


def test_garbage_in_a_frame_is_refused_and_the_connection_stays(server):
    with SocketClient(server.address) as client:
        client._socket.sendall(struct.pack(">I", 3) + b"\xc1\xc1\xc1" + encode(command({"joint_1": 0.31})))
        messages, (reason,) = received(server, messages=1, refused=1)
    assert messages == [command({"joint_1": 0.31})]
    assert "no msgpack" in reason


def test_a_peer_that_floods_is_read_a_part_at_a_time_and_nothing_is_lost(server):
    frame = encode(command({"nobody": 0.0}))
    with SocketClient(server.address) as client:
        client._socket.sendall(300 * frame)
        counts = [len(server.receive().messages) for _ in range(20)]
    assert sum(counts) == 300
    assert max(counts) <= 64 + 1024 // len(frame) + 1


def test_a_second_peer_is_turned_away(server):
    with SocketClient(server.address) as first, SocketClient(server.address) as second:
        received(server)
        for _ in range(1000):
            server.receive()
        with pytest.raises((ConnectionError, TimeoutError)):
            second.receive()
        first.send(command({"joint_1": 0.31}))
        assert received(server, messages=1)[0]


def test_a_peer_that_does_not_read_does_not_stop_the_loop(server):
    with SocketClient(server.address) as client:
        received(server)
        for number in range(5000):
            server.send({"cycle": number, "filling": "x" * 4000})
        seen = []
        with contextlib.suppress(TimeoutError):
            while True:
                server.send({"cycle": -1})
                seen.append(client.receive()["cycle"])
                if seen[-1] == -1:
                    break
    assert seen[-1] == -1
    assert seen[:-1] == sorted(set(seen[:-1]))  # whole messages, in order, some of them lost
    assert len(seen) < 5000


def test_only_this_machine_is_listened_to():
    for host in ("0.0.0.0", "192.0.2.1", "example.org", ""):  # noqa: S104 - to be refused
        with pytest.raises(InvalidInputError, match="this machine"):
            SocketServer((host, 0))


def test_a_unix_socket_is_the_owners_and_goes_when_it_is_closed(tmp_path):
    path = tmp_path / "robot"
    with SocketServer(path):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        with pytest.raises(OSError, match="use"):
            SocketServer(path)
    assert not path.exists()
    with pytest.raises(OSError, match="No such file"):
        SocketClient(path)


def test_closing_twice_leaves_the_socket_of_the_next_server(tmp_path):
    path = tmp_path / "robot"
    first = SocketServer(path)
    first.close()
    with SocketServer(path):
        first.close()
        assert path.is_socket()


def test_a_client_says_when_the_robot_is_gone(server):
    client = SocketClient(server.address, timeout=0.05)
    received(server)
    with pytest.raises(TimeoutError):
        client.receive()
    server.close()
    with pytest.raises(ConnectionError):
        client.receive()
    client.close()
    assert isinstance(client._socket, socket.socket)
