"""Enforce the limits of joints by their handles, and count the changes.

The equations are in `limited_joints` and `rate_limits`.

Source: ros_control@633c374 joint_limits_interface.h; differs: clamps are counted,
invalid limits are refused, and the saturation handle of velocities can be reset. The
rate limits have no original.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from math import inf, nan
from sys import float_info
from typing import ClassVar, Protocol

from typing_extensions import override

from station.core.errors import ParameterError
from station.core.hardware.interfaces.joint import JointHandle
from station.core.hardware.interfaces.joint_group import JointGroup
from station.core.hardware.interfaces.resource_manager import ResourceHandle
from station.core.hardware.limits.joint_limits import (
    JointLimits,
    JointLimitsError,
    SoftJointLimits,
)
from station.core.hardware.limits.limited_joints import (
    LIMITS,
    MEMORY,
    EffortSaturation,
    EffortSoftLimits,
    LimitedJoints,
    PositionLimits,
    VelocitySaturation,
    VelocitySoftLimits,
)
from station.core.hardware.limits.rate_limits import (
    PositionRateLimits,
    VelocityRateLimits,
)
from station.core.parameters import Parameters
from station.memory.doubles import Storage, own_block, put


class Arithmetic(Protocol):
    """Makes limits of one kind over memory that the caller owns."""

    def __call__(self, views: Mapping[str, Storage]) -> LimitedJoints:
        """Return the limits of the joints with these views; see `LimitedJoints`."""


_OTHERS = ("position", "velocity", "command", "asked", "reason")


class JointLimitsGroup:
    """Joints whose limits are of one kind, and the memory of their commands.

    Joints that lie side by side in a robot's doubles are limited in place. The values
    of other joints are copied in and out.

    Args:
        arithmetic: The kind of limits.
        joints: The joints, n of them, at most `MOST_JOINTS`.
        limits: The values named in `LIMITS`, for each joint.
        memory: The values named in `MEMORY`, for each joint.

    Attributes:
        enforce: `LimitedJoints.enforce` of the joints. Control thread.
        in_place: The limits, if they work on the robot's own memory; otherwise None.
    """

    def __init__(
        self,
        arithmetic: Arithmetic,
        joints: Sequence[JointHandle],
        limits: Sequence[Mapping[str, float]],
        memory: Sequence[Mapping[str, float]],
    ) -> None:
        views = own_block((*LIMITS, *MEMORY, *_OTHERS), len(joints))
        for i, (values, remembered) in enumerate(zip(limits, memory, strict=True)):
            for name in LIMITS:
                views[name][i] = values[name]
            for name in MEMORY:
                views[name][i] = remembered[name]
        self._joints = JointGroup(joints)
        self._views = views
        position, velocity = self._joints.positions, self._joints.velocities
        command = self._joints.commands
        in_place = position is not None and velocity is not None and command is not None
        if position is not None and velocity is not None and command is not None:
            views.update(position=position, velocity=velocity, command=command)
        self._arithmetic = arithmetic(views)
        self.in_place = self._arithmetic if in_place else None
        self.enforce: Callable[[float, int, int], int] = (
            self._arithmetic.enforce if in_place else self._enforce_copies
        )

    def clamp(self, slot: int) -> tuple[float, float, int]:
        """Return the last change of a joint's command.

        Args:
            slot: The joint.

        Returns:
            The command before and after, and the code of the limit.
        """
        views = self._views
        return views["asked"][slot], views["command"][slot], int(views["reason"][slot])

    def memory(self, slot: int) -> dict[str, float]:
        """Return the remembered state of a joint, by the names in `MEMORY`."""
        return {name: self._views[name][slot] for name in MEMORY}

    def remember(self, slot: int, memory: Mapping[str, float]) -> None:
        """Replace the remembered command of a joint.

        Args:
            slot: The joint.
            memory: The values named in `MEMORY`.
        """
        for name in MEMORY:
            self._views[name][slot] = memory[name]

    def _enforce_copies(self, period: float, first: int, last: int) -> int:
        joints, views = self._joints, self._views
        put(views["position"], joints.get_positions())
        put(views["velocity"], joints.get_velocities())
        put(views["command"], joints.get_commands())
        mask = self._arithmetic.enforce(period, first, last)
        joints.set_commands([*views["command"]])
        return mask


class ClampReason(Enum):
    """The limit that changed a command, in the order of the codes."""

    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    JERK = "jerk"
    EFFORT = "effort"
    SOFT_POSITION = "soft_position"


_REASONS = tuple(ClampReason)


@dataclass(frozen=True, slots=True)
class Clamp:
    """A command that limits have changed: its values before and after.

    Attributes:
        joint: Name of the joint.
        asked: Command before the limits, in the unit of the joint's command.
        given: Command after the limits, in the same unit.
        reason: The limit that changed the command.
    """

    joint: str
    asked: float
    given: float
    reason: ClampReason


class JointLimitsHandle(ResourceHandle):
    """Enforce the limits of one joint once per cycle, after the controllers.

    Contract: `enforce_limits` is called by the control thread in `RobotHW.write`, with
    this cycle's state and command in the joint's slots; it allocates nothing unless it
    clamps. `reset` is called on a mode switch, an emergency stop or a recovery. The
    clamp figures may be read by any thread. A NaN command passes unchanged and is not
    counted, as in the original; the robot and the manager refuse it.

    A kind of limits sets `arithmetic`, or overrides `enforce_limits`. A
    `JointLimitsInterface` runs the arithmetic of one kind for all its joints in one
    call.

    Args:
        joint: The joint's state and command, in the unit of the joint's command.
        limits: The joint's limits, read once.
        soft_limits: Range and gains of the soft limits; None without soft limits.

    Attributes:
        arithmetic: The compiled arithmetic; in this base class it limits nothing.
        required: The limits that the joint must have, such as "velocity".
        unlimited: Number that stands for a limit that the joint does not have.
        first_previous: The previous command in the first cycle; NaN takes the measured
            state.
        is_grouped: Whether an interface enforces the limits together with others.
        clamp_count: Number of cycles in which the command was changed, since
            construction.

    Raises:
        JointLimitsError: A required limit is missing, or no command could satisfy the
            limits.
    """

    arithmetic: ClassVar[Arithmetic] = LimitedJoints
    required: ClassVar[tuple[str, ...]] = ()
    unlimited: ClassVar[float] = nan
    first_previous: ClassVar[float] = nan

    def __init__(
        self,
        joint: JointHandle,
        limits: JointLimits,
        soft_limits: SoftJointLimits | None = None,
    ) -> None:
        super().__init__(joint.name)
        for kind in self.required:
            _require_limit(joint.name, kind, getattr(limits, f"max_{kind}"))
        limits.validate(joint.name)
        if soft_limits is not None:
            soft_limits.validate(joint.name)
        self.joint: JointHandle = joint
        self.bounds: dict[str, float] = self.find_bounds(limits, soft_limits)
        self.is_grouped: bool = False
        self.clamp_count: int = 0
        self._last_clamp: tuple[float, float, int] | None = None
        self._slot: int = 0
        self._group: JointLimitsGroup = JointLimitsGroup(
            self.arithmetic, [joint], [self.bounds], [self._first_memory()]
        )

    @property
    def last_clamp(self) -> Clamp | None:
        """The latest change of a command, or None if there was none. Any thread."""
        last = self._last_clamp
        if last is None:
            return None
        return Clamp(self.name, last[0], last[1], _REASONS[last[2]])

    def find_bounds(
        self, limits: JointLimits, soft_limits: SoftJointLimits | None
    ) -> dict[str, float]:
        """Return the limits in the form of the arithmetic, by the names in `LIMITS`.

        Args:
            limits: The joint's limits.
            soft_limits: The soft limits; a continuous joint ignores their range.
        """
        soft = SoftJointLimits() if soft_limits is None else soft_limits
        has_range = soft_limits is not None and limits.has_position_limits
        found = {
            "min_position": limits.min_position,
            "max_position": limits.max_position,
            "max_velocity": limits.max_velocity,
            "max_acceleration": limits.max_acceleration,
            "max_jerk": limits.max_jerk,
            "max_effort": limits.max_effort,
            # A continuous joint has no range in which soft limits could lie.
            "soft_min": soft.min_position if has_range else None,
            "soft_max": soft.max_position if has_range else None,
            "k_position": soft.k_position,
            "k_velocity": soft.k_velocity,
        }
        absent = self.unlimited
        bounds = {name: absent if x is None else x for name, x in found.items()}
        # Where `unlimited` is infinite, a missing lower bound is minus infinity.
        if limits.min_position is None:
            bounds["min_position"] = -absent
        return bounds

    def enforce_limits(self, period: float) -> None:
        """Replace the joint's command by the nearest admissible one.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        slot = self._slot
        if self._group.enforce(period, slot, slot + 1):
            self.count_clamp()

    def reset(self) -> None:
        """Forget the previous command; the next cycle starts from the joint's state."""
        self._group.remember(self._slot, self._first_memory())

    @property
    def enforces_alone(self) -> bool:
        """Return whether the handle's class overrides `enforce_limits`."""
        # Such a class needs a call for each joint, which a group would not make.
        return type(self).enforce_limits is not JointLimitsHandle.enforce_limits

    def memory(self) -> dict[str, float]:
        """Return the state remembered from the last cycle. For interfaces."""
        return self._group.memory(self._slot)

    def join(self, group: JointLimitsGroup, slot: int) -> None:
        """Use the memory of a group from now on. For interfaces.

        Args:
            group: A group whose `bounds` and `memory()` have been called.
            slot: The joint's place in the group.
        """
        self._group, self._slot = group, slot
        self.is_grouped = True

    def count_clamp(self) -> None:
        """Count the change that the group has just made. Control thread."""
        # One reference is exchanged, so readers in other threads see whole tuples.
        self._last_clamp = self._group.clamp(self._slot)
        self.clamp_count += 1

    def _first_memory(self) -> dict[str, float]:
        return {
            "previous": self.first_previous,
            "velocity_before": nan,
            "acceleration_before": 0.0,
        }


class SoftLimitsHandle(JointLimitsHandle):
    """Enforce hard limits and soft limits, before which the joint is slowed down.

    Args:
        joint: The joint's state and command, in the unit of the joint's command.
        limits: The joint's limits, read once.
        soft_limits: Range and gains; the range is ignored without position limits.

    Raises:
        JointLimitsError: A required limit is missing, or no command could satisfy the
            limits.
    """

    def __init__(
        self, joint: JointHandle, limits: JointLimits, soft_limits: SoftJointLimits
    ) -> None:
        super().__init__(joint, limits, soft_limits)


def _require_limit(joint: str, kind: str, value: float | None) -> None:
    if value is None:
        raise JointLimitsError(
            f"Cannot enforce limits for joint '{joint}'. "
            f"It has no {kind} limits specification.",
            remedy=f"Give joint '{joint}' a {kind} limit in the URDF (<limit "
            f'{kind}="...">) or as joint_limits/{joint}/max_{kind}.',
        )


class EffortJointSaturationHandle(JointLimitsHandle):
    """Clip an effort command; beyond a limit, admit only an effort that points back.

    Effort commands are in [N*m or N]. The joint needs velocity and effort limits;
    position limits are optional.
    """

    arithmetic: ClassVar[Arithmetic] = EffortSaturation
    required: ClassVar[tuple[str, ...]] = ("velocity", "effort")


class EffortJointSoftLimitsHandle(SoftLimitsHandle):
    """Brake a joint in proportion to its excess velocity before the soft limits.

    Effort commands are in [N*m or N]. The joint needs velocity and effort limits, and
    position limits unless it is continuous.
    """

    arithmetic: ClassVar[Arithmetic] = EffortSoftLimits
    required: ClassVar[tuple[str, ...]] = ("velocity", "effort")


class PositionJointSaturationHandle(JointLimitsHandle):
    """Clip a position command to the position range and the velocity bound.

    Position commands are in [rad or m]. Position and velocity limits are optional.
    """

    arithmetic: ClassVar[Arithmetic] = PositionLimits

    @override
    def find_bounds(
        self, limits: JointLimits, soft_limits: SoftJointLimits | None
    ) -> dict[str, float]:
        bounds = super().find_bounds(limits, None)
        # An infinite command becomes a finite one, as in the original.
        if not bounds["min_position"] > -float_info.max:
            bounds["min_position"] = -float_info.max
        if not bounds["max_position"] < float_info.max:
            bounds["max_position"] = float_info.max
        return bounds


class PositionJointSoftLimitsHandle(SoftLimitsHandle):
    """Slow a position command down towards the soft limits, and stop it there.

    The velocity bound compares with the last command, not with the measured position,
    which lags behind. It does not hold, therefore, while the joint recovers from a
    large tracking error. `k_velocity` is not used. Position commands are in [rad or m].
    The joint needs velocity limits, and position limits unless it is continuous.
    """

    arithmetic: ClassVar[Arithmetic] = PositionLimits
    required: ClassVar[tuple[str, ...]] = ("velocity",)


class VelocityJointSaturationHandle(JointLimitsHandle):
    """Clip a velocity command to the velocity and acceleration bounds.

    Velocity commands are in [rad/s or m/s]. The joint needs velocity limits;
    acceleration limits are optional.
    """

    arithmetic: ClassVar[Arithmetic] = staticmethod(VelocitySaturation)
    required: ClassVar[tuple[str, ...]] = ("velocity",)
    first_previous: ClassVar[float] = 0.0


class VelocityJointSoftLimitsHandle(SoftLimitsHandle):
    """Slow a velocity command down towards the soft limits.

    Velocity commands are in [rad/s or m/s]. All limits are optional.
    """

    arithmetic: ClassVar[Arithmetic] = VelocitySoftLimits

    @override
    def find_bounds(
        self, limits: JointLimits, soft_limits: SoftJointLimits | None
    ) -> dict[str, float]:
        bounds = super().find_bounds(limits, soft_limits)
        # An infinite command becomes a finite one, as in the original.
        if not bounds["max_velocity"] < float_info.max:
            bounds["max_velocity"] = float_info.max
        return bounds


class PositionJointRateLimitsHandle(JointLimitsHandle):
    """Limit the velocity, acceleration and jerk of position commands, and their range.

    The first command after construction or `reset` starts from the measured position
    and velocity. A period of 0 or less repeats the last command. Position commands are
    in [rad or m]. All limits are optional.
    """

    arithmetic: ClassVar[Arithmetic] = staticmethod(PositionRateLimits)
    unlimited: ClassVar[float] = inf


class VelocityJointRateLimitsHandle(JointLimitsHandle):
    """Limit the acceleration and jerk of velocity commands, and the joint's range.

    The range is that of the measured position. The first command after construction
    or `reset` starts from the measured velocity. A period of 0 or less repeats the last
    command. Velocity commands are in [rad/s or m/s]. All limits are optional.
    """

    arithmetic: ClassVar[Arithmetic] = VelocityRateLimits
    unlimited: ClassVar[float] = inf


_KEY = "limit_mode"
_MakeHandle = Callable[[JointHandle, JointLimits], JointLimitsHandle]
_SATURATION: Mapping[str, _MakeHandle] = {
    "position": PositionJointSaturationHandle,
    "velocity": VelocityJointSaturationHandle,
    "effort": EffortJointSaturationHandle,
}
_SOFT: Mapping[
    str, Callable[[JointHandle, JointLimits, SoftJointLimits], JointLimitsHandle]
] = {
    "position": PositionJointSoftLimitsHandle,
    "velocity": VelocityJointSoftLimitsHandle,
    "effort": EffortJointSoftLimitsHandle,
}
_RATE: Mapping[str, _MakeHandle] = {
    "position": PositionJointRateLimitsHandle,
    "velocity": VelocityJointRateLimitsHandle,
    "effort": EffortJointSaturationHandle,
}


class LimitMode(Enum):
    """The methods of limiting commands.

    Attributes:
        ROS_CONTROL: By the soft limits of a joint that has them, otherwise by
            saturation at its hard limits.
        RATE: Against the command of the last cycle, acceleration and jerk included;
            see `rate_limits`. Efforts have no rate and are saturated.
    """

    ROS_CONTROL = "ros_control"
    RATE = "rate"

    @classmethod
    def from_parameters(cls, params: Parameters) -> "LimitMode":
        """Return a robot's `limit_mode`, which is `ros_control` when absent.

        Args:
            params: The robot's namespace.

        Raises:
            ParameterError: The parameter has another value than the modes' names.
        """
        value = params.get_str(_KEY, cls.ROS_CONTROL.value)
        modes = {mode.value: mode for mode in cls}
        if value not in modes:
            raise ParameterError(
                f"Parameter '{params.resolve(_KEY)}' is {value!r}; it must be one of "
                f"{', '.join(modes)}.",
                remedy="Correct the configuration.",
                details={"parameter": params.resolve(_KEY)},
            )
        return modes[value]


def make_limits_handle(
    mode: LimitMode,
    quantity: str,
    joint: JointHandle,
    limits: JointLimits,
    soft_limits: SoftJointLimits | None,
) -> JointLimitsHandle:
    """Return the handle that enforces the limits of one kind of command of a joint.

    Args:
        mode: How commands are limited.
        quantity: "position", "velocity" or "effort".
        joint: The joint's state and command.
        limits: The joint's limits.
        soft_limits: The joint's soft limits; None if it has none.

    Raises:
        JointLimitsError: The limits contradict each other, or a limit that the handle
            needs is missing.
    """
    if mode is LimitMode.RATE:
        return _RATE[quantity](joint, limits)
    if soft_limits is None:
        return _SATURATION[quantity](joint, limits)
    return _SOFT[quantity](joint, limits, soft_limits)
