"""The base of all controllers that follow one set-point per joint."""

from math import inf
from typing import ClassVar, TypeVar

from typing_extensions import override

from station.controllers.forward_command_controller.command_timeout import (
    TimeoutAction,
    read_command_timeout,
)
from station.controllers.forward_command_controller.joint_names import (
    read_joint_name,
    read_joint_names,
)
from station.controllers.forward_command_controller.joint_quantity import JointQuantity
from station.core.controller import Controller
from station.core.errors import CommandTimeoutError
from station.core.interfaces import JointCommandInterface, JointGroup
from station.core.parameters import Parameters
from station.core.robot_description import (
    JointDescription,
    RobotDescription,
    find_robot_description,
)
from station.core.set_point import SetPointElement, SetPointPort

CommandInterfaceT = TypeVar("CommandInterfaceT", bound=JointCommandInterface)


class JointSetPointController(Controller[CommandInterfaceT]):
    """Claims joints and keeps the set-point in force for each of them.

    Subclasses declare the class attributes and implement `update`, in which they
    call `newest_set_point` once. When the controller starts, the set-point is rest: the
    present position, or zero for velocities and efforts; what was posted before the
    start is void.

    Parameters: `command_timeout` and `command_timeout_action`, see `TimeoutAction`.

    Ranges and units of the set-points come from the robot description when there is
    one; without it the joints count as unlimited and turning.

    Attributes:
        quantity: What the set-points are.
        is_group: Whether the parameter `joints` names the joints, or `joint` one.
        default_timeout: Value of `command_timeout` when it is absent [s].
        longest_timeout: Longest validity of a set-point [s]; when it is finite, every
            set-point ends by itself.
        group: The joints.
        joints: What is known about them, same order.
        rates: How fast the set-point in force changes, shape (n,); empty when unknown.
    """

    quantity: ClassVar[JointQuantity]
    is_group: ClassVar[bool] = True
    default_timeout: ClassVar[float] = 0.0
    longest_timeout: ClassVar[float] = inf

    def __init__(self) -> None:
        super().__init__()
        self.group = JointGroup([])
        self.joints: list[JointDescription] = []
        self._port = SetPointPort([])
        self._timeout_action = TimeoutAction.HOLD
        self._set_point: list[float] = []
        self.rates: list[float] = []

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        read = read_joint_names if self.is_group else read_joint_name
        self.joint_names = read(params)
        self.group = JointGroup([interface.get_handle(n) for n in self.joint_names])
        description = self.find_description(params)
        self.joints = [
            JointDescription(name) if description is None else description.joint(name)
            for name in self.joint_names
        ]
        timeout, self._timeout_action = read_command_timeout(
            params, self.default_timeout, longest=self.longest_timeout
        )
        self._port = SetPointPort(
            [self._element(joint) for joint in self.joints],
            timeout=timeout,
            longest=self.longest_timeout,
        )
        self.set_points = self._port

    def find_description(self, params: Parameters) -> RobotDescription | None:
        """Return the robot description; None when the controller can do without.

        Raises:
            RobotDescriptionError: The description cannot be used.
        """
        return find_robot_description(params)

    def rest(self) -> list[float]:
        """Return the set-point that lets the joints rest where they are, shape (n,)."""
        if self.quantity is JointQuantity.POSITION:
            return self.group.get_positions()
        return [0.0] * len(self.joints)

    def newest_set_point(self) -> list[float]:
        """Return the set-point in force, shape (n,); never change the list.

        It is kept within the joints' limits, whoever posted it. When it is no longer
        valid, or was made void by a stop, a reset or a recovery, rest takes its place.

        Raises:
            CommandTimeoutError: It is no longer valid and the action is `stop`.
        """
        if self._port.take_void():
            self._set_point, self.rates = self.rest(), []
        newest = self._port.take()
        if newest is not None:
            # The rates follow the values, if there are any.
            self._set_point = [
                min(max(value, element.minimum), element.maximum)
                for value, element in zip(newest, self._port.elements, strict=False)
            ]
            self.rates = newest[len(self._set_point) :]
        if self._port.take_expiry():
            self._set_point, self.rates = self._timed_out(), []
        return self._set_point

    def _timed_out(self) -> list[float]:
        if self._timeout_action is TimeoutAction.STOP:
            raise CommandTimeoutError(
                f"No set-point for {', '.join(self.joint_names)} arrived in time.",
                remedy="Start the controller again and send set-points at a faster "
                "pace than its timeout.",
            )
        rest = self.rest()
        self._port.last = rest
        return rest

    @override
    def starting(self, time: float) -> None:
        self._set_point, self.rates = self.rest(), []

    def _element(self, joint: JointDescription) -> SetPointElement:
        lower, upper = self.quantity.range(joint)
        return SetPointElement(joint.name, self.quantity.unit(joint), lower, upper)
