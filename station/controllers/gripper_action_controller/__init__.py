"""Open and close grippers with one joint by goals."""

from station.controllers.gripper_action_controller.gripper_action_controller import (
    EffortGripperActionController as EffortGripperActionController,
    GripperActionController as GripperActionController,
    ParallelGripperActionController as ParallelGripperActionController,
    PositionGripperActionController as PositionGripperActionController,
)
