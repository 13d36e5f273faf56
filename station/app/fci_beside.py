"""The Franka Control Interface beside a running station."""

import logging
import mmap
import os
import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from functools import partial
from typing import Self

from station.app.fci_run import (
    FciRobotError,
    model_library_of,
    protocols_of,
    robot_model_of,
)
from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.franka import GripperServicesInterface
from station.core.loop.stop_latch import StopState
from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.server.fci_door import (
    ANSWER,
    DATA,
    LAST_WORDS,
    MEMORY_BYTES,
    OF_HAND,
    OPEN,
    REFUSAL,
    UDP_PORT,
    receive_frame,
    refusal,
    send_frame,
)
from station.hw.franka.fci.server.fci_guest import FciGuest, GuestReading, HandGuest
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.hand.hand_services import HandServices

_logger = logging.getLogger(__name__)
_START = 20.0
"""Longest time until the process listens [s]."""
_END = 2.0


class FciBeside:
    """Joins a process that serves clients to the arm and the hand of a station.

    The process moves bytes (`fci_door`). What a client asks for is done by the control
    thread between two cycles, at the request of a thread that waits for the process.

    Args:
        station: The station; its loop need not run yet.
        host: Address to listen at.
        warn: Takes a line about something that is not as it should be.
        version: The only version that is spoken; None for all that have a table.

    Raises:
        FciRobotError: The robot is no simulated Franka arm.
        FciPortError: The address cannot be used.
    """

    def __init__(
        self,
        station: Station,
        host: str,
        warn: Callable[[str], None],
        version: int | None = None,
    ) -> None:
        hw, loop = station.loop.hw, station.loop
        if not isinstance(hw, FrankaHW) or hw.simulated_world() is None:
            raise FciRobotError(
                "fci.enabled is true; the Franka Control Interface serves one "
                "simulated arm of type franka_hw/FrankaHW alone.",
                remedy="Set fci.enabled to false, or choose such a robot.",
            )
        library = model_library_of(hw.parameters, warn)
        self._loop, self._hw, self._warn = loop, hw, warn
        memory = os.memfd_create("station-fci")
        os.ftruncate(memory, MEMORY_BYTES)
        shared, hand = mmap.mmap(memory, MEMORY_BYTES), _hand_of(hw)
        self._guest = FciGuest(
            hw.arm,
            SharedPage(shared),
            library,
            protocols_of(hw.parameters, version),
            robot_model_of(hw.parameters),
            is_commanded=lambda: hw.is_commanded,
            may_move=self._may_move,
        )
        self._hand: HandGuest | None = None
        if hand is not None:
            page = SharedPage(shared, PAGE_BYTES)
            self._hand = HandGuest(hand, page, may_move=self._may_move)
        self._pipe, other = socket.socketpair()
        with other:
            # It has the scheduling of the station's threads: a message every 1 ms.
            inherited = (other.fileno(), memory)
            self._process = subprocess.Popen(
                [
                    sys.executable,
                    "-m",
                    "station.hw.franka.fci.server.fci_door",
                    host,
                    *map(str, inherited),
                    *([] if hand is None else ["hand"]),
                ],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                pass_fds=inherited,
                start_new_session=True,  # Ctrl-C is for the station, which ends it
            )
        os.close(memory)
        try:
            self._await_door(host)
        except StationError:
            self.close()
            raise
        self._thread = threading.Thread(target=self._serve, name="fci", daemon=True)
        loop.run_in_cycle(self._welcome)
        self._thread.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Send the client away and end the process."""
        self._pipe.shutdown(socket.SHUT_RDWR)
        try:
            self._process.wait(_END)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        thread = getattr(self, "_thread", None)
        if thread is not None:
            thread.join(_END)
        self._pipe.close()

    def _await_door(self, host: str) -> None:
        """Wait until the process listens.

        Raises:
            FciPortError: The process cannot listen, or does not in time.
        """
        self._pipe.settimeout(_START)
        try:
            kind, body = receive_frame(self._pipe)
        except OSError as error:
            kind, body = (
                REFUSAL,
                refusal(f"The server at {host} did not start: {error}"),
            )
        self._pipe.settimeout(None)
        if kind == REFUSAL:
            reason = body[LAST_WORDS.size :].decode()
            raise FciPortError(reason, remedy="Choose another fci.host.")

    def _welcome(self) -> None:
        self._hw.guest = self._guest
        hw = self._loop.hw
        hw.read = GuestReading(self._guest, hw.read, self._hand).read  # type: ignore[method-assign]

    def _may_move(self) -> bool:
        return self._loop.stop_latch.state is StopState.ARMED

    def _serve(self) -> None:
        """Carry out the requests that the process passes on, until it ends."""
        pipe = self._pipe
        try:
            while True:
                kind, data = receive_frame(pipe)
                try:
                    action = partial(self._carry_out, kind, data)
                    answers, port = self._loop.run_in_cycle(action)
                except StationError as error:
                    _logger.warning("Franka Control Interface: %s", error.message)
                    told = error.answers if isinstance(error, FciProtocolError) else b""
                    send_frame(pipe, REFUSAL, refusal(error.message, told))
                else:
                    send_frame(pipe, ANSWER, UDP_PORT.pack(port or 0) + answers)
                    if reason := self._guest.take_reason():
                        _logger.warning("Franka Control Interface: %s", reason)
        except OSError:
            self._say_goodbye()

    def _carry_out(self, kind: int, data: bytes) -> tuple[bytes, int | None]:
        """Carry out the request of a frame. Control thread."""
        guest: FciGuest | HandGuest = self._guest
        if kind > OF_HAND and self._hand is not None:
            guest, kind = self._hand, kind - OF_HAND
        if kind == DATA:
            return guest.receive(data)
        if kind == OPEN:
            guest.open()
        else:
            guest.leave()
        return b"", None

    def _say_goodbye(self) -> None:
        """End the motion that the last client has begun."""
        try:
            self._loop.run_in_cycle(self._guest.leave)
            if self._hand is not None:
                self._loop.run_in_cycle(self._hand.leave)
        except StationError as error:
            self._warn(f"The last client of the FCI was not told: {error}")


def _hand_of(hw: FrankaHW) -> HandServices | None:
    """Return the simulated hand of an arm; None without one."""
    interface = hw.get(GripperServicesInterface)
    found = [] if interface is None else interface.handles()
    return next((hand for hand in found if isinstance(hand, HandServices)), None)
