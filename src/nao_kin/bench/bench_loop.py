"""`nao-kin bench loop`: NAO's 83 Hz cycle over a loopback socket, with deadlines met and missed."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Final

import typer

from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat

if TYPE_CHECKING:
    from nao_kin.motion.loop.stream import StreamLoop, StreamStatistics
    from nao_kin.motion.loop.transports import Address

__all__ = ["loop"]

_SWING: Final = 0.3  # [rad] either way, of both shoulders
_SWINGS_A_SECOND: Final = 0.5
_LAG: Final = 12.0  # [1/s] the simulated servo's gain
_IN_TIME: Final = 95.0  # [%]


def loop(
    seconds: Annotated[float, typer.Option(min=0.1, help="How long the peer commands.")] = 4.0,
    stall: Annotated[float, typer.Option(min=0.05, help="How long it says nothing afterwards.")] = 0.6,
    unix: Annotated[bool, typer.Option("--unix", help="A Unix socket instead of TCP.")] = False,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Run the 83 Hz loop of a simulated NAO with a peer on a loopback socket; the peer then falls silent."""
    import tempfile

    from nao_kin.motion.loop.transports import SocketServer

    machine = Machine()
    with tempfile.TemporaryDirectory(prefix="nao_kin_") as folder:
        address: Address = f"{folder}/robot" if unix else ("127.0.0.1", 0)
        with SocketServer(address) as server:
            stream = _nao_loop(server)
            commanding, silent, moved = _run(stream, server.address, seconds, stall)
    rows = [_row("peer commands", commanding), _row("peer is silent", silent)]
    share = 100.0 * commanding.met / max(1, commanding.met + commanding.missed)
    bounds = [
        Promise("commands in time while the peer commands, %", share, _IN_TIME),
        Promise("messages refused", float(commanding.refused + silent.refused), 0.0, at_least=False),
        Promise("cycles in silence not counted as missed", float(silent.met), 0.0, at_least=False),
        Promise("motion at the end of the silence, rad/s", moved, 0.0, at_least=False),
    ]
    title = f"12 ms cycles over a {'Unix' if unix else 'TCP'} socket on this machine"
    conclude(machine, [Sheet("rows", title, _HEADINGS, rows)], bounds, _NOTES, format, goals)


_HEADINGS = (
    Heading("phase", "phase"),
    Heading("cycles", "cycles", "d"),
    Heading("met", "met", "d"),
    Heading("missed", "missed", "d"),
    Heading("skipped", "skipped", "d"),
    Heading("lateness", "worst lateness [ms]", ".2f"),
)
_NOTES = (
    "met, missed: cycles at whose start a new command was there, and those that held the last target instead; skipped: "
    "cycles that the loop itself was too late for; worst lateness: of a cycle's start.",
)


def _nao_loop(server: Any) -> StreamLoop:
    from nao_kin.collision import CollisionModel
    from nao_kin.motion.loop.guard import Guard
    from nao_kin.motion.loop.plants import VelocityServos
    from nao_kin.motion.loop.servo import Gains
    from nao_kin.motion.loop.stream import SimulatedDrive, StreamLoop
    from nao_kin.robot.robot import load

    robot = load("nao")
    collisions = CollisionModel(robot, margin=0.01)
    guard = Guard(collisions, collisions.motors.q_of(robot.neutral))
    plant = VelocityServos(collisions.motors)
    return StreamLoop(guard, server, SimulatedDrive(plant, Gains(_LAG, feed_forward=True), guard.q, guard.period))


def _run(
    stream: StreamLoop, address: Address, seconds: float, stall: float
) -> tuple[StreamStatistics, StreamStatistics, float]:
    """Counts while the peer commands and while it is silent, and the greatest commanded speed left at the end."""
    stop = threading.Event()
    peer = threading.Thread(target=_command, args=(address, stream.guard.motors.joint_names, stop), daemon=True)
    peer.start()
    while not stream.statistics.met:  # until the peer has found the socket
        stream.cycle()
    before = replace(stream.statistics)
    stream.statistics.worst_lateness = 0.0
    stream.run(round(seconds / stream.guard.period))
    commanding = _since(before, stream.statistics)
    stop.set()
    peer.join()
    stream.cycle()  # takes what the peer sent last
    before = replace(stream.statistics)
    stream.statistics.worst_lateness = 0.0
    stream.run(round(stall / stream.guard.period))
    return commanding, _since(before, stream.statistics), float(abs(stream.guard.velocity).max())


def _command(address: Address, joints: tuple[str, ...], stop: threading.Event) -> None:
    """A peer that answers every measurement with the next posture of a swing of both arms."""
    import math

    from nao_kin.motion.loop.messages import command
    from nao_kin.motion.loop.transports import SocketClient

    swung = [name for name in joints if name.endswith("ShoulderPitch")]
    with SocketClient(address) as client:
        middle: dict[str, float] | None = None
        while not stop.is_set():
            try:
                message = client.receive()
            except TimeoutError:  # the loop has ended between the last message and `stop`, or is that late
                continue
            if middle is None:
                middle = {name: message["position"][name] for name in swung}
            angle = _SWING * math.sin(2.0 * math.pi * _SWINGS_A_SECOND * message["time"])
            client.send(command({name: value + angle for name, value in middle.items()}, message["cycle"]))
        stop.wait(0.01)


def _since(before: StreamStatistics, now: StreamStatistics) -> StreamStatistics:
    counts = {name: getattr(now, name) - getattr(before, name) for name in ("cycles", "met", "missed", "refused")}
    return replace(now, **counts, skipped=now.skipped - before.skipped)


def _row(phase: str, counts: StreamStatistics) -> dict[str, Any]:
    return {
        "phase": phase,
        "cycles": counts.cycles,
        "met": counts.met,
        "missed": counts.missed,
        "skipped": counts.skipped,
        "refused": counts.refused,
        "passed_over": counts.passed_over,
        "lateness": 1e3 * counts.worst_lateness,
    }
