"""Control the position or the velocity of joints by one PID loop around each of them.

Source: ros_controllers@678b92a effort_controllers/src/
joint_group_position_controller.cpp, joint_position_controller.cpp,
joint_velocity_controller.cpp, velocity_controllers/src/joint_position_controller.cpp.
"""

from collections.abc import Mapping
from math import pi
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import (
    CommandInterfaceT,
    JointQuantity,
    JointSetPointController,
)
from station.controllers.pid_command_controller.joint_pid_group import (
    JointPidGroup,
    read_pid_gains,
)
from station.core.control.controller import ControllerSample
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.numerics.angles import (
    shortest_angular_distance,
    shortest_angular_distance_with_limits,
)
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement


class JointPidController(JointSetPointController[CommandInterfaceT]):
    """Commands what one PID per joint computes from the error of the set-point.

    The error of a position is the way that the joint can go, see `position_error`; the
    limits come from the robot description, without which positions are not controlled.
    A set-point of positions may include velocities; the derivative gain then acts on
    the difference to these velocities.

    Parameters: those of the base class, and the gains of every joint, see
    `read_pid_gains`.

    Attributes:
        quantity: What is controlled: the unit of set-points, measurements and errors.
        command_quantity: What the PIDs compute.

    Source:
        JointGroupPositionController; differs: a set-point beyond the limits is refused
        when it is posted, and clamped only if it was posted unchecked; a joint that
        starts beyond its limits is held there and not driven back.
    """

    command_quantity: ClassVar[JointQuantity]
    _pids: JointPidGroup
    _period: float

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        self._pids = JointPidGroup(
            self.joints,
            read_pid_gains(params, self.joints),
            error=self.quantity,
            command=self.command_quantity,
        )
        self._period = 0.0
        self.tunables = self._pids.tunables
        if self.quantity is JointQuantity.POSITION and self.set_points is not None:
            velocity = JointQuantity.VELOCITY
            self.set_points.feed_forward = [
                SetPointElement(each.name, velocity.unit(each), *velocity.range(each))
                for each in self.joints
            ]

    @override
    def starting(self, time: float) -> None:
        super().starting(time)
        self._pids.reset()

    @override
    def update(self, time: float, period: float) -> None:
        set_point = self.newest_set_point()
        actual = self.quantity.measure(self.group)
        errors = [d - a for d, a in zip(set_point, actual, strict=True)]
        if self.quantity is JointQuantity.POSITION:
            for index, error in enumerate(errors):
                # Only beyond half a turn can the way of a joint differ from the error.
                if not -pi <= error <= pi:
                    errors[index] = position_error(
                        self.joints[index], actual[index], set_point[index]
                    )
        rates = self._watched.rates
        if rates:
            measured = self.group.get_velocities()
            missing = [d - a for d, a in zip(rates, measured, strict=True)]
            commands = self._pids.compute_commands_with_rates(errors, missing, period)
        else:
            commands = self._pids.compute_commands(errors, period)
        self.group.set_commands(commands)
        self._period = period
        self.sample = ControllerSample(time, set_point, actual, errors, commands)

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `state`: numbers, or for a group lists in joint order.

        Source:
            control_msgs@1.5.2 msg/JointControllerState.msg; differs: a group of joints
            publishes its state, too.
        """
        sample = self.sample
        if sample is None:
            return {}
        columns: dict[str, list[float] | list[bool]] = {
            "set_point": sample.desired,
            "process_value": sample.actual,
            "error": sample.error,
            "command": sample.output,
            **self._pids.columns(),
        }
        common = {"stamp": sample.stamp, "time_step": self._period}
        if self.is_group:
            return {"state": {**common, "joint_names": self.joint_names, **columns}}
        return {"state": {**common, **{key: each[0] for key, each in columns.items()}}}


def position_error(joint: JointDescription, measured: float, set_point: float) -> float:
    """Return the signed way from a measured position to a set-point.

    A continuous joint takes the shorter of the two ways round, a revolute joint the
    shortest way that stays within its limits.

    Args:
        joint: Type and limits of the joint.
        measured: Measured position [rad or m].
        set_point: Desired position within the limits [rad or m].

    Returns:
        The way [rad or m]; NaN when a position is not finite.
    """
    if joint.type is JointType.CONTINUOUS:
        return shortest_angular_distance(measured, set_point)
    if joint.type is JointType.REVOLUTE:
        return shortest_angular_distance_with_limits(
            measured, set_point, joint.lower, joint.upper
        )
    return set_point - measured
