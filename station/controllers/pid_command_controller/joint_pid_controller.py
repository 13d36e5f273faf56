"""Control the position or the velocity of joints by one PID loop around each of them.

Source: ros_controllers@678b92a effort_controllers/src/
joint_group_position_controller.cpp, joint_position_controller.cpp,
joint_velocity_controller.cpp, velocity_controllers/src/joint_position_controller.cpp.
"""

from collections.abc import Mapping
from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import (
    CommandInterfaceT,
    JointQuantity,
    JointSetPointController,
)
from station.controllers.forward_command_controller.set_point_update import (
    SetPointPidLaw,
)
from station.controllers.pid_command_controller.joint_pid_group import (
    JointPidGroup,
    pid_parameters,
    read_pid_gains,
)
from station.core.declared_parameter import DeclaredParameter
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.numerics.joint_errors import BOUNDED, CONTINUOUS, PLAIN, JointErrors
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement


class JointPidController(JointSetPointController[CommandInterfaceT]):
    """Commands what one PID per joint computes from the error of the set-point.

    The error of a position is the way that the joint can go, see `set_ways`; the
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

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (
            *super().declared_parameters(),
            *pid_parameters(error=cls.quantity, command=cls.command_quantity),
        )

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        self._pids = JointPidGroup(
            self.joints,
            read_pid_gains(params, self.joints),
            error=self.quantity,
            command=self.command_quantity,
            commands=self.memory.commands,
        )
        desired, actual = self._watched.desired, self.quantity.measured(self.memory)
        errors = JointErrors(desired, actual, self._pids.errors)
        rate_errors = JointErrors(
            self._watched.desired_rates, self.memory.velocities, self._pids.rates
        )
        if self.quantity is JointQuantity.POSITION:
            set_ways(errors, self.joints)
        self.follow_by(
            SetPointPidLaw(self._watched, errors, rate_errors, self._pids.group),
            (desired, actual, self._pids.errors, self.memory.commands),
        )
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
        common = {"stamp": sample.stamp, "time_step": self._following.period}
        if self.is_group:
            return {"state": {**common, "joint_names": self.joint_names, **columns}}
        return {"state": {**common, **{key: each[0] for key, each in columns.items()}}}


def set_ways(errors: JointErrors, joints: list[JointDescription]) -> None:
    """Let the errors of positions be the ways that the joints can go.

    A continuous joint takes the shorter of the two ways round, a revolute joint the
    shortest way that stays within its limits.

    Args:
        errors: Compares the positions of the joints.
        joints: The joints, in the same order.
    """
    ways = {JointType.CONTINUOUS: CONTINUOUS, JointType.REVOLUTE: BOUNDED}
    for index, joint in enumerate(joints):
        way = ways.get(joint.type, PLAIN)
        errors.set_way(index, way, joint.lower, joint.upper)
