"""The process between the clients of an arm and the station that has the arm.

It moves bytes: between TCP and a pipe to the station, and between UDP and the memory
that it shares with the control thread. What they mean is settled in the station.

Through the pipe go frames: a kind, a size, and bytes. The station answers each one.
"""

import contextlib
import mmap
import os
import select
import socket
import struct
import sys
from typing import TYPE_CHECKING

from station.hw.franka.fci.server.client_port import ClientPort
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import PANDA

if TYPE_CHECKING:
    from collections.abc import Iterator

OPEN, DATA, LEAVE = 1, 2, 3
"""Kinds of frames from this process: a new client, its bytes, its end."""
ANSWER, REFUSAL = 4, 5
"""Kinds of frames to this process: answers behind the UDP port; why it must go."""
FRAME = struct.Struct("<BI")
"""Head of a frame: its kind, and the size of what follows [bytes]."""
UDP_PORT = struct.Struct("<H")
"""What an `ANSWER` begins with: the client's UDP port, 0 until it has connected."""
_LOOK = 0.0002
"""Time between two looks at the shared memory while there is a client [s]."""
_IDLE = 0.05


class StationGoneError(OSError):
    """The station has closed the pipe."""


def send_frame(pipe: socket.socket, kind: int, data: bytes = b"") -> None:
    """Send a frame."""
    pipe.sendall(FRAME.pack(kind, len(data)) + data)


def receive_frame(pipe: socket.socket) -> tuple[int, bytes]:
    """Wait for a frame; return its kind and what it holds.

    Raises:
        StationGoneError: The other side has closed the pipe.
    """
    kind, size = FRAME.unpack(_receive(pipe, FRAME.size))
    return kind, _receive(pipe, size)


def _receive(pipe: socket.socket, size: int) -> bytes:
    found = bytearray()
    while len(found) < size:
        data = pipe.recv(size - len(found))
        if not data:
            raise StationGoneError("the other side has closed the pipe")
        found += data
    return bytes(found)


class RelayedSession:
    """The session of one client, which is in the station.

    Args:
        pipe: The pipe to the station.

    Attributes:
        udp_port: The client's UDP port; None until it has connected.
    """

    def __init__(self, pipe: socket.socket) -> None:
        self._pipe = pipe
        self.udp_port: int | None = None
        self._ask(OPEN)

    def receive(self, data: bytes) -> bytes:
        """Pass bytes of the client on; return the answers.

        Raises:
            FciProtocolError: The station refuses what the client sent.
        """
        return self._ask(DATA, data)

    def close(self) -> None:
        """Tell the station that the client has gone."""
        with contextlib.suppress(OSError):  # without a station nobody is left to tell
            self._ask(LEAVE)

    def _ask(self, kind: int, data: bytes = b"") -> bytes:
        send_frame(self._pipe, kind, data)
        kind, body = receive_frame(self._pipe)
        if kind == REFUSAL:
            raise FciProtocolError(body.decode())
        self.udp_port = UDP_PORT.unpack_from(body)[0] or None
        return body[UDP_PORT.size :]


class FciDoor:
    """Serves the clients of one arm, in a process of its own.

    Args:
        host: Address to listen at.
        pipe: The pipe to the station.
        page: The memory that is shared with the control thread.

    Raises:
        FciPortError: The address cannot be used.
    """

    def __init__(self, host: str, pipe: socket.socket, page: SharedPage) -> None:
        self._pipe = pipe
        self._page = page
        self._port = ClientPort(
            "Robot", (host, PANDA.port), lambda: RelayedSession(pipe)
        )

    def run(self) -> None:
        """Serve until the station closes the pipe."""
        try:
            for _ in self._turns():
                self._relay()
        except StationGoneError:
            return
        finally:
            self._port.close()

    def _turns(self) -> "Iterator[None]":
        while True:
            port = self._port
            wait = _IDLE if port.session is None else _LOOK
            readers = [*port.readers(), self._pipe]
            ready, sendable, _ = select.select(readers, port.writers(), [], wait)
            if self._pipe in ready:
                return  # the station says nothing unasked: it has gone
            if {*ready, *sendable}.intersection({*port.readers(), *port.writers()}):
                port.handle()
            yield

    def _relay(self) -> None:
        port, page = self._port, self._page
        for datagram in port.datagrams():
            page.put_command(datagram)
        answers, state = page.take_answers(), page.take_state()
        port.send(answers)
        if state is not None:
            port.send_datagram(bytes(state))


def main(arguments: list[str]) -> None:
    """Serve clients at the address in the arguments, with two inherited descriptors."""
    host, pipe_number, page_number = arguments
    page = SharedPage(mmap.mmap(int(page_number), PAGE_BYTES))
    with contextlib.suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, -10)
    with socket.socket(fileno=int(pipe_number)) as pipe:
        try:
            door = FciDoor(host, pipe, page)
        except OSError as error:
            send_frame(pipe, REFUSAL, f"{error}".encode())
            return
        send_frame(pipe, ANSWER)
        door.run()


if __name__ == "__main__":
    main(sys.argv[1:])
