"""Clients of the Franka Control Interface on the arm and the hand of a running station.

Either the station's controllers command the arm, or the client does. The hand obeys the
newest command of any client.
"""

from collections.abc import Callable
from typing import Generic, TypeVar

from typing_extensions import override

from station.hw.franka.arm.robot_arm import RobotArm
from station.hw.franka.fci.server.gripper_session import (
    GRIPPER_PERIOD,
    GripperSession,
)
from station.hw.franka.fci.server.robot_session import (
    SHORTEST_WAIT,
    ClientFeatures,
    RobotSession,
)
from station.hw.franka.fci.server.shared_page import SharedPage
from station.hw.franka.hand.hand_services import HandServices

SessionT = TypeVar("SessionT", RobotSession, GripperSession)


class _ClientService(Generic[SessionT]):
    """Serves one client at a time, between and within the cycles. Control thread only.

    In a cycle it copies bytes between the session and the page, and nothing else.

    Args:
        page: Shared memory for messages in both directions.
        begin: Begins the session of a new client.
    """

    def __init__(self, page: SharedPage, begin: Callable[[], SessionT]) -> None:
        self._page = page
        self._begin: Callable[[], SessionT] = begin
        self._session: SessionT | None = None
        self._unsent = b""

    def open(self) -> None:
        """Welcome a new client."""
        self.leave()
        self._session = self._begin()

    def receive(self, data: bytes) -> tuple[bytes, int | None]:
        """Take bytes of the client; return answers, and the client's UDP port.

        Args:
            data: The next bytes.

        Raises:
            FciProtocolError: The client broke the protocol; the connection must end.
        """
        session = self._session
        if session is None:
            return b"", None
        answers = session.receive(data)
        return answers, session.udp_port

    def leave(self) -> None:
        """End the motion of a client that has gone."""
        session, self._session, self._unsent = self._session, None, b""
        if session is not None:
            session.close()

    def _put_messages(self, session: SessionT, number: int, every: int = 1) -> None:
        """Leave a state, and the answers that became due if there is room for them.

        Args:
            session: The session of the client.
            number: Number of the state.
            every: Only every such number is that of a state.
        """
        self._unsent += session.after_cycle()
        # The state goes first: a client that reads the answer reports the errors of
        # this state.
        if not number % every:
            self._page.put_state(session.state(number))
        if self._unsent and self._page.put_answers(self._unsent):
            self._unsent = b""


class ArmClientService(_ClientService[RobotSession]):
    """Serves a client of the arm.

    Args:
        arm: The arm.
        page: Shared memory for messages in both directions.
        features: The versions that are spoken, and the models of the arm.
        is_commanded: Returns whether the station's controllers command the arm.
        may_move: Returns whether the station lets anybody move the arm.
        now: Returns the time [s] by the clock of the control loop.
    """

    def __init__(
        self,
        arm: RobotArm,
        page: SharedPage,
        features: ClientFeatures,
        *,
        is_commanded: Callable[[], bool],
        may_move: Callable[[], bool],
        now: Callable[[], float],
    ) -> None:
        super().__init__(page, lambda: RobotSession(arm, features, self._is_free))
        self._arm = arm
        self._is_commanded, self._may_move = is_commanded, may_move
        self._now = now
        self._answerable = 0.0  # time until which nobody can have answered the state

    @property
    def is_moving(self) -> bool:
        """Return whether a motion of the client runs."""
        return self._session is not None and self._session.is_moving

    @property
    def is_answering(self) -> bool:
        """Return whether the client owes a command to every cycle of the arm."""
        return self._session is not None and self._session.is_answering

    def take_reason(self) -> str:
        """Return the reason for the last refusal once; empty if there is none."""
        return "" if self._session is None else self._session.take_reason()

    @override
    def open(self) -> None:
        super().open()
        self._page.take_command()  # one that the last client has left

    def before_read(self) -> bool:
        """Pass the client's command on, before the arm makes a step.

        Returns:
            Whether the arm has to wait with its step. After a late cycle of the loop
            the next one comes early, when the client has had no time to answer: that
            command is not lost. The arm waits for one cycle, not for a silent client.
        """
        session = self._session
        if session is None:
            return False
        if session.is_moving and not self._is_free():
            self._unsent += session.preempt()
            if not self._is_commanded():  # else the controllers have the arm by now
                self._arm.stop_motion()
        datagram = self._page.take_command()
        if datagram is not None:
            session.receive_command(datagram)
        if session.misses_command and self._now() < self._answerable:
            self._answerable = 0.0
            return True
        self._unsent += session.before_cycle()
        return False

    def after_read(self) -> None:
        """Leave the new state for the client, and the answers that became due."""
        session, arm = self._session, self._arm
        if session is not None and session.udp_port is not None:
            arm.refresh_state()
            self._put_messages(session, round(arm.state.time / arm.cycle_time))
            self._answerable = self._now() + SHORTEST_WAIT * arm.cycle_time

    def _is_free(self) -> bool:
        return self._may_move() and not self._is_commanded()


class HandClientService(_ClientService[GripperSession]):
    """Serves a client of the hand.

    Args:
        hand: The hand.
        page: Shared memory for messages.
        may_move: Returns whether the station lets anybody move the fingers.
    """

    def __init__(
        self, hand: HandServices, page: SharedPage, *, may_move: Callable[[], bool]
    ) -> None:
        super().__init__(page, lambda: GripperSession(hand, is_free=may_move))
        self._cycle = 0

    def after_read(self) -> None:
        """Leave new states for the client."""
        session = self._session
        if session is not None and session.udp_port is not None:
            self._cycle += 1
            self._put_messages(session, self._cycle, GRIPPER_PERIOD)


def with_client_services(
    service: ArmClientService,
    read: Callable[[float, float], None],
    wait: Callable[[bool], None],
    hand: HandClientService | None = None,
) -> Callable[[float, float], None]:
    """Return a function that reads a robot, and serves its clients before and after.

    Args:
        service: Serves the client of the arm.
        read: Reads the robot; see `RobotHW.read`.
        wait: Sets whether the arm waits for a late loop. The arm must wait while a
            client commands it: in a cycle that is made up for, the client has no state
            to answer.
        hand: Serves the client of the hand; None without a hand.
    """

    def read_and_serve(time: float, period: float) -> None:
        if not service.before_read():
            read(time, period)
            service.after_read()
        wait(service.is_answering)
        if hand is not None:
            hand.after_read()

    return read_and_serve
