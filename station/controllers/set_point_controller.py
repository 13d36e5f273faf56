"""Controllers that follow one set-point per joint: forwarded, or by PIDs.

From their parameters to the commands of a cycle everything is here. The update of a
cycle and the laws that compute commands are compiled.

Source: ros_controllers@678b92a forward_command_controller/forward_command_controller.h,
forward_joint_group_command_controller.h; effort_controllers/src/
joint_group_position_controller.cpp, joint_position_controller.cpp,
joint_velocity_controller.cpp, velocity_controllers/src/joint_position_controller.cpp.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from enum import Enum
from math import inf, isfinite
from operator import attrgetter
from typing import ClassVar, TypeVar

from typing_extensions import override

from station.core.control.controller import Controller
from station.core.control.sample_columns import SampleColumns
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import (
    EACH_JOINT,
    DeclaredParameter,
    NameKind,
    declare_string,
    declare_strings,
)
from station.core.description.robot_description import (
    JointDescription,
    find_robot_description,
    require_robot_description,
)
from station.core.description.urdf import JointType
from station.core.errors import InvalidGainError
from station.core.hardware.interfaces import (
    JointCommandInterface,
    JointGroup,
    JointStateGroup,
)
from station.core.numerics.joint_errors import BOUNDED, CONTINUOUS, PLAIN, JointErrors
from station.core.numerics.pid import PID_PARAMETERS, PidGains, PidGroup
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    read_command_timeout,
    timeout_parameters,
)
from station.memory.direct_calls import call_directly
from station.memory.doubles import Doubles, Storage, own_zeros, put, zeros
from station.memory.vectors import copy_into

CommandInterfaceT = TypeVar("CommandInterfaceT", bound=JointCommandInterface)

JOINT = declare_string("joint", "the joint", names=NameKind.JOINT)
JOINTS = declare_strings(
    "joints", "the joints, in the order of the set-points", names=NameKind.JOINT
)


_MAXIMUM = {"p": 10_000.0, "i": 10_000.0, "d": 1_000.0}
"""Largest gains offered for tuning, in the units of the gains."""
_CLAMP_MAXIMUM = 1_000.0
"""Largest bound of the integral part offered for tuning, in the command's unit."""
_integral_gains = attrgetter("i", "i_min", "i_max")
_DESCRIPTIONS = {
    "p": "proportional gain",
    "i": "integral gain",
    "d": "derivative gain",
    "i_clamp_max": "upper bound of the integral part",
    "i_clamp_min": "lower bound of the integral part",
}


def read_joint_names(params: Parameters) -> list[str]:
    """Return the joints of a group controller.

    Args:
        params: The controller's namespace; `joints` is a list of names.

    Raises:
        ParameterError: `joints` is missing, empty, or names a joint twice.
    """
    names = JOINTS.read_str_list(params)
    # Of two commands for a joint that is named twice, the second would win silently.
    if not names or len(set(names)) != len(names):
        JOINTS.refuse(
            params, names, "a list of at least one joint, and each joint once"
        )
    return names


class ControlledJoints:
    """The measured values and the commands of a group of joints, shape (n,) each.

    Where the robot keeps the joints side by side in doubles, these are the robot's own
    values, and there is nothing to do. Otherwise they are copies.

    Args:
        group: The joints; without a `JointGroup` there is nothing to command.

    Attributes:
        size: The number of joints n.
        positions: Measured positions [rad or m].
        velocities: Measured velocities [rad/s or m/s].
        efforts: Measured efforts [Nm or N].
        commands: Commands in the unit of the interface.
        is_copy: Whether `read` has to be called before the values are used, and `write`
            after the commands were computed.
    """

    def __init__(self, group: JointStateGroup) -> None:
        self.size = len(group.names)
        self._group = group
        self._commanded = group if isinstance(group, JointGroup) else None
        measured = (group.positions, group.velocities, group.efforts)
        self.positions, self.velocities, self.efforts = (
            self._view_or_copy(view) for view in measured
        )
        commands = None if self._commanded is None else self._commanded.commands
        self.commands = self._view_or_copy(commands)
        writes = self._commanded is not None and commands is None
        self.is_copy = writes or any(view is None for view in measured)

    def _view_or_copy(self, view: Doubles | None) -> Doubles:
        return zeros(self.size) if view is None else view

    def read(self) -> None:
        """Copy the measured values, if `is_copy` is true."""
        group = self._group
        if group.positions is None:
            put(self.positions, group.get_positions())
        if group.velocities is None:
            put(self.velocities, group.get_velocities())
        if group.efforts is None:
            put(self.efforts, group.get_efforts())

    def write(self) -> None:
        """Copy the commands to the joints, if `is_copy` is true."""
        group = self._commanded
        if group is not None and group.commands is None:
            group.set_commands([*self.commands])


class JointQuantity(Enum):
    """A quantity that is measured and commanded at a joint."""

    POSITION = "position"
    VELOCITY = "velocity"
    EFFORT = "effort"

    def unit(self, joint: JointDescription) -> str:
        """Return the unit of the quantity at `joint`."""
        return _UNITS[self][joint.is_linear()]

    def range(self, joint: JointDescription) -> tuple[float, float]:
        """Return the smallest and the largest value allowed at `joint`."""
        return {
            JointQuantity.POSITION: (joint.lower, joint.upper),
            JointQuantity.VELOCITY: (-joint.velocity, joint.velocity),
            JointQuantity.EFFORT: (-joint.effort, joint.effort),
        }[self]

    def measured(self, memory: ControlledJoints) -> Doubles:
        """Return the measured values of joints, shape (n,), not a copy."""
        return {
            JointQuantity.POSITION: memory.positions,
            JointQuantity.VELOCITY: memory.velocities,
            JointQuantity.EFFORT: memory.efforts,
        }[self]


_UNITS = {
    JointQuantity.POSITION: ("rad", "m"),
    JointQuantity.VELOCITY: ("rad/s", "m/s"),
    JointQuantity.EFFORT: ("Nm", "N"),
}
"""Units at a rotating and at a linear joint."""


class CommandLaw:
    """Computes the commands of n joints; reads and writes memory that it was given."""

    def compute_commands(self, period: float) -> None:
        """Write the commands.

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError


class DirectLaw(CommandLaw):
    """Commands the desired values.

    Args:
        desired: Desired values, shape (n,).
        commands: Receives the commands, shape (n,).
        errors: Compares the desired with the measured values for the sample; None for
            no comparison.
    """

    def __init__(
        self, desired: Doubles, commands: Doubles, errors: JointErrors | None = None
    ) -> None:
        self.desired = desired
        self.commands = commands
        self.size = len(commands)
        self.errors = errors

    def compute_commands(self, period: float) -> None:  # noqa: ARG002 - a law's
        """Copy the desired values."""
        copy_into(self.commands, 0, self.desired, self.size)
        if self.errors is not None:
            self.errors.compare()


class PidLaw(CommandLaw):
    """Commands the output of PIDs for the errors of a set-point, or for given errors.

    Args:
        pids: One PID per joint.
        set_point: The set-point; None if the owner of the PIDs writes errors and rates.
        errors: Compares the values of the set-point with the measured ones.
        rate_errors: Compares its rates.
    """

    def __init__(
        self,
        pids: PidGroup,
        set_point: ActiveSetPoint | None = None,
        errors: JointErrors | None = None,
        rate_errors: JointErrors | None = None,
    ) -> None:
        self.pids = pids
        self.set_point = set_point
        self.errors = errors
        self.rate_errors = rate_errors

    def compute_commands(self, period: float) -> None:
        """Compute the errors of a set-point, and the commands."""
        rates_known = True
        if self.set_point is not None and self.errors is not None:
            self.errors.compare()
            rates_known = self.set_point.has_rates
        if rates_known and self.rate_errors is not None:
            self.rate_errors.compare()
        self.pids.compute_commands(period, rates_known)


class SetPointUpdate:
    """The update of a controller that follows a set-point.

    Args:
        set_point: The set-point.
        joints: The joints.
        law: Computes the commands.
        sampled: Keeps the sample of the update.

    Attributes:
        period: Time between the last two cycles [s].
    """

    def __init__(
        self,
        set_point: ActiveSetPoint,
        joints: ControlledJoints,
        law: CommandLaw,
        sampled: SampleColumns,
    ) -> None:
        self.set_point = set_point
        self.copies = joints if joints.is_copy else None
        self.law = law
        self.sampled = sampled
        self.period = 0.0

    def command_joints(self, time: float, period: float) -> None:
        """Take the newest set-point, and command the joints towards it.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        if self.set_point.port.has_changed():
            self.set_point.newest()
        if self.copies is not None:
            self.copies.read()
        self.period = period
        self.law.compute_commands(period)
        self.sampled.keep(time)
        if self.copies is not None:
            self.copies.write()


class JointPidGroup:
    """The PIDs of a controller, in the order of its joints.

    Args:
        joints: The joints.
        gains: First gains, in the same order.
        places: Namespaces of the parameters that give them, see `PidGains.places`.
        error: The quantity whose error the PIDs reduce.
        command: The quantity that the PIDs compute.
        commands: Receives the commands, shape (n,); None for new memory.
        errors: Receives the errors, shape (n,); None for new memory.
        rates: Receives the rates of the errors, shape (n,); None for new memory.

    Attributes:
        errors: Set-points minus measured values, in the unit of the error, shape (n,);
            the controller writes them.
        rates: Rates of the errors, in the unit of the error per second, shape (n,);
            written by the controller where they are known.
        commands: The commands, shape (n,).
        group: The PIDs.
        tunables: The gains as run-time parameters, named `<joint>/p`, `/i`, `/d`,
            `/i_clamp_max` and `/i_clamp_min`. A change keeps errors and the integral
            part of the command, as far as the new bounds allow it.
    """

    def __init__(
        self,
        joints: list[JointDescription],
        gains: list[PidGains],
        *,
        places: Sequence[str] = (),
        error: JointQuantity,
        command: JointQuantity,
        commands: Doubles | None = None,
        errors: Doubles | None = None,
        rates: Storage | None = None,
    ) -> None:
        size = len(joints)
        self._names = [joint.name for joint in joints]
        self.errors = zeros(size) if errors is None else errors
        self.rates: Storage = own_zeros(size) if rates is None else rates
        self.commands = zeros(size) if commands is None else commands
        self.group = PidGroup(self.errors, self.rates, self.commands)
        self._gains: list[PidGains] = []
        self._use(gains)
        schema: dict[str, Tunable] = {}
        values: dict[str, float] = {}
        for joint, each, place in zip(
            joints, gains, places or [""] * size, strict=True
        ):
            units = _units(command.unit(joint), error.unit(joint))
            for key, value in _named(each).items():
                gain = _tunable(key, value, units[key])
                parameter = f"{place}/{key}" if place else ""
                schema[f"{joint.name}/{key}"] = replace(gain, parameter=parameter)
                values[f"{joint.name}/{key}"] = value
        self.tunables = Tunables(
            schema,
            values,
            check=self._check_bounds,
            apply=self._set_gains,
            notes=self._without_effect,
        )

    def reset(self) -> None:
        """Forget all errors and integrals."""
        self.group.reset()

    def columns(self) -> dict[str, list[float] | list[bool]]:
        """Return the gains in force by their name in JointControllerState, (n,) each.

        Source:
            control_msgs@1.5.2 msg/JointControllerState.msg.
        """
        gains = self._gains
        return {
            "p": [each.p for each in gains],
            "i": [each.i for each in gains],
            "d": [each.d for each in gains],
            "i_clamp": [each.i_max for each in gains],
            "antiwindup": [each.antiwindup for each in gains],
        }

    def _check_bounds(self, values: Mapping[str, float]) -> None:
        for name in self._names:
            lower = values[f"{name}/i_clamp_min"]
            upper = values[f"{name}/i_clamp_max"]
            if lower > upper:
                raise InvalidGainError(
                    f"Gain '{name}/i_clamp_min' is {lower}, above "
                    f"'{name}/i_clamp_max', which is {upper}.",
                    remedy="Send bounds with i_clamp_min <= i_clamp_max.",
                )

    def _without_effect(self, values: Mapping[str, float]) -> list[str]:
        return [
            f"The gain '{name}/i' is {values[f'{name}/i']:g} and has no effect: the "
            "integral part is bounded by 'i_clamp', which is 0. Give i_clamp, the "
            "largest integral part of the command."
            for name in self._names
            if values[f"{name}/i"] != 0.0
            and values[f"{name}/i_clamp_min"] == values[f"{name}/i_clamp_max"] == 0.0
        ]

    def _set_gains(self, values: Mapping[str, float]) -> None:
        gains = [
            PidGains(
                p=values[f"{name}/p"],
                i=values[f"{name}/i"],
                d=values[f"{name}/d"],
                i_max=values[f"{name}/i_clamp_max"],
                i_min=values[f"{name}/i_clamp_min"],
                antiwindup=before.antiwindup,
            )
            for name, before in zip(self._names, self._gains, strict=True)
        ]
        for index, (before, after) in enumerate(zip(self._gains, gains, strict=True)):
            self._keep_integral_part(index, before, after)
        self._use(gains)

    def _keep_integral_part(
        self, index: int, before: PidGains, after: PidGains
    ) -> None:
        """Keep the integral part of one joint's command.

        The integral part often carries a load. If the integral itself stayed, twice the
        gain would be twice the torque in the next cycle.
        """
        same = _integral_gains(before) == _integral_gains(after)
        if same or after.i == 0.0:
            return
        part = before.i * self.group.integral(index)
        part = max(before.i_min, min(before.i_max, part))
        integral = part / after.i
        # The smallest gains would need an integral beyond the largest float.
        self.group.set_integral(index, integral if isfinite(integral) else 0.0)

    def _use(self, gains: list[PidGains]) -> None:
        for index, each in enumerate(gains):
            self.group.set_gains(index, each)
        self._gains = gains


def pid_parameters(
    *, error: JointQuantity, command: JointQuantity
) -> tuple[DeclaredParameter, ...]:
    """Return the declarations of the parameters that `PidGains.of_joints` reads.

    Args:
        error: The quantity whose error the PIDs reduce.
        command: The quantity that the PIDs compute.
    """
    rotating = JointDescription("")
    units = _units(command.unit(rotating), error.unit(rotating))
    units["i_clamp"] = command.unit(rotating)
    return tuple(
        replace(each.inside(f"{EACH_JOINT}/pid"), unit=units.get(each.name, ""))
        for each in PID_PARAMETERS
    )


def _named(gains: PidGains) -> dict[str, float]:
    return {
        "p": gains.p,
        "i": gains.i,
        "d": gains.d,
        "i_clamp_max": gains.i_max,
        # Turns -0.0, which would be printed, into 0.0.
        "i_clamp_min": gains.i_min + 0.0,
    }


def _units(command: str, error: str) -> dict[str, str]:
    """Return the unit of every gain, e.g. Nm/rad, Nm/(rad s), Nm s/rad."""
    base, per_second = error.removesuffix("/s"), error.endswith("/s")
    proportional = f"{command} s/{base}" if per_second else f"{command}/{base}"
    integral = f"{command}/{base}" if per_second else f"{command}/({base} s)"
    derivative = f"{command} s^2/{base}" if per_second else f"{command} s/{base}"
    units = {"p": proportional, "i": integral, "d": derivative}
    if command == f"{error}/s":
        units = {"p": "1/s", "i": "1/s^2", "d": ""}
    return {**units, "i_clamp_max": command, "i_clamp_min": command}


def _tunable(key: str, value: float, unit: str) -> Tunable:
    """Return unit and range of a gain; the range includes the configured value."""
    lower, upper = 0.0, _MAXIMUM.get(key, _CLAMP_MAXIMUM)
    if key == "i_clamp_min":
        lower, upper = -upper, 0.0
    return Tunable(unit, min(lower, value), max(upper, value), _DESCRIPTIONS[key])


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
        quantity: Quantity of the set-points.
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
    _active: ActiveSetPoint
    _update: SetPointUpdate

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
        self._active = ActiveSetPoint(
            self.set_points, action, ", ".join(self.joint_names), self.rest
        )

    def rest(self) -> list[float]:
        """Return the set-point at which the joints keep their positions, shape (n,)."""
        if self.quantity is JointQuantity.POSITION:
            return self.group.get_positions()
        return [0.0] * len(self.joints)

    def newest_set_point(self) -> list[float]:
        """Return the set-point in force, shape (n,); see `ActiveSetPoint.newest`.

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        return self._active.newest()

    def follow_by(self, law: CommandLaw, columns: tuple[Doubles, ...]) -> None:
        """Let a law compute the commands of every cycle.

        Args:
            law: Computes the commands from `memory` and the set-point in force.
            columns: The columns of the sample, shape (n,) each.
        """
        self.sampled = SampleColumns(columns)
        self._update = SetPointUpdate(self._active, self.memory, law, self.sampled)
        command = self._update.command_joints
        call_directly(self, JointSetPointController, update=command)

    @override
    def update(self, time: float, period: float) -> None:
        self._update.command_joints(time, period)

    @override
    def starting(self, time: float) -> None:
        self._active.start_at_rest()

    def _element(self, joint: JointDescription) -> SetPointElement:
        lower, upper = self.quantity.range(joint)
        return SetPointElement(joint.name, self.quantity.unit(joint), lower, upper)


class ForwardJointGroupCommandController(JointSetPointController[CommandInterfaceT]):
    """Writes the set-point to the command interface as it is.

    Parameters: `joints`, the names of the joints in the order of the set-points, and
    those of the base class.

    Source:
        ForwardJointGroupCommandController; differs: a set-point beyond the limits of
        the robot description is refused.
    """

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        desired, actual = self._active.desired, self.quantity.measured(self.memory)
        errors = zeros(self.memory.size)
        law = DirectLaw(
            desired, self.memory.commands, JointErrors(desired, actual, errors)
        )
        self.follow_by(law, (desired, actual, errors, desired))


class ForwardCommandController(ForwardJointGroupCommandController[CommandInterfaceT]):
    """Writes the set-point of one joint to the command interface as it is.

    Parameters: `joint`, the name of the joint, and those of the base class.
    """

    is_group: ClassVar[bool] = False


class JointPidController(JointSetPointController[CommandInterfaceT]):
    """Commands the output of one PID per joint for the error of the set-point.

    The error of a position is the distance that the joint can turn, see
    `set_wrapping`; the limits come from the robot description, without which positions
    are not controlled. A set-point of positions may include velocities; the derivative
    gain then acts on the difference to these velocities.

    Parameters: those of the base class, and the gains of every joint, see
    `PidGains.of_joints`.

    Attributes:
        quantity: Controlled quantity, of set-points, measurements and errors.
        command_quantity: Quantity that the PIDs compute.

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
            PidGains.of_joints(params, self.joint_names),
            places=PidGains.places(params, self.joint_names),
            error=self.quantity,
            command=self.command_quantity,
            commands=self.memory.commands,
        )
        desired, actual = self._active.desired, self.quantity.measured(self.memory)
        errors = JointErrors(desired, actual, self._pids.errors)
        rate_errors = JointErrors(
            self._active.desired_rates, self.memory.velocities, self._pids.rates
        )
        if self.quantity is JointQuantity.POSITION:
            set_wrapping(errors, self.joints)
        self.follow_by(
            PidLaw(self._pids.group, self._active, errors, rate_errors),
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
        common = {"stamp": sample.stamp, "time_step": self._update.period}
        if self.is_group:
            return {"state": {**common, "joint_names": self.joint_names, **columns}}
        return {"state": {**common, **{key: each[0] for key, each in columns.items()}}}


def set_wrapping(errors: JointErrors, joints: list[JointDescription]) -> None:
    """Let the errors of positions be the distances that the joints can turn.

    A continuous joint takes the shorter of the two ways round, a revolute joint the
    shortest way that stays within its limits.

    Args:
        errors: Compares the positions of the joints.
        joints: The joints, in the same order.
    """
    wraps = {JointType.CONTINUOUS: CONTINUOUS, JointType.REVOLUTE: BOUNDED}
    for index, joint in enumerate(joints):
        wrapping = wraps.get(joint.type, PLAIN)
        errors.set_wrapping(index, wrapping, joint.lower, joint.upper)
