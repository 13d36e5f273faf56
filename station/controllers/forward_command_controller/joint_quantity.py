"""The quantities of a joint: position, velocity and effort."""

from enum import Enum
from typing import assert_never

from station.controllers.forward_command_controller.controlled_joints import (
    ControlledJoints,
)
from station.core.description.robot_description import JointDescription
from station.memory.doubles import Doubles


class JointQuantity(Enum):
    """A quantity that is measured and commanded at a joint."""

    POSITION = "position"
    VELOCITY = "velocity"
    EFFORT = "effort"

    def unit(self, joint: JointDescription) -> str:
        """Return the unit of the quantity at `joint`."""
        match self:
            case JointQuantity.POSITION:
                return "m" if joint.is_linear() else "rad"
            case JointQuantity.VELOCITY:
                return "m/s" if joint.is_linear() else "rad/s"
            case JointQuantity.EFFORT:
                return "N" if joint.is_linear() else "Nm"
            case _:
                assert_never(self)

    def range(self, joint: JointDescription) -> tuple[float, float]:
        """Return the smallest and the largest value allowed at `joint`."""
        match self:
            case JointQuantity.POSITION:
                return joint.lower, joint.upper
            case JointQuantity.VELOCITY:
                return -joint.velocity, joint.velocity
            case JointQuantity.EFFORT:
                return -joint.effort, joint.effort
            case _:
                assert_never(self)

    def measured(self, memory: ControlledJoints) -> Doubles:
        """Return the measured values of joints, shape (n,), not a copy."""
        if self is JointQuantity.POSITION:
            return memory.positions
        if self is JointQuantity.VELOCITY:
            return memory.velocities
        return memory.efforts
