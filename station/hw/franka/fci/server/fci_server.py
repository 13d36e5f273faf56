"""The robot's side of the Franka Control Interface: the cycle, and two ports.

The cycle is the arm's clock. A cycle that begins late is not caught up: a real arm is
never late, and a client must not lose packets because the server was.
"""

import logging
import time
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Any

from station.core.errors import StationError
from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.fci.server.client_port import ClientPort, serve
from station.hw.franka.fci.server.gripper_session import (
    GRIPPER_PERIOD,
    GripperSession,
)
from station.hw.franka.fci.server.robot_session import (
    SHORTEST_WAIT,
    ClientFeatures,
    RobotSession,
)
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.fci.wire.robot_protocol import PANDA
from station.hw.franka.hand.hand_services import HandServices

_logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class FciSettings:
    """The addresses and the timing with which clients are served.

    Attributes:
        host: Address to listen at; the ports are libfranka's.
        patience: How long the arm's time waits for a command of a moving client beyond
            the end of a cycle, before the command counts as lost [s], >= 0. A real arm
            does not wait.
    """

    host: str = "127.0.0.1"
    patience: float = 0.0


@dataclass(slots=True)
class FciCounts:
    """The server's counts since its start.

    Attributes:
        cycles: Cycles of the arm.
        commanded: Cycles of a client's motion, from its first command on.
        lost: Commanded cycles in which no command had arrived.
    """

    cycles: int = 0
    commanded: int = 0
    lost: int = 0


class FciServer:
    """Serves one arm, and its hand if it has one. All in the calling thread.

    Args:
        arm: The arm; the server calls its `read_once`.
        hand: The hand; None without a hand.
        settings: Address and timing.
        features: The versions that are spoken, and the models of the arm.
        clock: Wall time [s].

    Attributes:
        counts: Numbers of cycles and of lost commands so far.

    Raises:
        FciPortError: An address cannot be used.
    """

    def __init__(
        self,
        arm: RobotArm,
        hand: HandServices | None,
        settings: FciSettings,
        features: ClientFeatures,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._arm, self._hand = arm, hand
        self._settings = settings
        self._clock = clock
        self._message_id = 0
        self._mode = arm.state.robot_mode
        self._changes: SimpleQueue[tuple[Callable[[], None], Future[None]]]
        self._changes = SimpleQueue()
        self.counts = FciCounts()
        self._robot_port = ClientPort(
            "Robot",
            (settings.host, PANDA.port),
            lambda: RobotSession(arm, features),
        )
        self._ports: list[ClientPort[Any]] = [self._robot_port]
        self._gripper_port: ClientPort[GripperSession] | None = None
        if hand is not None:
            try:
                self._gripper_port = ClientPort(
                    "Gripper", (settings.host, HAND.port), lambda: GripperSession(hand)
                )
            except OSError:
                self._robot_port.close()
                raise
            self._ports.append(self._gripper_port)

    def run(self, is_over: Callable[[], bool]) -> None:
        """Serve until `is_over`, called once per cycle, returns True."""
        period = self._arm.cycle_time
        sent = deadline = self._clock()
        while not is_over():
            deadline = max(deadline + period, sent + SHORTEST_WAIT * period)
            self._wait(deadline)
            self._make_changes()
            self._cycle()
            sent = self._clock()

    def change(self, action: Callable[[], None]) -> Future[None]:
        """Carry an action out between two cycles. Any thread.

        Args:
            action: The change; it may not wait.

        Returns:
            Done when the action has been carried out, or has failed with an exception.
        """
        done: Future[None] = Future()
        self._changes.put((action, done))
        return done

    def open_or_close(self, *, is_open: bool) -> Future[None]:
        """Listen at both ports, or send the clients away and refuse connections.

        Returns:
            Done when the ports are open or closed; an OSError if another program has
                taken a port.
        """

        def open_or_close() -> None:
            for port in self._ports:
                port.set_open(is_open=is_open)

        return self.change(open_or_close)

    def close(self) -> None:
        """Send the clients away."""
        for port in self._ports:
            port.close()

    def _make_changes(self) -> None:
        while not self._changes.empty():
            action, done = self._changes.get()
            if not done.set_running_or_notify_cancel():
                continue  # whoever asked for it waits no longer
            try:
                action()
            except (OSError, StationError) as error:
                done.set_exception(error)
            else:
                done.set_result(None)

    def _cycle(self) -> None:
        """Let the arm make a step, and send its state and answers to the clients."""
        port, counts = self._robot_port, self.counts
        session, answers = port.session, b""
        counts.cycles += 1
        if session is not None:
            counts.commanded += session.is_answering
            counts.lost += session.misses_command
            answers = session.before_cycle()
        self._arm.read_once()
        self._message_id += 1
        if session is not None and session.udp_port is not None:
            self._arm.refresh_state()
            answers += session.after_cycle()
            # The state goes first: a client that reads the answer reports the errors of
            # this state.
            port.send_datagram(session.state(self._message_id))
            port.send(answers)
            if reason := session.take_reason():
                _logger.warning("Robot: %s", reason)
        self._tell_errors()
        if self._hand is not None:
            self._hand.advance()
        self._serve_gripper()

    def _tell_errors(self) -> None:
        """Write the reasons of a new reflex to the log: clients get names only."""
        before, self._mode = self._mode, self._arm.state.robot_mode
        if self._mode is RobotMode.REFLEX and before is not RobotMode.REFLEX:
            causes = "; ".join(error.description for error in self._arm.errors())
            _logger.warning("Robot: the arm has stopped by a reflex: %s", causes)

    def _serve_gripper(self) -> None:
        port = self._gripper_port
        if port is None or port.session is None:
            return
        port.send(port.session.after_cycle())
        if port.session is not None and not self._message_id % GRIPPER_PERIOD:
            port.send_datagram(port.session.state(self._message_id))

    def _wait(self, deadline: float) -> None:
        """Serve the sockets until the cycle ends, and once more for late messages."""
        while (left := deadline - self._clock()) > 0.0:
            self._poll(left)
        self._poll(0.0)
        given_up = deadline + self._settings.patience
        while self._misses_a_command() and (left := given_up - self._clock()) > 0.0:
            self._poll(left)

    def _misses_a_command(self) -> bool:
        session = self._robot_port.session
        is_moving = self._arm.state.robot_mode is RobotMode.MOVE
        return session is not None and session.misses_command and is_moving

    def _poll(self, timeout: float) -> None:
        serve(self._ports, timeout)
        session = self._robot_port.session
        if session is not None:
            for datagram in self._robot_port.datagrams():
                session.receive_command(datagram)
