"""The Franka Control Interface beside a running station."""

import contextlib
import logging
import mmap
import multiprocessing
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Self

from station.app.fci_run import FciRobotError, features_of
from station.app.restart_limit import RestartLimit
from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.franka import GripperServicesInterface
from station.core.loop.stop_latch import StopState
from station.hw.franka.fci.desk.desk_state import Desk
from station.hw.franka.fci.server import fci_process
from station.hw.franka.fci.server.client_port import FciPortError
from station.hw.franka.fci.server.client_services import (
    ArmClientService,
    HandClientService,
    with_client_services,
)
from station.hw.franka.fci.server.shared_page import PAGE_BYTES, SharedPage
from station.hw.franka.fci.wire.messages import FciProtocolError
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.hand.hand_services import HandServices

_logger = logging.getLogger(__name__)
_START = 20.0
"""Longest time until the process listens [s]."""
_END = 2.0


class FciBeside:
    """Connects a process that serves libfranka's clients with a station's arm and hand.

    The process moves bytes (`fci_process`). A thread reads the requests of a client
    from the process, and lets the control thread carry them out between two cycles.

    Args:
        station: The station; its loop need not run yet.
        host: Address to listen at.
        warn: Called with a line about a problem.
        version: The only version of the protocol; None for all versions with a table.
        desk_port: TCP port of Desk; None serves no Desk. The brakes are open at the
            start, and FCI is active, because controllers of the station use the arm,
            too.

    Raises:
        FciRobotError: The robot is not a simulated Franka arm.
        FciPortError: An address cannot be used.
        StationError: Desk has no certificate.
    """

    def __init__(
        self,
        station: Station,
        host: str,
        warn: Callable[[str], None],
        version: int | None = None,
        desk_port: int | None = None,
    ) -> None:
        hw, loop = station.loop.hw, station.loop
        if not isinstance(hw, FrankaHW) or (world := hw.simulated_world()) is None:
            raise FciRobotError(
                "fci.enabled is true; the Franka Control Interface serves one "
                "simulated arm of type franka_hw/FrankaHW alone.",
                remedy="Set fci.enabled to false, or choose such a robot.",
            )
        features = features_of(hw.parameters, version, warn)
        self._loop, self._hw, self._host, self._warn = loop, hw, host, warn
        self._memory = os.memfd_create("station-fci")
        os.ftruncate(self._memory, fci_process.MEMORY_BYTES)
        shared, hand = mmap.mmap(self._memory, fci_process.MEMORY_BYTES), _hand_of(hw)
        self._pages = SharedPage(shared), SharedPage(shared, PAGE_BYTES)
        self._service = ArmClientService(
            hw.arm,
            self._pages[0],
            features,
            is_commanded=lambda: hw.is_commanded,
            may_move=self._may_move,
            now=loop.clock.now,
        )
        self._hand: HandClientService | None = None
        if hand is not None:
            self._hand = HandClientService(
                hand, self._pages[1], may_move=self._may_move
            )
        self._closing = contextlib.ExitStack()
        self._process: subprocess.Popen[bytes] | None = None
        self._restarts = RestartLimit()
        # One thread carries out the requests of Desk one after the other.
        self._changes = ThreadPoolExecutor(1, "fci-desk")
        self._closing.callback(os.close, self._memory)
        self._closing.callback(self._end_process)
        self._closing.callback(self._changes.shutdown)
        try:
            self._start_process()
            if desk_port is not None:
                # Imported here, because only Desk needs a web server.
                from station.hw.franka.fci.desk.desk_server import DeskServer

                arm = world.arms[hw.parameters.arm_id]
                desk = Desk(self, arm, hand, hw.parameters.arm)
                self._closing.callback(DeskServer(desk, host, desk_port).close)
            loop.run_in_cycle(self._welcome)
        except StationError:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Disconnect the client and end the process."""
        self._closing.close()

    def change(self, action: Callable[[], None]) -> Future[None]:
        """Call a function between two cycles; see `ServerOfDesk`."""
        return self._changes.submit(self._loop.run_in_cycle, action)

    def open_or_close(self, *, is_open: bool) -> Future[None]:
        """Start the process that clients connect to, or end it; see `ServerOfDesk`."""
        return self._changes.submit(
            self._start_process if is_open else self._end_process
        )

    def _start_process(self) -> None:
        """Start the process that serves clients, if it does not run.

        Raises:
            StationError: The address cannot be used.
        """
        if self._process is not None:
            return
        for page in self._pages:  # drop answers that the last process has not sent
            page.take_answers()
        self._pipe, other = multiprocessing.Pipe()
        inherited = (other.fileno(), self._memory)
        command = [sys.executable, "-m", fci_process.__name__, self._host]
        command += [*map(str, inherited), *([] if self._hand is None else ["hand"])]
        with other:
            # The process keeps the scheduling of the station's threads, because it
            # sends a message every 1 ms.
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                pass_fds=inherited,
                start_new_session=True,  # Ctrl-C is for the station, which ends it
            )
        self._thread = threading.Thread(target=self._serve, name="fci", daemon=True)
        try:
            self._await_process()
        except StationError:
            self._end_process()
            raise
        self._thread.start()

    def _end_process(self) -> None:
        """End the process, if it runs, and so disconnect the client."""
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        if self._thread.is_alive():
            self._thread.join(_END)
        self._pipe.close()

    def _await_process(self) -> None:
        """Wait until the process listens.

        Raises:
            FciPortError: The process cannot listen, or does not listen in time.
        """
        reason = f"The server at {self._host} did not start."
        with contextlib.suppress(*fci_process.GONE):
            if self._pipe.poll(_START):
                *_, reason = self._pipe.recv()
        if reason:
            raise FciPortError(reason, remedy="Choose another fci.host.")

    def _welcome(self) -> None:
        self._hw.client_service = self._service
        hw, cycle, period = self._loop.hw, self._loop.control_cycle, self._loop.period
        longest = cycle.longest_period

        def wait(is_waiting: bool) -> None:  # noqa: FBT001 - called in every cycle
            cycle.longest_period = period if is_waiting else longest

        read = with_client_services(self._service, hw.read, wait, self._hand)
        hw.read = read  # type: ignore[assignment,method-assign]

    def _may_move(self) -> bool:
        return self._loop.stop_latch.state is StopState.ARMED

    def _serve(self) -> None:
        """Carry out the requests that the process passes on, until it ends."""
        pipe = self._pipe
        try:
            while True:
                action = partial(self._carry_out, pipe.recv())
                answers, port, reason = b"", None, ""
                try:
                    answers, port = self._loop.run_in_cycle(action)
                except FciProtocolError as error:
                    answers, reason = error.answers, error.message
                except StationError as error:
                    reason = error.message
                if news := reason or self._service.take_reason():
                    _logger.warning("Franka Control Interface: %s", news)
                pipe.send((answers, port, reason))
        except fci_process.GONE:
            self._say_goodbye()
        # Whoever ends the process has taken it away before.
        if self._process is not None:
            with contextlib.suppress(RuntimeError):  # the station is about to end
                self._changes.submit(self._replace_process)

    def _replace_process(self) -> None:
        """Start the process again, which has ended by itself."""
        self._end_process()
        end = "The process that serves clients of the FCI has ended"
        # A process that ends at once would keep the station busy with restarts.
        if not self._restarts.allows_another():
            self._warn(f"{end} too often; clients are served no more.")
            return
        self._warn(f"{end}; another begins.")
        try:
            self._start_process()
        except StationError as error:
            self._warn(f"Clients of the FCI are served no more: {error}")

    def _carry_out(self, request: tuple[bool, int, bytes]) -> tuple[bytes, int | None]:
        """Carry out a request of the process. Control thread."""
        is_hand, kind, data = request
        service = self._hand if is_hand and self._hand is not None else self._service
        if kind == fci_process.DATA:
            return service.receive(data)
        if kind == fci_process.OPEN:
            service.open()
        else:
            service.leave()
        return b"", None

    def _say_goodbye(self) -> None:
        """End the motion of the last client."""
        try:
            self._loop.run_in_cycle(self._service.leave)
            if self._hand is not None:
                self._loop.run_in_cycle(self._hand.leave)
        except StationError as error:
            self._warn(f"The last client of the FCI was not told: {error}")


def _hand_of(hw: FrankaHW) -> HandServices | None:
    """Return the simulated hand of an arm; None without one."""
    interface = hw.get(GripperServicesInterface)
    found = [] if interface is None else interface.handles()
    return next((hand for hand in found if isinstance(hand, HandServices)), None)
