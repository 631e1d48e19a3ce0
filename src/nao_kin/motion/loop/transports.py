"""How messages come and go: within the process, or over a local socket. Nothing here ever waits for a peer."""

from __future__ import annotations

import contextlib
import ipaddress
import os
import socket
import time
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final, Protocol, Self, TypeAlias

from nao_kin.errors import FrameError, InvalidInputError
from nao_kin.motion.loop.messages import MAX_FRAME, FrameReader, Message, encode

if TYPE_CHECKING:
    from types import TracebackType

__all__ = ["Address", "InProcess", "Received", "SocketClient", "SocketServer", "Transport"]

Address: TypeAlias = "str | os.PathLike[str] | tuple[str, int]"
"""The path of a Unix socket, or host and port on this machine; port 0 takes a free one."""

# What is read at once from a peer that floods; the rest waits in its socket, and the loop keeps its time.
_MOST_A_CYCLE: Final = 4 * MAX_FRAME  # bytes
_MOST_MESSAGES: Final = 64
_PIECE: Final = 1024  # bytes; may hold some hundred messages, all of which are taken


@dataclass(frozen=True, eq=False, slots=True)
class Received:
    """What came since the last time.

    Attributes:
        messages: Messages, oldest first.
        refused: Why others could not be read, one sentence each.
    """

    messages: tuple[Message, ...] = ()
    refused: tuple[str, ...] = ()


class Transport(Protocol):
    """The robot's end of a connection with one peer."""

    def receive(self) -> Received:
        """What came since the last time; at once, whether there is anything or not."""

    def send(self, message: Message) -> None:
        """Sends a message, or drops it where no peer takes it; at once."""


class InProcess:
    """A transport to a peer in the same process, by queues. It does not encode anything."""

    def __init__(self) -> None:
        self._to_robot: deque[Message] = deque()
        self._to_peer: deque[Message] = deque(maxlen=1024)  # a peer that does not listen loses the oldest

    def receive(self) -> Received:
        """See `Transport`."""
        messages = tuple(self._to_robot.popleft() for _ in range(len(self._to_robot)))
        return Received(messages)

    def send(self, message: Message) -> None:
        """See `Transport`."""
        self._to_peer.append(message)

    def peer_send(self, message: Message) -> None:
        """What the peer does to command the robot."""
        self._to_robot.append(message)

    def peer_receive(self) -> tuple[Message, ...]:
        """What the robot has sent since the last time."""
        return tuple(self._to_peer.popleft() for _ in range(len(self._to_peer)))


class SocketServer:
    """A transport over a Unix socket or TCP on this machine, for one peer at a time.

    Another peer is turned away while one is connected; when that one leaves or sends what destroys the order of frames,
    the next may come. TCP is for this machine only: nobody is asked who they are.

    Args:
        address: Where to listen.

    Raises:
        InvalidInputError: An address that is not this machine's.
        OSError: The address is taken or may not be used.
    """

    def __init__(self, address: Address) -> None:
        self._path: Path | None = None
        if isinstance(address, tuple):
            self._listener = socket.create_server(_loopback(address), backlog=1)
        else:
            self._path = Path(address)
            self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            try:
                self._listener.bind(os.fspath(self._path))
                self._path.chmod(0o600)
                self._listener.listen(1)
            except OSError:
                self._listener.close()
                raise
        self._listener.setblocking(False)
        self._peer: socket.socket | None = None
        self._reader, self._unsent = FrameReader(), b""

    @property
    def address(self) -> Address:
        """Where it listens, with the port that was taken."""
        return self._listener.getsockname()[:2] if self._path is None else self._path

    @property
    def connected(self) -> bool:
        """Whether a peer is connected, as far as known."""
        return self._peer is not None

    def receive(self) -> Received:
        """See `Transport`."""
        self._accept()
        messages, refused = list[Message](), list[str]()
        read = 0
        while self._peer is not None and read < _MOST_A_CYCLE and len(messages) + len(refused) < _MOST_MESSAGES:
            try:
                data = self._peer.recv(_PIECE)
            except BlockingIOError:
                break
            except OSError:
                data = b""
            if not data:
                if self._reader.pending:
                    refused.append(f"the peer left within a message, after {self._reader.pending} bytes of it")
                self._drop()
                break
            read += len(data)
            for found in self._reader.feed(data):
                if isinstance(found, FrameError):
                    refused.append(found.reason)
                    if found.fatal:
                        self._drop()
                else:
                    messages.append(found)
        return Received(tuple(messages), tuple(refused))

    def send(self, message: Message) -> None:
        """See `Transport`; a peer that does not read loses whole messages, never parts of one."""
        if self._peer is None:
            return
        if not self._unsent:
            self._unsent = encode(message)
        try:
            self._unsent = self._unsent[self._peer.send(self._unsent) :]
        except BlockingIOError:
            pass
        except OSError:
            self._drop()

    def close(self) -> None:
        """Ends the connection and stops listening."""
        self._drop()
        if self._listener.fileno() < 0:
            return  # closed before, and the path may be another server's by now
        self._listener.close()
        if self._path is not None:
            self._path.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def _accept(self) -> None:
        with contextlib.suppress(BlockingIOError, ConnectionError):
            while True:
                peer, _ = self._listener.accept()
                if self._peer is not None:
                    peer.close()
                    continue
                peer.setblocking(False)
                if self._path is None:
                    peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._peer = peer

    def _drop(self) -> None:
        if self._peer is not None:
            self._peer.close()
        self._peer, self._reader, self._unsent = None, FrameReader(), b""


class SocketClient:
    """The peer's end of a `SocketServer`.

    Args:
        address: Where the server listens.
        timeout: How long to wait for a message [s].

    Raises:
        OSError: Nobody listens there.
    """

    def __init__(self, address: Address, timeout: float = 1.0) -> None:
        if isinstance(address, tuple):
            self._socket = socket.create_connection(address, timeout)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        else:
            self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
            self._socket.settimeout(timeout)
            try:
                self._socket.connect(os.fspath(address))
            except OSError:
                self._socket.close()
                raise
        self._timeout, self._reader, self._ready = timeout, FrameReader(), deque[Message]()

    def send(self, message: Message) -> None:
        """Sends a message.

        Raises:
            OSError: The robot has ended the connection.
        """
        self._socket.sendall(encode(message))

    def receive(self) -> Message:
        """The next message of the robot.

        Raises:
            TimeoutError: None came in time.
            ConnectionError: The robot has ended the connection.
            FrameError: What came cannot be read.
        """
        deadline = time.monotonic() + self._timeout
        while not self._ready:
            left = deadline - time.monotonic()
            if left <= 0.0:
                raise TimeoutError("no message from the robot in time")
            self._socket.settimeout(left)
            data = self._socket.recv(MAX_FRAME)
            if not data:
                raise ConnectionResetError("the robot has ended the connection")
            for found in self._reader.feed(data):
                if isinstance(found, FrameError):
                    raise found
                self._ready.append(found)
        return self._ready.popleft()

    def close(self) -> None:
        """Ends the connection."""
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()


def _loopback(address: tuple[str, int]) -> tuple[str, int]:
    host, port = address
    numeric = "127.0.0.1" if host == "localhost" else host
    with contextlib.suppress(ValueError):
        if ipaddress.IPv4Address(numeric).is_loopback:
            return numeric, port
    raise InvalidInputError(
        "address", "this machine's own, as ('127.0.0.1', 0), since nobody is asked who they are", host
    )
