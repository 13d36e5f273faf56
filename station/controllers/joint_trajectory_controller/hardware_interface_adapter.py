"""Write desired joint states to each kind of command interface.

Source: ros_controllers@678b92a joint_trajectory_controller/
hardware_interface_adapter.h.
"""

from collections.abc import Callable  # noqa: TC003 - a native attribute
from dataclasses import replace

from typing_extensions import override

from station.controllers.joint_trajectory_controller.joint_tracking import (
    JointTracking,
)
from station.controllers.joint_trajectory_controller.trajectory_update import (
    FeedForwardPidLaw,
)
from station.controllers.set_point_controller import (
    CommandLaw,
    DirectLaw,
    JointPidGroup,
    JointQuantity,
    pid_parameters,
)
from station.core.control.tunables import Tunables
from station.core.declared_parameter import EACH_JOINT, DeclaredParameter, ParameterType
from station.core.description.robot_description import JointDescription
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    JointGroup,
    JointStateGroup,
    PositionJointInterface,
    PosVelAccJointInterface,
    PosVelJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.interface_manager import interface_type_name
from station.core.numerics.pid import PidGains
from station.core.parameters import Parameters
from station.memory.doubles import doubles

_VELOCITY_FF = DeclaredParameter(
    name=f"velocity_ff/{EACH_JOINT}",
    type=ParameterType.NUMBER,
    unit="command s/rad",
    default=0.0,
    description="factor with which the desired velocity is added to the command",
)


class HardwareInterfaceAdapter:
    """Reads joints and commands them towards desired states. Control thread only.

    The controller reads and writes `tracking.memory` before and after the command.

    Args:
        joints: The joints.
        group: Their handles, in the same order.

    Attributes:
        tracking: Desired and measured states of the joints.
        output: What a sample shows as output, shape (n,); always the same memory.
        tunables: Run-time parameters of the command law; none by default.
    """

    def __init__(self, joints: list[JointDescription], group: JointStateGroup) -> None:
        self.tracking = JointTracking(joints, group)
        self.output = self.tracking.memory.commands
        self.tunables = Tunables()
        self._law: CommandLaw | None = None

    def starting(self) -> None:
        """Forget earlier commands; called when the controller starts."""

    def update_command(self, period: float) -> None:
        """Command the joints towards the desired states.

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        if self._law is None:
            raise NotImplementedError
        self._law.compute_commands(period)

    def command_law(self) -> CommandLaw | None:
        """Return what does the same as `update_command`; None for nothing."""
        return self._law


class PositionAdapter(HardwareInterfaceAdapter):
    """Commands the desired positions.

    Args:
        interface: The robot's interface.
        joints: The joints.
    """

    def __init__(
        self, interface: JointCommandInterface, joints: list[JointDescription]
    ) -> None:
        handles = [interface.get_handle(joint.name) for joint in joints]
        super().__init__(joints, JointGroup(handles))
        self._law = DirectLaw(self.tracking.positions, self.output)


class ClosedLoopAdapter(HardwareInterfaceAdapter):
    """Commands `velocity_ff` times the desired velocity plus the output of a PID.

    Parameters: the gains of every joint, see `PidGains.of_joints`; and
    `velocity_ff/<joint>`, 0 by default.

    Args:
        interface: The robot's interface.
        joints: The joints.
        params: The controller's namespace.
        command: The quantity that the interface commands.

    Raises:
        ParameterError: A joint has no gains, or a parameter is not allowed.

    Source:
        ClosedLoopHardwareInterfaceAdapter; differs: missing gains are refused when the
        controller is loaded.
    """

    def __init__(
        self,
        interface: JointCommandInterface,
        joints: list[JointDescription],
        params: Parameters,
        command: JointQuantity,
    ) -> None:
        handles = [interface.get_handle(joint.name) for joint in joints]
        super().__init__(joints, JointGroup(handles))
        self._pids = JointPidGroup(
            joints,
            PidGains.of_joints(params, [joint.name for joint in joints]),
            error=JointQuantity.POSITION,
            command=command,
            commands=self.output,
            errors=self.tracking.errors,
            rates=self.tracking.rate_errors,
        )
        velocity_gains = doubles(
            _VELOCITY_FF.of(joint.name).read_float(params) for joint in joints
        )
        self._law = FeedForwardPidLaw(
            self._pids.group, self.tracking.velocities, velocity_gains
        )
        self.tunables = self._pids.tunables

    @override
    def starting(self) -> None:
        self._pids.reset()


class DesiredStateAdapter(HardwareInterfaceAdapter):
    """Commands desired positions and velocities, and accelerations where they count.

    The output of a sample is the positions.

    Args:
        interface: The robot's interface; its type decides about accelerations.
        joints: The joints.
    """

    def __init__(
        self,
        interface: PosVelJointInterface | PosVelAccJointInterface,
        joints: list[JointDescription],
    ) -> None:
        handles = [interface.get_handle(joint.name) for joint in joints]
        super().__init__(joints, JointStateGroup(handles))
        self.output = self.tracking.positions
        self._takes_accelerations = isinstance(interface, PosVelAccJointInterface)
        self._set_commands: list[Callable[..., None]] = [
            handle.set_command for handle in handles
        ]

    @override
    def update_command(self, period: float) -> None:
        tracking = self.tracking
        columns = [tracking.positions, tracking.velocities]
        if self._takes_accelerations:
            columns.append(tracking.accelerations)
        numbers = zip(*columns, strict=True)
        for set_command, state in zip(self._set_commands, numbers, strict=True):
            set_command(*state)


_PID_COMMANDS: dict[type, JointQuantity] = {
    VelocityJointInterface: JointQuantity.VELOCITY,
    EffortJointInterface: JointQuantity.EFFORT,
}
"""What the PIDs of a `ClosedLoopAdapter` compute, by the interface."""


def adapter_parameters(interface: type) -> tuple[DeclaredParameter, ...]:
    """Return the parameters that the adapter for an interface reads.

    Args:
        interface: Type of the interface.
    """
    command = _PID_COMMANDS.get(interface)
    if command is None:
        return ()
    rate = "" if command is JointQuantity.VELOCITY else "Nm s/rad"
    pid = pid_parameters(error=JointQuantity.POSITION, command=command)
    return (*pid, replace(_VELOCITY_FF, unit=rate))


def adapter_for(
    interface: object, joints: list[JointDescription], params: Parameters
) -> HardwareInterfaceAdapter:
    """Claim joints of an interface and return the adapter for its type.

    Args:
        interface: One of the robot's joint command interfaces.
        joints: The joints.
        params: The controller's namespace.

    Raises:
        ControllerLoadError: There is no adapter for the type of `interface`.
        ParameterError: A joint has no gains, or a parameter is not allowed.
        ResourceNotFoundError: The robot has no joint of that name.
    """
    match interface:
        case PositionJointInterface():
            return PositionAdapter(interface, joints)
        case VelocityJointInterface() | EffortJointInterface():
            command = _PID_COMMANDS[type(interface)]
            return ClosedLoopAdapter(interface, joints, params, command)
        case PosVelJointInterface() | PosVelAccJointInterface():
            return DesiredStateAdapter(interface, joints)
    raise ControllerLoadError(
        "No trajectory can be commanded over "
        f"'{interface_type_name(type(interface))}'.",
        remedy="Use a joint command interface, or override `make_adapter`.",
    )
