"""Write desired joint states to each kind of command interface.

Source: ros_controllers@678b92a joint_trajectory_controller/
hardware_interface_adapter.h.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from typing_extensions import override

from station.controllers.joint_trajectory_controller.execution import JointTracking
from station.controllers.set_point_controller import (
    CommandLaw,
    DirectLaw,
    JointPidGroup,
    JointQuantity,
    PidLaw,
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
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.interface_manager import interface_type_name
from station.core.numerics.pid import PidGains
from station.core.parameters import Parameters
from station.memory.doubles import Doubles, doubles

_VELOCITY_FF = DeclaredParameter(
    name=f"velocity_ff/{EACH_JOINT}",
    type=ParameterType.NUMBER,
    unit="command s/rad",
    default=0.0,
    description="factor with which the desired velocity is added to the command",
)


class HardwareInterfaceAdapter:
    """Joints that are claimed for a trajectory, and the law that commands them.

    Args:
        tracking: Desired and measured states of the joints.
        law: Commands the joints towards the desired states.
        output: Output in a sample, shape (n,), always the same memory; None
            for the commands of `tracking`.
        pids: The PIDs of the law; None if it has none.

    Attributes:
        tracking: As given.
        law: As given.
        output: As given.
        tunables: Run-time parameters of the law.
    """

    def __init__(
        self,
        tracking: JointTracking,
        law: CommandLaw,
        *,
        output: Doubles | None = None,
        pids: JointPidGroup | None = None,
    ) -> None:
        self.tracking = tracking
        self.law = law
        self.output = tracking.memory.commands if output is None else output
        self.tunables = Tunables() if pids is None else pids.tunables
        self._pids = pids

    def reset(self) -> None:
        """Forget earlier errors; called when the controller starts."""
        if self._pids is not None:
            self._pids.reset()


class DesiredStateLaw(CommandLaw):
    """Commands desired positions and velocities, and accelerations where they count.

    Args:
        tracking: Desired states of the joints.
        handles: Handles of the joints; their type decides about accelerations.
    """

    def __init__(
        self,
        tracking: JointTracking,
        handles: Sequence[PosVelJointHandle | PosVelAccJointHandle],
    ) -> None:
        self._columns = [tracking.positions, tracking.velocities]
        if isinstance(handles[0], PosVelAccJointHandle):
            self._columns.append(tracking.accelerations)
        self._set_commands: list[Callable[..., None]] = [
            handle.set_command for handle in handles
        ]

    @override
    def compute_commands(self, period: float) -> None:
        """Command the desired states."""
        numbers = zip(*self._columns, strict=True)
        for set_command, state in zip(self._set_commands, numbers, strict=True):
            set_command(*state)


_PID_COMMANDS: dict[type, JointQuantity] = {
    VelocityJointInterface: JointQuantity.VELOCITY,
    EffortJointInterface: JointQuantity.EFFORT,
}
"""What PIDs compute, by the interface."""


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
            handles = [interface.get_handle(joint.name) for joint in joints]
            tracking = JointTracking(joints, JointGroup(handles))
            law = DirectLaw(tracking.positions, tracking.memory.commands)
            return HardwareInterfaceAdapter(tracking, law)
        case VelocityJointInterface() | EffortJointInterface():
            return _closed_loop_adapter(interface, joints, params)
        case PosVelJointInterface() | PosVelAccJointInterface():
            states = [interface.get_handle(joint.name) for joint in joints]
            tracking = JointTracking(joints, JointStateGroup(states))
            return HardwareInterfaceAdapter(
                tracking, DesiredStateLaw(tracking, states), output=tracking.positions
            )
    raise ControllerLoadError(
        "No trajectory can be commanded over "
        f"'{interface_type_name(type(interface))}'.",
        remedy="Use a joint command interface, or override `make_adapter`.",
    )


def _closed_loop_adapter(
    interface: JointCommandInterface, joints: list[JointDescription], params: Parameters
) -> HardwareInterfaceAdapter:
    """Command `velocity_ff` times the desired velocity plus the output of a PID.

    Parameters: the gains of every joint, see `PidGains.of_joints`; and
    `velocity_ff/<joint>`, 0 by default.

    Source:
        ClosedLoopHardwareInterfaceAdapter; differs: missing gains are refused when the
        controller is loaded.
    """
    names = [joint.name for joint in joints]
    tracking = JointTracking(joints, JointGroup([*map(interface.get_handle, names)]))
    pids = JointPidGroup(
        joints,
        PidGains.of_joints(params, names),
        error=JointQuantity.POSITION,
        command=_PID_COMMANDS[type(interface)],
        commands=tracking.memory.commands,
        errors=tracking.errors,
        rates=tracking.rate_errors,
    )
    gains = doubles(_VELOCITY_FF.of(name).read_float(params) for name in names)
    pids.group.feed_forward(tracking.velocities, gains)
    return HardwareInterfaceAdapter(tracking, PidLaw(pids.group), pids=pids)
