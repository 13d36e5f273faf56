"""Hold positions with one PID per joint, whatever its output commands.

Source: ros_controllers@678b92a effort_controllers/src/
joint_group_position_controller.cpp, joint_position_controller.cpp,
velocity_controllers/src/joint_position_controller.cpp.
"""

from math import pi
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller.joint_quantity import JointQuantity
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
)
from station.controllers.pid_command_controller.joint_pid_controller import (
    JointPidController,
)
from station.core.description.robot_description import (
    JointDescription,
    RobotDescription,
    require_robot_description,
)
from station.core.description.urdf import JointType
from station.core.numerics.angles import (
    shortest_angular_distance,
    shortest_angular_distance_with_limits,
)
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement


class PositionPidController(JointPidController[CommandInterfaceT]):
    """Computes a command from the position error of every joint.

    A continuous joint turns the short way round, a revolute one the short way that
    stays within its limits. The limits come from the robot description. A set-point
    may say how fast it changes; the derivative gain then acts on what is missing to
    that velocity.

    Source:
        JointGroupPositionController; differs: a set-point beyond the limits is refused
        at the door and clamped only if it was posted unchecked; a joint that starts
        beyond its limits is held there and not driven back on its own.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION

    @override
    def find_description(self, params: Parameters) -> RobotDescription | None:
        """Return the robot description, without which this controller is not safe.

        Raises:
            RobotDescriptionError: There is none, or it cannot be used.
        """
        return require_robot_description(params)

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        """Take velocities with the positions, too, as the original's setCommand."""
        super().init(interface, params)
        velocity = JointQuantity.VELOCITY
        if self.set_points is not None:
            self.set_points.feed_forward = [
                SetPointElement(each.name, velocity.unit(each), *velocity.range(each))
                for each in self.joints
            ]

    @override
    def errors(self, set_point: list[float], actual: list[float]) -> list[float]:
        """Return the ways from the positions to the set-point, shape (n,)."""
        errors = [d - a for d, a in zip(set_point, actual, strict=True)]
        for index, error in enumerate(errors):
            if not -pi <= error <= pi:
                errors[index] = position_error(
                    self.joints[index], actual[index], set_point[index]
                )
        return errors


def position_error(joint: JointDescription, measured: float, set_point: float) -> float:
    """Return the way from a measured position to a set-point, as the joint can go it.

    Args:
        joint: The joint.
        measured: Its position [rad or m].
        set_point: Where it shall be, within its limits [rad or m].

    Returns:
        The difference [rad or m]; NaN when a position is not finite.
    """
    if joint.type is JointType.CONTINUOUS:
        return shortest_angular_distance(measured, set_point)
    if joint.type is JointType.REVOLUTE:
        return shortest_angular_distance_with_limits(
            measured, set_point, joint.lower, joint.upper
        )
    return set_point - measured
