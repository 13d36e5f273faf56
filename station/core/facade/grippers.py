"""The hands of the arms, for any thread: homing, move, grasp, stop, state.

Nothing here waits for the fingers: a command begins between two cycles, and the state
tells how far it is.
"""

from collections.abc import Callable, Iterable

from station.core.errors import ArmNotFoundError, GripperNotFoundError
from station.core.franka import (
    DEFAULT_SPEED,
    GraspRequest,
    GripperServices,
    GripperServicesInterface,
    GripperState,
)
from station.core.loop.control_loop import ControlLoop


class Grippers:
    """The hands of one station's arms.

    Args:
        loop: The loop.
        arm_ids: All arms, with or without a hand.
    """

    def __init__(self, loop: ControlLoop, arm_ids: Iterable[str]) -> None:
        self._loop = loop
        found = loop.hw.get(GripperServicesInterface)
        hands = found.handles() if found else []
        self._hands: dict[str, GripperServices] = {hand.name: hand for hand in hands}
        self._arm_ids = frozenset(arm_ids)

    def state(self, arm_id: str) -> GripperState:
        """Return the state of an arm's hand.

        Raises:
            ArmNotFoundError: There is no such arm.
            GripperNotFoundError: It has no hand.
            LoopError: The loop died or hangs.
        """
        hand = self._find(arm_id)
        return self._loop.run_in_cycle(hand.get_state)

    def homing(self, arm_id: str) -> GripperState:
        """Begin to close and to open a hand all the way; see `GripperServices`.

        Raises:
            ArmNotFoundError: There is no such arm.
            GripperNotFoundError: It has no hand.
            GripperCommandError: A controller claims the fingers.
            StoppedError: The station is stopped.
            LoopError: The loop died or hangs.
        """
        return self._do(arm_id, lambda hand: hand.homing())

    def move(
        self, arm_id: str, width: float, speed: float = DEFAULT_SPEED
    ) -> GripperState:
        """Begin to open or close a hand to a width; see `GripperServices`.

        Args:
            arm_id: The arm.
            width: [m].
            speed: How fast the width changes [m/s].

        Raises:
            ArmNotFoundError: There is no such arm.
            GripperNotFoundError: It has no hand.
            GripperCommandError: A controller claims the fingers.
            InvalidCommandError: A number is out of range.
            StoppedError: The station is stopped.
            LoopError: The loop died or hangs.
        """
        return self._do(arm_id, lambda hand: hand.move(width, speed))

    def grasp(self, arm_id: str, request: GraspRequest) -> GripperState:
        """Begin to grasp something; see `GripperServices`.

        Args:
            arm_id: The arm.
            request: What to grasp.

        Raises:
            ArmNotFoundError: There is no such arm.
            GripperNotFoundError: It has no hand.
            GripperCommandError: A controller claims the fingers.
            InvalidCommandError: A number is out of range.
            StoppedError: The station is stopped.
            LoopError: The loop died or hangs.
        """
        return self._do(arm_id, lambda hand: hand.grasp(request))

    def stop(self, arm_id: str) -> GripperState:
        """Let a hand stand still and press no more, also while the station is stopped.

        Raises:
            ArmNotFoundError: There is no such arm.
            GripperNotFoundError: It has no hand.
            LoopError: The loop died or hangs.
        """
        return self._do(arm_id, lambda hand: hand.stop(), moves=False)

    def _do(
        self,
        arm_id: str,
        action: Callable[[GripperServices], None],
        *,
        moves: bool = True,
    ) -> GripperState:
        hand = self._find(arm_id)

        def act() -> GripperState:
            if moves:  # here, for a stop may have come since it was asked for
                self._loop.stop_latch.check()
            action(hand)
            return hand.get_state()

        return self._loop.run_in_cycle(act)

    def _find(self, arm_id: str) -> GripperServices:
        hand = self._hands.get(arm_id)
        if hand is not None:
            return hand
        if arm_id in self._arm_ids:
            raise GripperNotFoundError(
                f"Arm '{arm_id}' has no gripper.",
                remedy=f"These arms have one: {', '.join(self._hands) or 'none'}.",
                details={"arm_id": arm_id},
            )
        raise ArmNotFoundError(
            f"There is no arm '{arm_id}'.",
            remedy=f"The arms are: {', '.join(sorted(self._arm_ids)) or 'none'}.",
            details={"arm_id": arm_id},
        )
