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
from station.controllers.forward_command_controller.watched_set_point import (
    WatchedSetPoint,
)
from station.core.control.controller import Controller
from station.core.description.robot_description import (
    JointDescription,
    RobotDescription,
    find_robot_description,
)
from station.core.hardware.interfaces import JointCommandInterface, JointGroup
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement, SetPointPort

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
    """

    quantity: ClassVar[JointQuantity]
    is_group: ClassVar[bool] = True
    default_timeout: ClassVar[float] = 0.0
    longest_timeout: ClassVar[float] = inf

    def __init__(self) -> None:
        super().__init__()
        self.group = JointGroup([])
        self.joints: list[JointDescription] = []
        self._watched = WatchedSetPoint(
            SetPointPort([]), TimeoutAction.HOLD, "", self.rest
        )

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
        timeout, action = read_command_timeout(
            params, self.default_timeout, longest=self.longest_timeout
        )
        self.set_points = SetPointPort(
            [self._element(joint) for joint in self.joints],
            timeout=timeout,
            longest=self.longest_timeout,
        )
        self._watched = WatchedSetPoint(
            self.set_points, action, ", ".join(self.joint_names), self.rest
        )

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
        """Return the set-point in force, see `WatchedSetPoint.newest`.

        Raises:
            CommandTimeoutError: It is no longer valid and the action is `stop`.
        """
        return self._watched.newest()

    @property
    def rates(self) -> list[float]:
        """How fast the set-point in force changes, shape (n,); empty when unknown."""
        return self._watched.rates

    @override
    def starting(self, time: float) -> None:
        self._watched.begin()

    def _element(self, joint: JointDescription) -> SetPointElement:
        lower, upper = self.quantity.range(joint)
        return SetPointElement(joint.name, self.quantity.unit(joint), lower, upper)
