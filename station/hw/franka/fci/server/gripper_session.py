"""One client of a hand: its requests and their answers; no sockets.

A newer command takes the fingers over; the older one is answered with ABORTED.
"""

from collections.abc import Callable

from typing_extensions import override

from station.core.errors import GripperCommandError, InvalidCommandError
from station.core.franka import GraspRequest
from station.core.ports.goal import GoalStatus
from station.hw.franka.fci.server.session import ClientSession
from station.hw.franka.fci.wire.gripper_protocol import HAND, HandCommand
from station.hw.franka.fci.wire.messages import Request
from station.hw.franka.fci.wire.robot_protocol import Status
from station.hw.franka.hand.hand_services import HandServices

GRIPPER_PERIOD = 10
"""A state of the hand is sent in every tenth cycle of the arm."""
_ENDS = {
    GoalStatus.SUCCEEDED: Status.SUCCESS,
    GoalStatus.ABORTED: Status.UNSUCCESSFUL,
}


class GripperSession(ClientSession[HandCommand]):
    """Serves one client of a hand. Control thread.

    Args:
        hand: The hand; the owner of the session advances it once per cycle.
        is_free: Returns whether this client may move the fingers.
    """

    def __init__(
        self,
        hand: HandServices,
        is_free: Callable[[], bool] = lambda: True,
    ) -> None:
        super().__init__([HAND])
        self._hand = hand
        self._is_free = is_free
        self._running: Request[HandCommand] | None = None
        self._identifier: int | None = None  # of the command that this client began

    def after_cycle(self) -> bytes:
        """Return the answer that is due because a motion of the fingers has ended."""
        if self._running is None:
            return b""
        state = self._hand.get_state()
        if state.command is not None and state.command.identifier == self._identifier:
            return b""
        last = state.last
        if last is None or last.identifier != self._identifier:
            return self._end(Status.ABORTED)  # others have used the hand since
        return self._end(_ENDS.get(last.status, Status.ABORTED))

    def state(self, message_id: int) -> bytes:
        """Return the state of the hand as a message.

        Args:
            message_id: Number of the message.
        """
        state = self._hand.get_state()
        return HAND.state.pack({
            "message_id": message_id % 2**32,
            "width": state.width,
            "max_width": state.max_width,
            "is_grasped": state.is_grasped,
            "temperature": round(state.temperature),
        })

    def close(self) -> None:
        """Stop the fingers if a motion of the departed client runs."""
        if self._running is not None:
            self._running = None
            if self._present() == self._identifier:
                self._hand.stop()

    @override
    def _serve(self, request: Request[HandCommand]) -> bytes:
        is_stop = request.command is HandCommand.STOP
        if not self._is_free() and not is_stop:
            return self._say(request, Status.FAIL)
        try:
            self._begin(request)
        except (GripperCommandError, InvalidCommandError):
            return self._say(request, Status.FAIL)
        answers = self._end(Status.ABORTED)
        self._identifier = self._present()
        if is_stop:
            return answers + self._say(request, Status.SUCCESS)
        self._running = request
        return answers

    def _begin(self, request: Request[HandCommand]) -> None:
        hand, values = self._hand, request.values
        match request.command:
            case HandCommand.HOMING:
                hand.homing()
            case HandCommand.MOVE:
                hand.move(**values)
            case HandCommand.GRASP:
                hand.grasp(GraspRequest(**values))
            case _:
                hand.stop()

    def _present(self) -> int | None:
        """Return the number of the hand's present command; None without one."""
        command = self._hand.get_state().command
        return None if command is None else command.identifier

    def _end(self, status: Status) -> bytes:
        request, self._running = self._running, None
        return b"" if request is None else self._say(request, status)
