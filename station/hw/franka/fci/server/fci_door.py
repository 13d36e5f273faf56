"""The process between clients of an arm or its hand, and the station with the arm.

It moves bytes: between TCP and a pipe to the station, and between UDP and the memory
that it shares with the control thread. The station interprets them.

Through the pipe go frames: a kind, a size, and bytes. The station answers each frame.
"""

import contextlib
import mmap
import os
import socket
import struct
import sys

from station.hw.franka.fci.server.client_port import ClientPort, serve
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import PANDA

OPEN, DATA, LEAVE = 1, 2, 3
"""Kinds of frames from this process: a new client, its bytes, its end."""
OF_HAND = 16
"""Added to the kind of every frame that belongs to a client of the hand."""
MEMORY_BYTES = 2 * PAGE_BYTES
"""Size of the memory that is shared [bytes]: the page of the arm, that of the hand."""
ANSWER, REFUSAL = 4, 5
"""Kinds of frames to this process: the UDP port and answers; why a client must go."""
FRAME = struct.Struct("<BI")
"""Head of a frame: its kind, and the size of its content [bytes]."""
LAST_WORDS = struct.Struct("<H")
"""Head of a `REFUSAL`: the size of the answers before the reason [bytes]."""
UDP_PORT = struct.Struct("<H")
"""Head of an `ANSWER`: the client's UDP port, 0 until it has connected."""
_LOOK = 0.0002
"""Time between two looks at the shared memory while there is a client [s]."""
_IDLE = 0.05


class StationGoneError(OSError):
    """The station has closed the pipe."""


def send_frame(pipe: socket.socket, kind: int, data: bytes = b"") -> None:
    """Send a frame."""
    pipe.sendall(FRAME.pack(kind, len(data)) + data)


def refusal(reason: str, answers: bytes = b"") -> bytes:
    """Return the content of a `REFUSAL`.

    Args:
        reason: Why the client must go.
        answers: Answers that the client gets before it must go.
    """
    return LAST_WORDS.pack(len(answers)) + answers + reason.encode()


def receive_frame(pipe: socket.socket) -> tuple[int, bytes]:
    """Wait for a frame; return its kind and content.

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
    """Stands for the session of one client, which is in the station.

    Args:
        pipe: The pipe to the station.
        channel: Offset that is added to the kinds of frames.

    Attributes:
        udp_port: The client's UDP port; None until it has connected.
    """

    def __init__(self, pipe: socket.socket, channel: int = 0) -> None:
        self._pipe, self._channel = pipe, channel
        self.udp_port: int | None = None
        self._ask(OPEN)

    def receive(self, data: bytes) -> bytes:
        """Pass bytes of the client on; return the answers.

        Raises:
            FciProtocolError: The station refuses the client's message.
        """
        return self._ask(DATA, data)

    def close(self) -> None:
        """Tell the station that the client has gone."""
        with contextlib.suppress(OSError):  # without a station nobody is left to tell
            self._ask(LEAVE)

    def _ask(self, kind: int, data: bytes = b"") -> bytes:
        send_frame(self._pipe, kind + self._channel, data)
        kind, body = receive_frame(self._pipe)
        if kind == REFUSAL:
            (size,) = LAST_WORDS.unpack_from(body)
            body = body[LAST_WORDS.size :]
            raise FciProtocolError(body[size:].decode(), answers=body[:size])
        self.udp_port = UDP_PORT.unpack_from(body)[0] or None
        return body[UDP_PORT.size :]


class FciDoor:
    """Serves the clients of one arm and of its hand, in a process of its own.

    Args:
        host: Address to listen at.
        pipe: The pipe to the station.
        page: The memory that is shared with the control thread.
        hand: The memory shared for the hand; None without a hand.

    Raises:
        FciPortError: The address cannot be used.
    """

    def __init__(
        self,
        host: str,
        pipe: socket.socket,
        page: SharedPage,
        hand: SharedPage | None = None,
    ) -> None:
        self._pipe = pipe
        robot = ClientPort("Robot", (host, PANDA.port), lambda: RelayedSession(pipe))
        self._served = [(robot, page)]
        if hand is not None:
            try:
                gripper = ClientPort(
                    "Gripper", (host, HAND.port), lambda: RelayedSession(pipe, OF_HAND)
                )
            except OSError:
                robot.close()
                raise
            self._served.append((gripper, hand))

    def run(self) -> None:
        """Serve until the station closes the pipe."""
        ports = [port for port, _ in self._served]
        try:
            while True:
                is_idle = all(port.session is None for port in ports)
                if serve(ports, _IDLE if is_idle else _LOOK, self._pipe):
                    return  # the station says nothing unasked: it has gone
                for port, page in self._served:
                    relay(port, page)
        except StationGoneError:
            return
        finally:
            for port in ports:
                port.close()


def relay(port: ClientPort[RelayedSession], page: SharedPage) -> None:
    """Move messages of the client and of the control thread."""
    for datagram in port.datagrams():
        page.put_command(datagram)
    # The station leaves answers after the state that belongs to them. Taken before the
    # state and sent after it, answers never overtake it.
    answers, state = page.take_answers(), page.take_state()
    if state is not None:
        port.send_datagram(bytes(state))
    port.send(answers)


def main(arguments: list[str]) -> None:
    """Serve clients at the address in the arguments, with two inherited descriptors.

    Args:
        arguments: The address, the descriptors, and `hand` if there is a hand.
    """
    host, pipe_number, memory_number, *parts = arguments
    memory = mmap.mmap(int(memory_number), MEMORY_BYTES)
    hand = SharedPage(memory, PAGE_BYTES) if "hand" in parts else None
    with contextlib.suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, -10)
    with socket.socket(fileno=int(pipe_number)) as pipe:
        try:
            door = FciDoor(host, pipe, SharedPage(memory), hand)
        except OSError as error:
            send_frame(pipe, REFUSAL, refusal(f"{error}"))
            return
        send_frame(pipe, ANSWER)
        door.run()


if __name__ == "__main__":
    main(sys.argv[1:])
