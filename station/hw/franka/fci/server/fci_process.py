"""The process between clients of an arm or its hand, and the station with the arm.

It moves bytes: between TCP and a pipe to the station, and between UDP and the memory
that it shares with the control thread. The station interprets them.

A request through the pipe tells whether the client is one of the hand, the kind of the
request, and bytes of the client. The station replies with answers for the client, with
the client's UDP port, None until it has connected, and with the reason why the client
must go, empty if it may stay.
"""

import contextlib
import mmap
import os
import sys
from functools import partial
from multiprocessing.connection import Connection
from typing import Any, TypeAlias

from station.hw.franka.fci.server.client_port import ClientPort, serve
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.fci.wire.robot_protocol import PANDA

Pipe: TypeAlias = "Connection[Any, Any]"
OPEN, DATA, LEAVE = 1, 2, 3
"""Kinds of requests: a new client, its bytes, its end."""
GONE = (EOFError, OSError)
"""Errors of a pipe whose other side has gone."""
MEMORY_BYTES = 2 * PAGE_BYTES
"""Size of the memory that is shared [bytes]: the page of the arm, that of the hand."""
_LOOK = 0.0002
"""Time between two looks at the shared memory while there is a client [s]."""
_IDLE = 0.05


class RelayedSession:
    """Stands for the session of one client, which is in the station.

    Args:
        pipe: The pipe to the station.
        is_hand: Whether the client is one of the hand.

    Attributes:
        udp_port: The client's UDP port; None until it has connected.
    """

    def __init__(self, pipe: Pipe, *, is_hand: bool) -> None:
        self._pipe, self._is_hand = pipe, is_hand
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
        # A station that is gone, or whose loop has died, needs not be told.
        with contextlib.suppress(*GONE, FciProtocolError):
            self._ask(LEAVE)

    def _ask(self, kind: int, data: bytes = b"") -> bytes:
        self._pipe.send((self._is_hand, kind, data))
        answers, self.udp_port, reason = self._pipe.recv()
        if reason:
            raise FciProtocolError(reason, answers=answers)
        found: bytes = answers
        return found


class FciProcess:
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
        pipe: Pipe,
        page: SharedPage,
        hand: SharedPage | None = None,
    ) -> None:
        self._pipe = pipe
        self._served = []
        for what, protocol, memory in (("Robot", PANDA, page), ("Gripper", HAND, hand)):
            if memory is None:
                continue
            begin = partial(RelayedSession, pipe, is_hand=protocol is HAND)
            try:
                port = ClientPort(what, (host, protocol.port), begin)
            except OSError:
                self.close()
                raise
            self._served.append((port, memory))

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
        except GONE:
            return
        finally:
            self.close()

    def close(self) -> None:
        """Send the clients away."""
        for port, _ in self._served:
            port.close()


def relay(port: ClientPort[RelayedSession], page: SharedPage) -> None:
    """Move messages of the client and of the control thread."""
    for datagram in port.datagrams():
        page.put_command(datagram)
    # The station leaves answers after the state that belongs to them. Taken before the
    # state and sent after it, answers never overtake it.
    answers, state = page.take_answers(), page.take_state()
    if state is not None:
        port.send_datagram(state)
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
    with Connection(int(pipe_number)) as pipe:
        try:
            process = FciProcess(host, pipe, SharedPage(memory), hand)
        except OSError as error:
            pipe.send((b"", None, f"{error}"))
            return
        pipe.send((b"", None, ""))
        process.run()


if __name__ == "__main__":
    main(sys.argv[1:])
