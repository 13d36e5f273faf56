"""Move joints smoothly within limits: at a velocity while told to, or after positions.

Velocities count for as long as they are repeated; positions arrive 10 to 100 times a
second, e.g. from a policy.
"""

from dataclasses import replace
from typing import ClassVar

from typing_extensions import override

from station.controllers.set_point_controller import (
    CommandInterfaceT,
    ControlledJoints,
    JointPidGroup,
    JointQuantity,
    JointSetPointController,
    pid_parameters,
)
from station.controllers.smoothed_motion.axis_limits import (
    LIMIT_PARAMETERS,
    MAX_LEAD,
    AxisLimits,
    read_axis_limits,
    read_max_lead,
)
from station.controllers.smoothed_motion.motion_generator import MotionGenerator
from station.core.control.sample_columns import SampleColumns
from station.core.declared_parameter import DeclaredParameter
from station.core.description.robot_description import JointDescription
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
)
from station.core.numerics.joint_errors import JointErrors
from station.core.numerics.pid import PidGains
from station.core.parameters import Parameters
from station.memory.doubles import Doubles, put, zeros

LONGEST_TIMEOUT = 1.0
"""Longest validity of a set-point [s], so that set-points must be repeated."""
_LOOK_AHEAD = 0.02
"""Time for which joints that are far from their limits are not watched [s]."""


class SmoothedMotionController(JointSetPointController[CommandInterfaceT]):
    """Generates a smooth motion from set-points, and commands the joints along it.

    When the controller starts, and when no set-point arrives in time, the joints come
    to rest within the limits and hold. A subclass defines what a set-point means.

    Over a position interface the generated positions are commanded. Over an effort
    interface one PID per joint computes efforts from the errors of position and
    velocity. The generated motion then must not run away from a blocked joint, or the
    joint would leap when it is free again: while a joint is more than `max_lead`
    behind, the generated motion comes to rest, until the joint has come nearer or the
    set-point leads back.

    Parameters: `joints`; `max_velocity`, `max_acceleration`, `max_jerk`, see
    `read_axis_limits`; `command_timeout` [s], 0.2 by default, at most 1.0;
    `command_timeout_action`, `hold` or `stop`. `robot_description` in this or an outer
    namespace gives types and limits of the joints. For efforts also the gains of every
    joint, see `PidGains.of_joints`, and `max_lead`, see `read_max_lead`.

    Attributes:
        limits: Limits of the generated motion.
        generator: The generated motion.
    """

    needs_description: ClassVar[bool] = True
    default_timeout: ClassVar[float] = 0.2
    longest_timeout: ClassVar[float] = LONGEST_TIMEOUT
    limits: AxisLimits
    generator: MotionGenerator
    sampled: SampleColumns
    _pids: JointPidGroup | None
    _desired: Doubles
    _desired_rates: Doubles
    _errors: JointErrors
    _rate_errors: JointErrors
    _error_column: Doubles
    _max_lead: list[float]

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        common = (*super().declared_parameters(), *LIMIT_PARAMETERS)
        if not issubclass(cls.hardware_interface, EffortJointInterface):
            return common
        position, effort = JointQuantity.POSITION, JointQuantity.EFFORT
        return (*common, MAX_LEAD, *pid_parameters(error=position, command=effort))

    @override
    def init(self, interface: CommandInterfaceT, params: Parameters) -> None:
        super().init(interface, params)
        self.limits = read_axis_limits(params, self.joints)
        self.generator = MotionGenerator(self.limits)
        if self.quantity is JointQuantity.VELOCITY and self.set_points is not None:
            self.set_points.elements = [
                replace(element, minimum=-bound, maximum=bound)
                for element, bound in zip(
                    self.set_points.elements, self.limits.velocity, strict=True
                )
            ]
        self._pids, self._max_lead = None, []
        if isinstance(interface, EffortJointInterface):
            self._max_lead = read_max_lead(params, self.joints)
            self._pids = JointPidGroup(
                self.joints,
                PidGains.of_joints(params, self.joint_names),
                places=PidGains.places(params, self.joint_names),
                error=JointQuantity.POSITION,
                command=JointQuantity.EFFORT,
                commands=self.memory.commands,
            )
            self.tunables = self._pids.tunables
        self._compare_in(self.memory)

    def _compare_in(self, memory: ControlledJoints) -> None:
        """Compare the generated motion with the measured values of the joints."""
        size, pids = memory.size, self._pids
        self._desired, self._desired_rates = zeros(size), zeros(size)
        errors = zeros(size) if pids is None else pids.errors
        rate_errors = zeros(size) if pids is None else pids.rates
        self._errors = JointErrors(self._desired, memory.positions, errors)
        for index, bound in enumerate(self._max_lead):
            self._errors.set_bound(index, bound)
        self._rate_errors = JointErrors(
            self._desired_rates, memory.velocities, rate_errors
        )
        self._error_column = errors
        columns = (self._desired, memory.positions, errors, memory.commands)
        self.sampled = SampleColumns(columns)

    def steer(self, set_point: list[float], period: float) -> None:
        """Set the target of the generator in this cycle.

        Args:
            set_point: The set-point in force, shape (n,).
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError

    def heading(self, set_point: list[float]) -> list[float]:
        """Return numbers whose signs are the directions of the motion, shape (n,).

        Args:
            set_point: The set-point in force, shape (n,).
        """
        raise NotImplementedError

    def wait(self) -> None:
        """Let the generated motion come to rest in this cycle instead of `steer`."""
        self.generator.brake()

    @override
    def starting(self, time: float) -> None:
        self.generator.start(self.group.get_positions(), self.group.get_velocities())
        put(self._desired, self.generator.positions)
        if self._pids is not None:
            self._pids.reset()
        super().starting(time)

    @override
    def update(self, time: float, period: float) -> None:
        """Command the joints along the motion; report its positions as desired."""
        set_point = self.newest_set_point()
        memory, generator, pids = self.memory, self.generator, self._pids
        if memory.is_copy:
            memory.read()
        if pids is not None and self._runs_away(set_point):
            self.wait()
        else:
            self.steer(set_point, period)
        generator.advance(period)
        put(self._desired, generator.positions)
        self._errors.compare()
        if pids is None:
            memory.commands[:] = self._desired
        else:
            put(self._desired_rates, generator.velocities)
            self._rate_errors.compare()
            pids.group.compute_commands(period, rates_known=True)
        if memory.is_copy:
            memory.write()
        self.sampled.keep(time)

    def _runs_away(self, set_point: list[float]) -> bool:
        """Return whether a joint is too far behind and would fall behind further."""
        self._errors.compare()
        if not self._errors.exceeds():
            return False
        behind = zip(
            self._error_column, self.heading(set_point), self._max_lead, strict=True
        )
        return any(
            abs(error) > bound and error * direction > 0.0
            for error, direction, bound in behind
        )


class JointJogController(SmoothedMotionController[CommandInterfaceT]):
    """Moves each joint at the velocity of the set-point, while a button is held.

    Every set-point is a heartbeat: when no set-point arrives within `command_timeout`,
    or the set-point is zero, the joints come to rest. A joint brakes early enough to
    stop at its position limits, and may move back from beyond them.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.VELOCITY
    # For how long the joints need not be watched [s].
    _far_for: float

    @override
    def heading(self, set_point: list[float]) -> list[float]:
        return set_point

    @override
    def starting(self, time: float) -> None:
        self._far_for = 0.0
        super().starting(time)

    @override
    def wait(self) -> None:
        self._far_for = 0.0
        super().wait()

    @override
    def steer(self, set_point: list[float], period: float) -> None:
        self._far_for -= period
        if self._far_for > 0.0:
            self.generator.go_at(set_point)
            return
        moving = self.generator.velocities
        if not any(set_point) and not any(moving):
            self.generator.brake()
        elif self._is_far(_LOOK_AHEAD + period):
            self._far_for = _LOOK_AHEAD
            self.generator.go_at(set_point)
        else:
            self.generator.go_at(self._allowed(set_point, period))

    def _is_far(self, duration: float) -> bool:
        """Return whether no joint can come near its limits by any command.

        Args:
            duration: Time for which the command may act before the joint brakes [s].
        """
        limits, generator = self.limits, self.generator
        for joint, position, velocity, acceleration, jerk in zip(
            self.joints,
            generator.positions,
            generator.velocities,
            limits.acceleration,
            limits.jerk,
            strict=True,
        ):
            ramp = acceleration / jerk
            # The velocity still grows while an acceleration ends.
            speed = abs(velocity) + acceleration * (duration + 0.5 * ramp)
            braking = speed / acceleration + 2.0 * ramp
            way = speed * (duration + braking)
            if not joint.lower + way < position < joint.upper - way:
                return False
        return True

    def _allowed(self, set_point: list[float], period: float) -> list[float]:
        """Return the set-point without velocities that lead beyond a limit."""
        limits, ends = self.limits, self.generator.resting_positions()
        moving = self.generator.velocities
        allowed = []
        for index, wanted in enumerate(set_point):
            # The braking distance can grow by this much until the next cycle.
            growth = limits.acceleration[index] ** 2 / limits.jerk[index]
            margin = period * (3.0 * abs(moving[index]) + growth)
            allowed.append(_within(self.joints[index], wanted, ends[index], margin))
        return allowed


class PositionJointJogController(JointJogController[PositionJointInterface]):
    """Jogs joints by position commands."""


class EffortJointJogController(JointJogController[EffortJointInterface]):
    """Jogs joints by effort commands."""


def _within(
    joint: JointDescription, velocity: float, end: float, margin: float
) -> float:
    """Return the velocity, or 0 when it would lead beyond the limits of the joint.

    Args:
        joint: The joint.
        velocity: Desired velocity [rad/s or m/s].
        end: Position at which the joint would rest if it braked now [rad or m].
        margin: Distance before the limit at which to brake [rad or m].
    """
    if (velocity > 0.0 and end + margin >= joint.upper) or (
        velocity < 0.0 and end - margin <= joint.lower
    ):
        return 0.0
    return velocity


class JointStreamingController(SmoothedMotionController[CommandInterfaceT]):
    """Moves to the newest set-point on the fastest way that the limits allow.

    The joints would rest at a set-point and all arrive there together, unless another
    set-point replaces it. Set-points may arrive at any rate; the motion between them is
    smooth. When no set-point arrives within `command_timeout`, the joints come to rest
    and hold.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION

    def __init__(self) -> None:
        super().__init__()
        self._followed: list[float] = []
        self._resting: list[float] = []

    @override
    def rest(self) -> list[float]:
        """Return the positions at which the joints rest if they brake now, (n,)."""
        self._resting = self.generator.resting_positions()
        return self._resting

    @override
    def heading(self, set_point: list[float]) -> list[float]:
        here = self.generator.positions
        return [there - now for there, now in zip(set_point, here, strict=True)]

    @override
    def wait(self) -> None:
        self._followed = []
        super().wait()

    @override
    def steer(self, set_point: list[float], period: float) -> None:
        # Set-points are replaced, never changed: an identical list is the same target.
        if set_point is self._followed:
            return
        self._followed = set_point
        if set_point is self._resting:
            self.generator.brake()
        else:
            self.generator.go_to(set_point)


class PositionJointStreamingController(
    JointStreamingController[PositionJointInterface]
):
    """Follows streamed positions by position commands."""


class EffortJointStreamingController(JointStreamingController[EffortJointInterface]):
    """Follows streamed positions by effort commands."""
