"""The hand of a real arm: the services of franka_gripper over a network.

Source: franka_ros@c11f000 franka_gripper/src/franka_gripper.cpp; libfranka@0.9.2
src/gripper.cpp, also for the words of refusals; differs: a command begins at once, and
a newer one ends it.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from math import nan
from typing import Any

from typing_extensions import override

from station.core.errors import GripperLostError
from station.core.franka import (
    DEFAULT_SPEED,
    GraspRequest,
    GripperAction,
    GripperActivity,
    GripperServices,
    GripperState,
)
from station.core.hardware.interfaces import JointStateHandle, JointStateInterface
from station.core.ports.goal import GoalStatus
from station.hw.franka.fci.driver.hand_link import HandLink, HandOrder
from station.hw.franka.fci.wire.gripper_protocol import HandCommand
from station.hw.franka.fci.wire.robot_protocol import Status
from station.hw.franka.hand.hand_limits import OPEN_WIDTH, check_grasp, check_move
from station.hw.franka.hand.hand_services import HandCommands
from station.memory.doubles import Block

_ACTIVITIES = {
    GripperAction.HOMING: GripperActivity.HOMING,
    GripperAction.MOVE: GripperActivity.MOVING,
    GripperAction.GRASP: GripperActivity.GRASPING,
}
_GRASPED = GripperAction.GRASP, GoalStatus.SUCCEEDED
_MILLISECOND = 0.001
_FAILURES = {
    Status.FAIL: "libfranka gripper: Command failed!",
    Status.ABORTED: "libfranka gripper: Command aborted!",
}


class RealHand(GripperServices):
    """The hand of one arm. Control thread only, between two cycles.

    Args:
        arm_id: The arm with this hand.
        link: The link to the hand; its owner starts it.
    """

    def __init__(self, arm_id: str, link: HandLink) -> None:
        super().__init__(arm_id)
        self._link = link
        self._fingers = Block({"q": 2, "none": 2})
        self._commands = HandCommands(self._time)
        self._order: HandOrder | None = None  # of the newest command
        link.on_state = self._note_width

    def register(self, interfaces: Iterable[object], names: Sequence[str]) -> None:
        """Add the fingers to the joint states, as franka_gripper publishes them.

        Each finger is at half of the width, and has no velocity and no effort.

        Args:
            interfaces: The interfaces of the arm; other kinds do not change.
            names: Names of the two joints.
        """
        q, none = self._fingers["q"], self._fingers["none"]
        for interface in interfaces:
            if type(interface) is JointStateInterface:
                for index, name in enumerate(names):
                    handle = JointStateHandle(name, q, none, none, index)
                    interface.register_handle(handle)

    def close(self) -> None:
        """Close the connection."""
        self._link.close()

    @override
    def get_state(self) -> GripperState:
        state = self._check_connected()
        self._take_outcome()
        return GripperState(
            width=state["width"],
            max_width=state["max_width"],
            is_grasped=state["is_grasped"],
            temperature=float(state["temperature"]),
            time=state["message_id"] * _MILLISECOND,
            activity=self._activity(is_grasped=state["is_grasped"]),
            force=nan,  # the protocol does not tell it
            command=self._commands.present,
            last=self._commands.last,
        )

    @override
    def homing(self) -> None:
        self._begin(GripperAction.HOMING, HandCommand.HOMING, {})

    @override
    def move(self, width: float, speed: float = DEFAULT_SPEED) -> None:
        check_move(self.name, width, speed, OPEN_WIDTH)
        request = {"width": width, "speed": speed}
        self._begin(GripperAction.MOVE, HandCommand.MOVE, request)

    @override
    def grasp(self, request: GraspRequest) -> None:
        check_grasp(self.name, request, OPEN_WIDTH)
        self._begin(GripperAction.GRASP, HandCommand.GRASP, asdict(request))

    @override
    def stop(self) -> None:
        self._check_connected()
        self._stop("The gripper was told to stop.")

    @override
    def interrupt(self, reason: str) -> None:
        self._take_outcome()
        if self._commands.present is not None:
            self._stop(reason)

    def _stop(self, reason: str) -> None:
        self._take_outcome()
        self._commands.end(GoalStatus.PREEMPTED, reason)
        self._link.order(HandOrder(HandCommand.STOP, {}))

    def _begin(
        self, action: GripperAction, command: HandCommand, request: dict[str, float]
    ) -> None:
        self._check_connected()
        self._take_outcome()
        self._commands.begin(action, request)
        self._order = HandOrder(command, request)
        self._link.order(self._order)

    def _take_outcome(self) -> None:
        """Note the end of the present command, if it has ended."""
        outcome = None if self._order is None else self._order.outcome
        if outcome is Status.SUCCESS:
            self._commands.end(GoalStatus.SUCCEEDED, "")
        elif outcome is not None:
            self._commands.end(GoalStatus.ABORTED, self._failure(outcome))

    def _failure(self, outcome: Status | str) -> str:
        """Return the reason why a command did not succeed."""
        if isinstance(outcome, str):
            return f"The hand was lost: {outcome.rstrip('.')}."
        if outcome is Status.UNSUCCESSFUL:
            state = self._link.state
            where = "" if state is None else f" at {state['width']:.4f} m"
            return f"The fingers came to rest{where}, where they should not."
        said = "libfranka gripper: Unexpected response while handling command!"
        return _FAILURES.get(outcome, said)

    def _activity(self, *, is_grasped: bool) -> GripperActivity:
        if self._commands.present is not None:
            return _ACTIVITIES[self._commands.present.action]
        last = self._commands.last
        is_held = last is not None and (last.action, last.status) == _GRASPED
        holds = is_grasped and is_held
        return GripperActivity.HOLDING if holds else GripperActivity.IDLE

    def _time(self) -> float:
        state = self._link.state
        return 0.0 if state is None else state["message_id"] * _MILLISECOND

    def _check_connected(self) -> Mapping[str, Any]:
        """Return the newest state of the hand.

        Raises:
            GripperLostError: The hand is absent or lost.
        """
        problem, state = self._link.problem, self._link.state
        if problem is not None or state is None:
            why = (problem or "its first state has not come").rstrip(".")
            raise GripperLostError(
                f"The hand of arm '{self.name}' is not connected: {why}.",
                remedy="Mount the hand, choose it as end effector in Desk, and end "
                "other programs that use it; the station tries again every 2 s.",
                details={"arm_id": self.name},
            )
        return state

    def _note_width(self, state: Mapping[str, Any]) -> None:
        """Write the positions of the fingers, which the thread of the link reports."""
        q = self._fingers["q"]
        q[0] = q[1] = state["width"] / 2.0
