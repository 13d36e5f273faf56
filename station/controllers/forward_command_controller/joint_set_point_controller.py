"""The base of all controllers that follow one set-point per joint."""

from math import inf
from typing import ClassVar, TypeVar

from typing_extensions import override

from station.controllers.forward_command_controller.command_laws import CommandLaw
from station.controllers.forward_command_controller.command_timeout import (
    read_command_timeout,
    timeout_parameters,
)
from station.controllers.forward_command_controller.controlled_joints import (
    ControlledJoints,
)
from station.controllers.forward_command_controller.joint_names import (
    JOINT,
    JOINTS,
    read_joint_names,
)
from station.controllers.forward_command_controller.joint_quantity import JointQuantity
from station.controllers.forward_command_controller.set_point_update import (
    SetPointUpdate,
)
from station.controllers.forward_command_controller.watched_set_point import (
    WatchedSetPoint,
)
from station.core.control.controller import Controller
from station.core.control.sample_columns import SampleColumns
from station.core.control.usual_update import UsualUpdate
from station.core.declared_parameter import DeclaredParameter
from station.core.description.robot_description import (
    JointDescription,
    find_robot_description,
    require_robot_description,
)
from station.core.hardware.interfaces import JointCommandInterface, JointGroup
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.memory.doubles import Doubles

CommandInterfaceT = TypeVar("CommandInterfaceT", bound=JointCommandInterface)


class JointSetPointController(Controller[CommandInterfaceT]):
    """Claims joints and keeps the set-point in force for each of them.

    A subclass declares the class attributes. In `init` it calls `follow_by`, or else it
    overrides `update`, which calls `newest_set_point` exactly once per cycle. When the
    controller starts, the set-point is rest: the present position, or zero for
    velocities and efforts. Set-points that were posted before the start are void.

    Parameters: `joints` or `joint`, see `is_group`; `command_timeout` and
    `command_timeout_action`, see `TimeoutAction`. Ranges and units of the set-points
    come from `robot_description` in this or an outer namespace; without a description
    the joints count as unlimited and rotating.

    Attributes:
        quantity: What the numbers of a set-point are.
        is_group: Whether the parameter `joints` lists several joints; if not, the
            parameter `joint` names one.
        needs_description: Whether loading fails without a robot description.
        default_timeout: Value of `command_timeout` when it is absent [s].
        longest_timeout: Longest validity of a set-point [s]; when it is finite, every
            set-point expires.
        group: Handles of the joints.
        memory: Their values as doubles.
        joints: Descriptions of the joints, in the same order.
    """

    quantity: ClassVar[JointQuantity]
    is_group: ClassVar[bool] = True
    needs_description: ClassVar[bool] = False
    default_timeout: ClassVar[float] = 0.0
    longest_timeout: ClassVar[float] = inf
    group: JointGroup
    memory: ControlledJoints
    joints: list[JointDescription]
    _watched: WatchedSetPoint
    _following: SetPointUpdate

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (
            *super().declared_parameters(),
            JOINTS if cls.is_group else JOINT,
            *timeout_parameters(cls.default_timeout, longest=cls.longest_timeout),
        )

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        self.joint_names = (
            read_joint_names(params) if self.is_group else [JOINT.read_str(params)]
        )
        self.group = JointGroup([interface.get_handle(n) for n in self.joint_names])
        self.memory = ControlledJoints(self.group)
        find = (
            require_robot_description
            if self.needs_description
            else find_robot_description
        )
        description = find(params)
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

    def rest(self) -> list[float]:
        """Return the set-point at which the joints rest where they are, shape (n,)."""
        if self.quantity is JointQuantity.POSITION:
            return self.group.get_positions()
        return [0.0] * len(self.joints)

    def newest_set_point(self) -> list[float]:
        """Return the set-point in force, shape (n,); see `WatchedSetPoint.newest`.

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        return self._watched.newest()

    @property
    def rates(self) -> list[float]:
        """Rates at which the set-point in force changes, shape (n,); empty if unknown.

        In the unit of the set-point per second.
        """
        return self._watched.rates

    def follow_by(self, law: CommandLaw, columns: tuple[Doubles, ...]) -> None:
        """Let a law of the kernel follow the set-point.

        Args:
            law: Computes the commands from `memory` and the set-point in force.
            columns: The columns of the sample, shape (n,) each.
        """
        self.sampled = SampleColumns(columns)
        self._following = SetPointUpdate(self._watched, law, self.sampled)

    @override
    def usual_update(self) -> UsualUpdate | None:
        return None if self.memory.is_copy else self._following

    @override
    def update(self, time: float, period: float) -> None:
        self._watched.newest()
        if self.memory.is_copy:
            self.memory.read()
        self._following.follow(time, period)
        if self.memory.is_copy:
            self.memory.write()

    @override
    def starting(self, time: float) -> None:
        self._watched.begin()

    def _element(self, joint: JointDescription) -> SetPointElement:
        lower, upper = self.quantity.range(joint)
        return SetPointElement(joint.name, self.quantity.unit(joint), lower, upper)
