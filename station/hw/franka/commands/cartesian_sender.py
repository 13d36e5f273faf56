"""Filter, limit and send the poses or the twists of a controller.

Poses are predicted for the arm cycles in which a slow or late loop sends no command.

Source: libfranka@0.9.2 src/lowpass_filter.cpp, cartesianLowpassFilter;
src/rate_limiting.cpp, limitRate; src/control_loop.cpp, convertMotion.
"""

from collections.abc import Iterable, Sequence
from math import sqrt
from typing import TYPE_CHECKING

from station.core.errors import InvalidCommandError
from station.core.geometry.guard import SLOWED
from station.core.numerics.command_rates import filter_commands, limited
from station.core.numerics.rigid_motion import displace, rotation_between, twist_between
from station.hw.franka.arm.receiver import CARTESIAN
from station.memory.doubles import Doubles, doubles, own, put, zeros
from station.memory.functions import square_root
from station.memory.vectors import copy_into, differ

if TYPE_CHECKING:
    from station.core.franka.franka_robot_state import RobotState
    from station.core.geometry.guard import Guard
    from station.hw.franka.arm.robot_arm import RobotArm

# Length below which a vector has no direction.
_TINY = 1e-15
# The .pxd declares these as C numbers.
_INF = float("inf")
_SLOWED = SLOWED
_CARTESIAN = CARTESIAN
_POSE = 16
_ELBOW = 2
_KEPT = 3
FASTEST_RETURN = 25.0
"""Fastest decay rate of the offset between commanded and predicted poses [1/s]; the
offset decays as a critically damped system of third order."""
# Accelerations that the joints can follow while the offset decays: translation
# [m/s^2], rotation [rad/s^2] and elbow [rad/s^2].
_SCALES = (1.0, 1.0, 1.0, 3.0, 3.0, 3.0, 2.0)
# Factors of the peak acceleration of a decay at rate k: _FROM_OFFSET k^2 x for an
# initial offset x, _FROM_RATE k v for an initial rate v. Maxima of the closed forms.
_FROM_OFFSET, _FROM_RATE = 0.23, 0.80
_NEGLIGIBLE = 1e-12


def limit_vector(
    vector: Doubles,
    start: int,
    last_velocity: Doubles,
    last_acceleration: Doubles,
    bounds: Doubles,
    share: float,
    period: float,
) -> None:
    """Replace a velocity by the nearest velocity that all limits allow.

    Close to the velocity limit the acceleration is limited further, so that it can
    reach zero at the limit without exceeding the jerk limit.

    Args:
        vector: Holds the new velocity [m/s or rad/s] in three numbers.
        start: Index of the first of the three numbers in all vectors.
        last_velocity: Velocity of the last command [m/s or rad/s].
        last_acceleration: Acceleration of the last command [m/s^2 or rad/s^2].
        bounds: Largest norms of velocity, acceleration and jerk, each > 0.
        share: Share of the bounds that is allowed, > 0.
        period: Duration of a cycle, > 0 [s].

    Source:
        libfranka@0.9.2 src/rate_limiting.cpp, limitRate of a vector.
    """
    fastest, rate, jerk = share * bounds[0], share * bounds[1], share * bounds[2]
    i, j, k = start, start + 1, start + 2
    v0, v1, v2 = last_velocity[i], last_velocity[j], last_velocity[k]
    a0, a1, a2 = last_acceleration[i], last_acceleration[j], last_acceleration[k]
    x = ((vector[i] - v0) / period - a0) / period
    y = ((vector[j] - v1) / period - a1) / period
    z = ((vector[k] - v2) / period - a2) / period
    size = square_root(x * x + y * y + z * z)
    scale = 0.0
    if size > _TINY:
        scale = (jerk if jerk < size else size) / size
    x, y, z = (
        a0 + scale * x * period,
        a1 + scale * y * period,
        a2 + scale * z * period,
    )
    size = square_root(x * x + y * y + z * z)
    step = 0.0
    if size > _TINY:
        x, y, z = x / size, y / size, z / size
        along = x * v0 + y * v1 + z * v2
        # Distance to the speed limit along this direction: the root of a quadratic.
        room = along * along - (v0 * v0 + v1 * v1 + v2 * v2) + fastest * fastest
        safe = jerk / rate * (square_root(room if room > 0.0 else 0.0) - along)
        if rate < safe:
            safe = rate
        # Already too fast, or NaN: no step in this direction.
        if not safe > 0.0:
            safe = 0.0
        step = (safe if safe < size else size) * period
    elif size <= _TINY:
        x, y, z = 0.0, 0.0, 0.0
    vector[i] = v0 + x * step
    vector[j] = v1 + y * step
    vector[k] = v2 + z * step


class PoseRates:
    """Filters and limits the poses or the twists that are sent to an arm.

    Each command is compared with the last one that the arm reports.

    Args:
        state: The arm's state.
        translation: Largest velocity, acceleration and jerk of the translation.
        rotation: Largest velocity, acceleration and jerk of the rotation.
        elbow: Largest velocity, acceleration and jerk of the elbow.
        pose_share: Share of the limits of the rotation that a pose may use.
        period: Duration of a cycle, > 0 [s].

    Attributes:
        gain: Share of a new command in the low-pass; 1 is off.
        is_limiting: Whether the rates are limited.
        sent_pose: The pose to send, 16 numbers.
        sent_twist: The twist to send, shape (6,).
        sent_elbow: The elbow to send, see `filter_elbow`.
    """

    def __init__(
        self,
        state: "RobotState",
        *,
        translation: Iterable[float],
        rotation: Iterable[float],
        elbow: Iterable[float],
        pose_share: float,
        period: float,
    ) -> None:
        field = state.doubles
        self.pose = field("O_T_EE_c")
        self.twist = field("O_dP_EE_c")
        self.acceleration = field("O_ddP_EE_c")
        self.elbow = field("elbow_c")
        self.elbow_velocity = field("delbow_c")
        self.elbow_acceleration = field("ddelbow_c")
        self.translation = own(translation)
        self.rotation = own(rotation)
        self.elbow_limits = own(elbow)
        self.pose_share = pose_share
        self.period = period
        self.gain = 1.0
        self.is_limiting = False
        self.sent_pose = zeros(16)
        self.sent_twist = zeros(6)
        self.sent_elbow = zeros(2)
        self.way = zeros(6)

    def filter_pose(self, pose: Doubles, passes: bool) -> None:  # noqa: FBT001 - C
        """Compute the pose to send.

        Args:
            pose: The commanded pose, 16 numbers.
            passes: Whether the low-pass lets this command pass unchanged.
        """
        last, way, sent, gain = self.pose, self.way, self.sent_pose, self.gain
        if gain < 1.0 and not passes:
            rotation_between(last, pose, way)
            for i in range(3):
                way[3 + i] = gain * way[i]
                way[i] = gain * (pose[12 + i] - last[12 + i])
            displace(last, way, 1.0, sent)
        else:
            copy_into(sent, 0, pose, 16)
        # Filter first, as in libfranka, so that the limits hold for what is sent.
        if self.is_limiting:
            twist_between(last, sent, self.period, way)
            self.limit(way, self.pose_share)
            displace(last, way, self.period, sent)

    def filter_twist(self, twist: Doubles) -> None:
        """Compute the twist to send.

        Args:
            twist: The commanded twist [m/s, rad/s], shape (6,).
        """
        filter_commands(twist, self.twist, self.gain, _INF, self.sent_twist, 6)
        if self.is_limiting:
            self.limit(self.sent_twist, 1.0)

    def filter_elbow(self, elbow: Doubles, passes: bool) -> None:  # noqa: FBT001 - C
        """Compute the elbow to send.

        Args:
            elbow: Position of joint 3 [rad] and sign of joint 4, shape (2,).
            passes: As for `filter_pose`.
        """
        last, sent, limits = self.elbow, self.sent_elbow, self.elbow_limits
        gain = 1.0 if passes else self.gain
        filter_commands(elbow, last, gain, _INF, sent, 1)
        # The sign of joint 4 is a choice and is not filtered.
        sent[1] = elbow[1]
        if self.is_limiting:
            velocity = limited(
                (sent[0] - last[0]) / self.period,
                self.elbow_velocity[0],
                self.elbow_acceleration[0],
                limits[1],
                limits[2],
                -limits[0],
                limits[0],
                self.period,
            )
            sent[0] = last[0] + velocity * self.period

    def approach(self, twist: Doubles) -> None:
        """Compute the pose to send: one cycle along a twist, within the limits.

        Args:
            twist: The twist [m/s, rad/s], shape (6,).
        """
        copy_into(self.way, 0, twist, 6)
        self.limit(self.way, self.pose_share)
        displace(self.pose, self.way, self.period, self.sent_pose)

    def slow(self, twist: Doubles) -> None:
        """Compute the twist to send: a twist within the limits.

        Args:
            twist: The twist [m/s, rad/s], shape (6,).
        """
        copy_into(self.sent_twist, 0, twist, 6)
        self.limit(self.sent_twist, 1.0)

    def limit(self, twist: Doubles, rotation_share: float) -> None:
        """Replace a twist by the nearest twist that all limits allow.

        Args:
            twist: The twist [m/s, rad/s], shape (6,).
            rotation_share: Share of the limits of the rotation that is allowed.
        """
        v, a, period = self.twist, self.acceleration, self.period
        limit_vector(twist, 0, v, a, self.translation, 1.0, period)
        limit_vector(twist, 3, v, a, self.rotation, rotation_share, period)


class _Command:
    """A pose and an elbow, with the arm cycle in which they were commanded."""

    def __init__(self, pose: Doubles, elbow: Sequence[float], cycle: int) -> None:
        self.pose = pose
        self.elbow = elbow
        self.cycle = cycle

    def way_to(self, other: "_Command") -> list[float]:
        """Return the twist and the elbow that lead to another command, shape (7,)."""
        way = zeros(6)
        twist_between(self.pose, other.pose, 1.0, way)
        # Elbows with different signs have no distance.
        same = self.elbow[1] == other.elbow[1]
        return [*way, other.elbow[0] - self.elbow[0] if same else 0.0]

    def moved(self, way: Sequence[float], cycles: int) -> "_Command":
        """Return this command, moved by a twist and an elbow, in a later cycle."""
        elbow, pose = self.elbow, zeros(_POSE)
        bent = [elbow[0] + way[6], elbow[1]] if elbow[1] else elbow
        displace(self.pose, doubles(way[:6]), 1.0, pose)
        return _Command(pose, bent, self.cycle + cycles)


class PoseBridge:
    """Extrapolates poses between two commands, and returns smoothly to the commands.

    The arm takes a pose in each of its own cycles. A pose that stands still for some
    cycles, or jumps by the distance of several cycles, exceeds the limits of the
    joints; the limits of the end effector, which the commands obey, allow much more.

    The sent pose is the sum of a prediction of the commands and an offset. If a command
    differs from its prediction in position, velocity or acceleration, the prediction
    jumps to the command and the offset jumps by the opposite amount, so that the sum
    stays continuous; then the offset decays. With a loop as fast as the arm, poses pass
    unchanged and are only stored. Control thread only.

    Args:
        period: Duration of a cycle of the arm [s], > 0.

    Attributes:
        is_on_commands: Whether the sent poses equal the commanded ones.
        pose: The pose to send if they differ, 16 numbers.
        elbow: The elbow to send if they differ, shape (2,).
    """

    def __init__(self, period: float) -> None:
        self.period = period
        # The last three commands, and their cycles: that of the last one, of the one
        # before, and of the one before that.
        self.poses = zeros(_KEPT * _POSE)
        self.elbows = zeros(_KEPT * _ELBOW)
        self.newest = 0
        self.cycle = 0
        self.last_cycle, self.earlier_cycle, self.before_cycle = 0, -1, -2
        self.is_on_commands = True
        self.pose = zeros(_POSE)
        self.elbow = zeros(_ELBOW)
        self.rest_at([0.0] * _POSE, [0.0] * _ELBOW)

    def rest_at(self, pose: Sequence[float], elbow: Sequence[float]) -> None:
        """Rest at a pose, 16 numbers, and an elbow, 2 numbers."""
        # As if the pose had been commanded three times, so that velocity and
        # acceleration of the prediction are 0.
        for self.cycle in (-3, -2, -1):
            self.note_next(doubles(pose), doubles(elbow))
        # First and second difference of the prediction per cycle.
        self._step, self._bend = [0.0] * 7, [0.0] * 7
        self._offset, self._rate, self._rise = [0.0] * 7, [0.0] * 7, [0.0] * 7
        self._gain = FASTEST_RETURN * self.period
        self.is_on_commands = True

    def is_expected(self) -> bool:
        """Return whether the last two cycles had a command each, and no offset is left.

        The next command then is stored and sent unchanged.
        """
        return self.is_on_commands and self.cycle == self.before_cycle + 2

    def note_next(self, pose: Doubles, elbow: Doubles) -> None:
        """Store the command of the next cycle: a pose, 16 numbers, and an elbow, 2."""
        self.cycle += 1
        newest = self.newest + 1
        if newest == _KEPT:
            newest = 0
        self.newest = newest
        copy_into(self.poses, _POSE * newest, pose, _POSE)
        copy_into(self.elbows, _ELBOW * newest, elbow, _ELBOW)
        self.before_cycle, self.earlier_cycle = self.earlier_cycle, self.last_cycle
        self.last_cycle = self.cycle

    def repeats(self, pose: Doubles) -> bool:
        """Return whether a pose equals the last stored pose."""
        start = _POSE * self.newest
        return not differ(self.poses[start : start + _POSE], pose, _POSE)

    def pass_on(self, pose: Doubles, elbow: Doubles) -> None:
        """Store a command, and compute the pose to send for it.

        Args:
            pose: The commanded pose, 16 numbers.
            elbow: Position of joint 3 [rad] and sign of joint 4, or zeros, shape (2,).
        """
        is_regular = self.cycle == self.before_cycle + 2  # one command in each cycle
        expected = None if is_regular else self._expected(self.cycle + 1)
        self.note_next(pose, elbow)
        command = self._command(0)
        if not self.is_on_commands:
            self._fade()
        if expected is not None:
            step, bend = self._step, self._bend
            self._estimate()
            self._leap(command.way_to(expected), step, bend)
        self._send(command)

    def predict(self) -> None:
        """Compute the pose to send in an arm cycle without a command."""
        if self.cycle == self.last_cycle:
            self._estimate()
            # The prediction keeps its velocity; its acceleration decays in the offset.
            bend, self._bend = self._bend, [0.0] * 7
            self._leap([0.0] * 7, self._step, bend)
        self.cycle += 1
        if not self.is_on_commands:
            self._fade()
        self._send(self._expected(self.cycle))

    def _command(self, age: int) -> _Command:
        """Return the last command, or the one that is `age` commands older."""
        cycles = (self.last_cycle, self.earlier_cycle, self.before_cycle)
        place = (self.newest - age) % _KEPT
        pose = self.poses[_POSE * place : _POSE * place + _POSE]
        elbow = self.elbows[_ELBOW * place : _ELBOW * place + _ELBOW]
        return _Command(doubles(pose), list(elbow), cycles[age])

    def _expected(self, cycle: int) -> _Command:
        """Advance the prediction to `cycle`, the next cycle, and return it."""
        cycles = cycle - self.last_cycle
        if cycles == 1 and any(self._bend):
            self._step = [v + a for v, a in zip(self._step, self._bend, strict=True)]
        return self._command(0).moved([cycles * value for value in self._step], cycles)

    def _estimate(self) -> None:
        """Estimate velocity and acceleration of the prediction from three commands."""
        last, earlier, before = (self._command(age) for age in range(3))
        first = earlier.cycle - before.cycle
        second = last.cycle - earlier.cycle
        older, newer = before.way_to(earlier), earlier.way_to(last)
        # The mean velocity over a longer step is the velocity in its middle.
        self._bend = [
            2.0 * (v / second - u / first) / (first + second)
            for u, v in zip(older, newer, strict=True)
        ]
        self._step = [
            v / second + 0.5 * (second - 1) * change
            for v, change in zip(newer, self._bend, strict=True)
        ]

    def _leap(
        self, way: Sequence[float], step: Sequence[float], bend: Sequence[float]
    ) -> None:
        """Change the offset so that the sent pose stays continuous.

        Args:
            way: Displacement from the new prediction to the old one, shape (7,).
            step: Change of the old prediction per cycle, shape (7,).
            bend: Second change of the old prediction per cycle, shape (7,).
        """
        for i in range(7):
            self._offset[i] += way[i]
            self._rate[i] += step[i] - self._step[i]
            self._rise[i] += bend[i] - self._bend[i]
        rate = _rate_of_return(self._offset, self._rate, self.period)
        self._gain = rate * self.period
        self.is_on_commands = False

    def _fade(self) -> None:
        """Let the offset decay by a cycle; a negligible offset becomes zero."""
        k = self._gain
        for i in range(7):
            x, v, a = self._offset[i], self._rate[i], self._rise[i]
            a -= k * (k * (k * x + 3.0 * v) + 3.0 * a)
            v += a
            self._offset[i], self._rate[i], self._rise[i] = x + v, v, a
        if max(map(abs, (*self._offset, *self._rate, *self._rise))) < _NEGLIGIBLE:
            self._offset, self._rate, self._rise = [0.0] * 7, [0.0] * 7, [0.0] * 7
            self.is_on_commands = True

    def _send(self, course: _Command) -> None:
        if not self.is_on_commands:
            course = course.moved(self._offset, 0)
        put(self.pose, course.pose)
        put(self.elbow, course.elbow)


def _rate_of_return(
    offset: Sequence[float], rate: Sequence[float], period: float
) -> float:
    """Return the decay rate at which no acceleration exceeds its scale [1/s].

    Args:
        offset: The offset [m, rad], shape (7,).
        rate: Change of the offset per cycle of the arm [m, rad], shape (7,).
        period: Duration of the cycle [s].
    """
    x, v = (
        max(abs(value) / scale for value, scale in zip(values, _SCALES, strict=True))
        for values in (offset, rate)
    )
    x, v = _FROM_OFFSET * x, _FROM_RATE * v / period
    # The positive solution of x k^2 + v k = 1.
    k = 2.0 / (v + sqrt(v * v + 4.0 * x)) if x or v else FASTEST_RETURN
    return min(FASTEST_RETURN, k)


class CartesianSender:
    """Sends the poses or the twists of a controller, one per cycle of the arm.

    Args:
        arm: The arm.
        rates: Filters and limits the poses and twists.
        pose: The commanded pose, 16 numbers.
        twist: The commanded twist [m/s, rad/s], shape (6,).
        pose_elbow: The elbow of a pose: position of joint 3 [rad] and sign of joint 4,
            or two zeros to let the arm choose; shape (2,).
        twist_elbow: The elbow of a twist, as for a pose.
        filters_first: Whether the low-pass acts on the first pose of a motion, too.

    Attributes:
        guard: Keeps the arm clear of its scene; None without a scene.
    """

    def __init__(
        self,
        arm: "RobotArm",
        rates: PoseRates,
        *,
        pose: Doubles,
        twist: Doubles,
        pose_elbow: Doubles,
        twist_elbow: Doubles,
        filters_first: bool,
    ) -> None:
        self.arm = arm
        self.receiver = arm.receiver()
        self.rates = rates
        self.bridge = PoseBridge(self.rates.period)
        self.pose = pose
        self.twist = twist
        self.pose_elbow = pose_elbow
        self.twist_elbow = twist_elbow
        self.filters_first = filters_first
        self.is_first = False
        self.guard: Guard | None = None

    def begin_motion(self, gain: float, is_limiting: bool) -> None:  # noqa: FBT001 - C
        """Rest at the commanded pose; forget all earlier commands.

        Args:
            gain: Share of a new command in the low-pass; 1 is off.
            is_limiting: Whether the rates are limited.
        """
        self.rates.gain = gain
        self.rates.is_limiting = is_limiting
        self.bridge.rest_at(self.pose, self.arm.state.elbow_d)
        self.is_first = True

    def send_pose(self, is_new: bool) -> None:  # noqa: FBT001 - positional in C
        """Send a pose: the commanded pose, or one that bridges a gap.

        Args:
            is_new: Whether controllers have updated since the last call.

        Raises:
            InvalidCommandError: The arm refuses the pose or the elbow, or it can no
                longer stop clear of its scene.
        """
        rates, bridge = self.rates, self.bridge
        pose, elbow, is_known = self.pose, self.pose_elbow, False
        is_first, self.is_first = self.is_first, False
        if not is_new:
            bridge.predict()
        elif bridge.is_expected():
            # An arm at rest at this pose would get the same pose again, because the
            # filter is at rest, too.
            is_known = (
                not is_first
                and self.receiver.rests_at_pose()
                and not has_elbow(elbow)
                and bridge.repeats(pose)
            )
            bridge.note_next(pose, elbow)
        else:
            bridge.pass_on(pose, elbow)
        if not is_new or not bridge.is_on_commands:
            pose, elbow = bridge.pose, bridge.elbow
        passes = is_first and not self.filters_first
        if not is_known:
            rates.filter_pose(pose, passes)
        guard = self.guard
        if guard is not None:
            verdict = guard.limit_pose(rates.sent_pose)
            if verdict == _SLOWED:
                rates.approach(guard.twist)
            elif verdict:
                raise InvalidCommandError(guard.reflex(), remedy="Move away.")
        if has_elbow(elbow):
            rates.filter_elbow(elbow, passes)
            bent = [rates.sent_elbow[0], rates.sent_elbow[1]]
            self.arm.command_cartesian_pose(rates.sent_pose, bent)
        elif not self.receiver.receive(rates.sent_pose, _CARTESIAN):
            self.arm.command_cartesian_pose(rates.sent_pose)

    def send_twist(self) -> None:
        """Send the commanded twist.

        Raises:
            InvalidCommandError: As for `send_pose`.
        """
        rates, elbow = self.rates, self.twist_elbow
        bent: list[float] | None = None
        rates.filter_twist(self.twist)
        guard = self.guard
        if guard is not None:
            verdict = guard.limit_twist(rates.sent_twist)
            if verdict == _SLOWED:
                rates.slow(guard.twist)
            elif verdict:
                raise InvalidCommandError(guard.reflex(), remedy="Move away.")
        if has_elbow(elbow):
            rates.filter_elbow(elbow, False)  # noqa: FBT003 - positional in C
            bent = [rates.sent_elbow[0], rates.sent_elbow[1]]
        self.arm.command_cartesian_velocity(rates.sent_twist, bent)


def has_elbow(elbow: Doubles) -> bool:
    """Return whether an elbow, shape (2,), is commanded; zeros let the arm choose."""
    return elbow[0] != 0.0 or elbow[1] != 0.0
