"""The grippers of a station, by the arm that has them."""

from collections.abc import Callable

from station.core.errors import GripperNotFoundError
from station.core.facade.robots import Robots
from station.core.franka.gripper_services import (
    DEFAULT_SPEED,
    GraspRequest,
    GripperServices,
    GripperState,
)


class Grippers:
    """The grippers of one station's arms.

    No method waits for the fingers: a command begins between two cycles, and the state
    shows its progress.

    Every method raises `ArmNotFoundError` if there is no such arm,
    `GripperNotFoundError` if the arm has no gripper, and `LoopError` if the loop died
    or hangs. Every command but `stop` raises `StoppedError` while the station is
    stopped, and the errors of the same method of `GripperServices`.

    Args:
        robots: The robots of the station.
    """

    def __init__(self, robots: Robots) -> None:
        self._robots = robots

    def state(self, arm_id: str) -> GripperState:
        """Return the state of a gripper."""
        return self._robots.run(self._find(arm_id).get_state)

    def homing(self, arm_id: str) -> GripperState:
        """Begin to close and then open a gripper all the way."""
        return self._begin(arm_id, lambda gripper: gripper.homing())

    def move(
        self, arm_id: str, width: float, speed: float = DEFAULT_SPEED
    ) -> GripperState:
        """Begin to open or close a gripper to a width [m], at a speed [m/s]."""
        return self._begin(arm_id, lambda gripper: gripper.move(width, speed))

    def grasp(self, arm_id: str, request: GraspRequest) -> GripperState:
        """Begin to grasp an object."""
        return self._begin(arm_id, lambda gripper: gripper.grasp(request))

    def stop(self, arm_id: str) -> GripperState:
        """Hold the fingers still without force; works while the station is stopped."""
        return self._begin(arm_id, lambda gripper: gripper.stop(), moves=False)

    def _begin(
        self,
        arm_id: str,
        command: Callable[[GripperServices], None],
        *,
        moves: bool = True,
    ) -> GripperState:
        gripper = self._find(arm_id)

        def begin() -> GripperState:
            command(gripper)
            return gripper.get_state()

        return self._robots.run(begin, moves=moves)

    def _find(self, arm_id: str) -> GripperServices:
        kind: type[GripperServices] = GripperServices  # type: ignore[type-abstract]
        gripper = self._robots.get(arm_id, kind)
        if gripper is None:
            having = ", ".join(self._robots.names(GripperServices)) or "none"
            raise GripperNotFoundError(
                f"Arm '{arm_id}' has no gripper.",
                remedy=f"These arms have a gripper: {having}.",
                details={"arm_id": arm_id},
            )
        return gripper
