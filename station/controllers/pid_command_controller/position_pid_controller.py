"""Hold positions with one PID per joint, whatever its output commands.

Source: ros_controllers@678b92a effort_controllers/src/
joint_group_position_controller.cpp, joint_position_controller.cpp.
"""

from collections.abc import Mapping
from math import pi
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller.joint_quantity import JointQuantity
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
    JointSetPointController,
)
from station.controllers.pid_command_controller.joint_pids import (
    JointPids,
    read_joint_pids,
)
from station.core.angles import (
    shortest_angular_distance,
    shortest_angular_distance_with_limits,
)
from station.core.controller import ControllerSample
from station.core.parameters import Parameters
from station.core.robot_description import (
    JointDescription,
    JointType,
    RobotDescription,
    require_robot_description,
)
from station.core.tunables import Tunable


class PositionPidController(JointSetPointController[CommandInterfaceT]):
    """Computes a command from the position error of every joint.

    A continuous joint turns the short way round, a revolute one the short way that
    stays within its limits. The limits come from the robot description.

    Attributes:
        command_quantity: What the PIDs compute.

    Source:
        JointGroupPositionController; differs: a set-point beyond the limits is refused
        at the door and clamped only if it was posted unchecked; a joint that starts
        beyond its limits is held there and not driven back on its own.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION
    command_quantity: ClassVar[JointQuantity]

    def __init__(self) -> None:
        super().__init__()
        self._pids = JointPids(
            [], [], error=JointQuantity.POSITION, command=JointQuantity.EFFORT
        )
        self._turns: list[bool] = []

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        self._turns = [not joint.is_linear() for joint in self.joints]
        self._pids = JointPids(
            self.joints,
            read_joint_pids(params, self.joints),
            error=JointQuantity.POSITION,
            command=self.command_quantity,
        )

    @override
    def find_description(self, params: Parameters) -> RobotDescription | None:
        """Return the robot description, without which this controller is not safe.

        Raises:
            RobotDescriptionError: There is none, or it cannot be used.
        """
        return require_robot_description(params)

    @override
    def starting(self, time: float) -> None:
        super().starting(time)
        self._pids.reset()

    @override
    def update(self, time: float, period: float) -> None:
        set_point = self.newest_set_point()
        positions = self.group.get_positions()
        errors = [d - a for d, a in zip(set_point, positions, strict=True)]
        for index, error in enumerate(errors):
            if not -pi <= error <= pi and self._turns[index]:
                errors[index] = position_error(
                    self.joints[index], positions[index], set_point[index]
                )
        commands = self._pids.compute_commands(errors, period)
        self.group.set_commands(commands)
        self.sample = ControllerSample(time, set_point, positions, errors, commands)

    @override
    def gain_schema(self) -> Mapping[str, Tunable]:
        return self._pids.gain_schema()

    @override
    def gains(self) -> dict[str, float]:
        return self._pids.gains()

    @override
    def check_gains(self, values: Mapping[str, float]) -> None:
        self._pids.check_gains(values)

    @override
    def apply_gains(self, values: Mapping[str, float]) -> None:
        self._pids.apply_gains(values)


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
