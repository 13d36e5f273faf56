"""Drive a base by the velocities of its left and right wheels.

Source: ros_controllers@678b92a diff_drive_controller/src/diff_drive_controller.cpp,
DiffDriveController.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, inf, isfinite, pi, sin

from typing_extensions import override

from station.core.control.controller import Controller, ControllerSample
from station.core.declared_parameter import (
    DeclaredParameter,
    NameKind,
    declare_boolean,
    declare_number,
    declare_numbers,
    declare_string,
    declare_strings,
)
from station.core.description.robot_description import ROBOT_DESCRIPTION
from station.core.description.urdf import wheel_radius, wheel_separation
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import ParameterError
from station.core.hardware.interfaces import JointGroup, VelocityJointInterface
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    read_command_timeout,
    timeout_parameters,
)
from station.core.toolbox.publish_timer import PublishTimer

_STRAIGHT = 10e-3
"""Turn in one cycle below which the second-order integration is used [rad]."""
_SHORTEST = 1e-4
"""Shortest time over which a velocity is estimated [s]."""


class Odometry:
    """Position, heading and velocity of a base. Control thread only.

    Args:
        separation: Distance between the two sides [m], > 0.
        radius: Radius of the wheels [m], > 0.
        window: Number of estimates over which velocities are averaged, > 0.

    Attributes:
        x: Position in the frame `odom` [m].
        y: Position [m].
        heading: Angle about z [rad].
        linear: Velocity forwards [m/s].
        angular: Velocity about z [rad/s].

    Source:
        ros_controllers@678b92a diff_drive_controller/src/odometry.cpp, Odometry;
        differs: the wheels' positions at the start count as the place where the base
        is, so that a start does not move it.
    """

    def __init__(self, separation: float, radius: float, window: int) -> None:
        self.x = self.y = self.heading = 0.0
        self.linear = self.angular = 0.0
        self._separation = separation
        self._radius = radius
        self._left = self._right = 0.0
        self._time = 0.0
        self._linear: deque[float] = deque(maxlen=window)
        self._angular: deque[float] = deque(maxlen=window)

    def forget_velocity(self, left: float, right: float, time: float) -> None:
        """Forget the velocity; position and heading stay.

        Args:
            left: Mean position of the left wheels [rad].
            right: Mean position of the right wheels [rad].
            time: Station time [s].
        """
        self._left, self._right = left * self._radius, right * self._radius
        self._time = time
        self._linear.clear()
        self._angular.clear()
        self.linear = self.angular = 0.0

    def follow_wheels(self, left: float, right: float, time: float) -> None:
        """Advance the pose by the angles by which the wheels have turned.

        Args:
            left: Mean position of the left wheels [rad].
            right: Mean position of the right wheels [rad].
            time: Station time [s].
        """
        left_way = left * self._radius - self._left
        right_way = right * self._radius - self._right
        self._left += left_way
        self._right += right_way
        linear = (left_way + right_way) / 2.0
        angular = (right_way - left_way) / self._separation
        self._integrate(linear, angular)
        elapsed = time - self._time
        if elapsed < _SHORTEST:
            return
        self._time = time
        self._linear.append(linear / elapsed)
        self._angular.append(angular / elapsed)
        self.linear = sum(self._linear) / len(self._linear)
        self.angular = sum(self._angular) / len(self._angular)

    def follow_commands(self, linear: float, angular: float, time: float) -> None:
        """Advance the pose by the velocities commanded since the last call.

        Args:
            linear: Velocity forwards [m/s].
            angular: Velocity about z [rad/s].
            time: Station time [s].
        """
        self.linear, self.angular = linear, angular
        elapsed = time - self._time
        self._time = time
        self._integrate(linear * elapsed, angular * elapsed)

    def _integrate(self, linear: float, angular: float) -> None:
        before = self.heading
        if abs(angular) < _STRAIGHT:
            direction = before + angular / 2.0
            self.x += linear * cos(direction)
            self.y += linear * sin(direction)
            self.heading = (before + angular + pi) % (2.0 * pi) - pi
            return
        self.heading = before + angular
        self.x += linear / angular * (sin(self.heading) - sin(before))
        self.y -= linear / angular * (cos(self.heading) - cos(before))


_KINDS = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True)
class SpeedLimiter:
    """The limits of one direction; infinite where there is none.

    Attributes:
        velocity: Smallest and largest velocity [m/s or rad/s].
        acceleration: Smallest and largest acceleration [m/s^2 or rad/s^2].
        jerk: Smallest and largest jerk [m/s^3 or rad/s^3].

    Source:
        ros_controllers@678b92a diff_drive_controller/src/speed_limiter.cpp,
        SpeedLimiter.
    """

    velocity: tuple[float, float] = (-inf, inf)
    acceleration: tuple[float, float] = (-inf, inf)
    jerk: tuple[float, float] = (-inf, inf)

    def limit(self, wanted: float, last: float, before: float, period: float) -> float:
        """Return the velocity nearest to the wanted one that respects the limits.

        Args:
            wanted: The wanted velocity [m/s or rad/s].
            last: The velocity of the last cycle.
            before: The velocity of the cycle before that.
            period: Duration of a cycle [s], >= 0.
        """
        change = wanted - last
        # The factor 2 is the original's; the jerk is half of what its name says.
        square = 2.0 * period * period
        if self.jerk != (-inf, inf):
            change_before = last - before
            bend = _clamp(change - change_before, self.jerk, square)
            change = change_before + bend
        if self.acceleration != (-inf, inf):
            change = _clamp(change, self.acceleration, period)
        low, high = self.velocity
        return min(max(last + change, low), high)


def limiter_parameters(axis: str, unit: str) -> tuple[DeclaredParameter, ...]:
    """Return the parameters of one direction.

    Args:
        axis: Its namespace, `linear/x` or `angular/z`.
        unit: Unit of its position.
    """
    found = []
    for kind, power in zip(_KINDS, ("s", "s^2", "s^3"), strict=True):
        found.append(
            declare_boolean(
                f"{axis}/has_{kind}_limits",
                f"whether the {kind} is limited",
                default=False,
            )
        )
        for end, text in (("max", "0"), ("min", f"-max_{kind}")):
            found.append(
                declare_number(
                    f"{axis}/{end}_{kind}",
                    f"{'largest' if end == 'max' else 'smallest'} {kind}",
                    unit=f"{unit}/{power}",
                    default_text=text,
                )
            )
    return tuple(found)


def read_limiter(params: Parameters, axis: str) -> SpeedLimiter:
    """Return the limits of one direction.

    Args:
        params: The controller's namespace.
        axis: `linear/x` or `angular/z`.

    Raises:
        ParameterError: A value is not a number, a smallest value is above 0, or a
            largest value is below 0.
    """
    inside = params.namespace(axis)
    return SpeedLimiter(*(_read_range(inside, kind) for kind in _KINDS))


def _read_range(params: Parameters, kind: str) -> tuple[float, float]:
    is_limited = params.get_bool(f"has_{kind}_limits", default=False)
    high = params.get_float(f"max_{kind}", 0.0)
    low = params.get_float(f"min_{kind}", -high)
    if not is_limited:
        return (-inf, inf)
    if not low <= 0.0 <= high:
        place = params.resolve(f"max_{kind}")
        raise ParameterError(
            f"Parameter '{place}' allows {low} to {high}; a range must contain 0.",
            remedy=f"Give max_{kind} >= 0 and min_{kind} <= 0.",
            details={"parameter": place},
        )
    return (low, high)


def _clamp(value: float, bounds: tuple[float, float], factor: float) -> float:
    return min(max(value, bounds[0] * factor), bounds[1] * factor)


_ZEROS = (0.0,) * 6


def _number(
    name: str, unit: str, default: float | None, text: str
) -> DeclaredParameter:
    return declare_number(
        name,
        text,
        default,
        unit,
        minimum=0.0,
        excludes_minimum=True,
        default_text="" if default is not None else "from the robot description",
    )


def _frame(name: str, default: str) -> DeclaredParameter:
    return declare_string(name, "name of a frame in the topic `odom`", default)


def _side(side: str) -> DeclaredParameter:
    return declare_strings(
        f"{side}_wheel",
        f"the joints of the {side} wheels, or one name",
        names=NameKind.JOINT,
    )


def _diagonal(name: str) -> DeclaredParameter:
    return declare_numbers(
        name,
        "diagonal of a covariance in the topic `odom`",
        _ZEROS,
        size=6,
        minimum=0.0,
    )


_LEFT, _RIGHT = _side("left"), _side("right")
_SEPARATION = _number("wheel_separation", "m", None, "distance of both sides")
_RADIUS = _number("wheel_radius", "m", None, "radius of the wheels")
_SEPARATION_FACTOR = _number(
    "wheel_separation_multiplier", "", 1.0, "factor of wheel_separation"
)
_RADIUS_FACTOR = _number("wheel_radius_multiplier", "", 1.0, "factor of wheel_radius")
_RATE = _number("publish_rate", "Hz", 50.0, "rate of the topics")
_TIMEOUT = _number("cmd_vel_timeout", "s", 0.5, "time after which a command expires")
_VALIDITY, _ACTION = timeout_parameters()
_VALIDITY_AND_ACTION = (
    replace(_VALIDITY, default=None, default_text=_TIMEOUT.name),
    _ACTION,
)
_WINDOW = _number(
    "velocity_rolling_window_size", "", 10.0, "cycles over which velocity is averaged"
)
_OPEN_LOOP = declare_boolean(
    "open_loop", "whether the odometry follows the commands", default=False
)
_PUBLISH_CMD = declare_boolean(
    "publish_cmd", "whether there is `cmd_vel_out`", default=False
)
_ENABLE_TF = declare_boolean("enable_odom_tf", "accepted; there is no tf", default=True)
_MULTIPLE = declare_boolean(
    "allow_multiple_cmd_vel_publishers",
    "accepted; leases decide who commands",
    default=True,
)
_PUBLISH_STATE = declare_boolean(
    "publish_joint_trajectory_controller_state",
    "whether there is `joint_trajectory_controller_state`, of the wheels",
    default=False,
)
_BASE_FRAME = _frame("base_frame_id", "base_link")
_ODOM_FRAME = _frame("odom_frame_id", "odom")
_POSE_COVARIANCE = _diagonal("pose_covariance_diagonal")
_TWIST_COVARIANCE = _diagonal("twist_covariance_diagonal")


class DiffDriveController(Controller[VelocityJointInterface]):
    """Drives a base at a velocity forwards and a velocity about z.

    A set-point is `cmd_vel`: linear x [m/s] and angular z [rad/s]. It expires after
    `cmd_vel_timeout` (or `command_timeout`), and the base brakes within its limits. The
    limits `linear/x` and `angular/z` are those of the original, and so are all other
    parameters.

    Attributes:
        odometry: Pose and velocity of the base.

    Source:
        DiffDriveController; differs: a set-point that is not finite is refused; the
        topic `odom` is published in the cycle in which it is due; a diagonal of a
        covariance is 0 when absent; the topics `cmd_vel` and tf of the original are the
        set-points and `odom` of this station.
    """

    odometry: Odometry
    own_parameters = (
        *(_LEFT, _RIGHT, _SEPARATION, _RADIUS, _SEPARATION_FACTOR, _RADIUS_FACTOR),
        *(_RATE, _TIMEOUT, _WINDOW, _OPEN_LOOP, _PUBLISH_CMD, _PUBLISH_STATE),
        *(_ENABLE_TF, _MULTIPLE, _BASE_FRAME, _ODOM_FRAME),
        *(_POSE_COVARIANCE, _TWIST_COVARIANCE),
        *_VALIDITY_AND_ACTION,
        *limiter_parameters("linear/x", "m"),
        *limiter_parameters("angular/z", "rad"),
    )

    @override
    def init(self, interface: VelocityJointInterface, params: Parameters) -> None:
        left, right = _names(params, _LEFT), _names(params, _RIGHT)
        if len(left) != len(right):
            _LEFT.refuse(
                params, left, f"as many wheels as right_wheel, which has {len(right)}"
            )
        separation, radius = _read_size(params, left[0], right[0])
        self._separation = separation * _SEPARATION_FACTOR.read_float(params)
        self._radius = radius * _RADIUS_FACTOR.read_float(params)
        self._linear = read_limiter(params, "linear/x")
        self._angular = read_limiter(params, "angular/z")
        self._is_open_loop = _OPEN_LOOP.read_bool(params)
        self._publishes_commands = _PUBLISH_CMD.read_bool(params)
        self._publishes_wheels = _PUBLISH_STATE.read_bool(params)
        self._message = _constant_part(params)
        self._timer = PublishTimer(_RATE.read_float(params))
        window = int(_WINDOW.read_float(params))
        self.odometry = Odometry(self._separation, self._radius, max(1, window))
        self.joint_names = [*left, *right]
        self._count = len(left)
        self._group = JointGroup([interface.get_handle(n) for n in self.joint_names])
        timeout, action = read_command_timeout(params, _TIMEOUT.read_float(params))
        self.set_points = SetPointPort(
            [SetPointElement("linear_x", "m/s"), SetPointElement("angular_z", "rad/s")],
            timeout=timeout,
        )
        self._active = ActiveSetPoint(
            self.set_points, action, "the base", lambda: [0.0, 0.0]
        )
        self._last = self._before = (0.0, 0.0)
        self._odom: dict[str, object] | None = None
        self._cmd_vel_out: dict[str, object] | None = None

    @override
    def starting(self, time: float) -> None:
        self._active.start_at_rest()
        self._last = self._before = (0.0, 0.0)
        self._group.set_commands([0.0] * len(self.joint_names))
        self._timer.start(time, at_once=False)
        self.odometry.forget_velocity(*self._sides(), time)

    @override
    def stopping(self, time: float) -> None:
        self._group.set_commands([0.0] * len(self.joint_names))

    @override
    def update(self, time: float, period: float) -> None:
        """Follow the wheels or the commands, then limit and send the newest command."""
        odometry = self.odometry
        if self._is_open_loop:
            odometry.follow_commands(*self._last, time)
        else:
            left_turn, right_turn = self._sides()
            if isfinite(left_turn + right_turn):
                odometry.follow_wheels(left_turn, right_turn, time)
        wanted = self._active.newest()
        last, before = self._last, self._before
        linear = self._linear.limit(wanted[0], last[0], before[0], period)
        angular = self._angular.limit(wanted[1], last[1], before[1], period)
        self._before, self._last = last, (linear, angular)
        across = angular * self._separation / 2.0
        left, right = (linear - across) / self._radius, (linear + across) / self._radius
        self._group.set_commands([left] * self._count + [right] * self._count)
        actual = [odometry.linear, odometry.angular]
        error = [w - a for w, a in zip(wanted, actual, strict=True)]
        # One command per number of the set-point: the velocities of both sides.
        self.sample = ControllerSample(
            time, list(wanted), actual, error, [linear, angular]
        )
        if self._timer.is_due(time):
            self._publish(time)

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `odom`, and if requested those of commands and wheels."""
        found: dict[str, Mapping[str, object]] = {}
        if self._odom is not None:
            found["odom"] = self._odom
        if self._cmd_vel_out is not None:
            found["cmd_vel_out"] = self._cmd_vel_out
        if self._publishes_wheels and self._odom is not None:
            found["joint_trajectory_controller_state"] = self._wheels()
        return found

    def _publish(self, time: float) -> None:
        odometry, message = self.odometry, self._message
        half = odometry.heading / 2.0
        self._odom = {
            "stamp": time,
            "frame_id": message["frame_id"],
            "child_frame_id": message["child_frame_id"],
            "position": [odometry.x, odometry.y, 0.0],
            "orientation": [0.0, 0.0, sin(half), cos(half)],
            "linear": [odometry.linear, 0.0, 0.0],
            "angular": [0.0, 0.0, odometry.angular],
            "pose_covariance_diagonal": message["pose_covariance_diagonal"],
            "twist_covariance_diagonal": message["twist_covariance_diagonal"],
        }
        if self._publishes_commands:
            linear, angular = self._last
            self._cmd_vel_out = {
                "stamp": time,
                "linear": [linear, 0.0, 0.0],
                "angular": [0.0, 0.0, angular],
            }

    def _wheels(self) -> dict[str, object]:
        linear, angular = self._last
        across = angular * self._separation / 2.0
        left, right = (linear - across) / self._radius, (linear + across) / self._radius
        return {
            "joint_names": self.joint_names,
            "desired_velocities": [left] * self._count + [right] * self._count,
            "actual_positions": self._group.get_positions(),
            "actual_velocities": self._group.get_velocities(),
        }

    def _sides(self) -> tuple[float, float]:
        """Return the mean positions of the left and of the right wheels [rad]."""
        positions, count = self._group.get_positions(), self._count
        return sum(positions[:count]) / count, sum(positions[count:]) / count


def _names(params: Parameters, side: DeclaredParameter) -> list[str]:
    """Return the wheels of one side, from a list or one name.

    Raises:
        ParameterError: The names are missing, not strings, or there are none.
    """
    if isinstance(params.get(side.name), str):
        return [params.get_str(side.name)]
    names = side.read_str_list(params)
    if not names:
        side.refuse(params, "an empty list", "a list of joints, or one name")
    return names


def _read_size(params: Parameters, left: str, right: str) -> tuple[float, float]:
    """Return separation and radius, from the parameters or the robot description.

    Raises:
        ParameterError: A value is missing and there is no robot description.
        RobotDescriptionError: The robot description does not have it either.
    """
    urdf = None
    if not (params.has(_SEPARATION.name) and params.has(_RADIUS.name)):
        xml = params.tree.get(ROBOT_DESCRIPTION)
        if not isinstance(xml, str):
            missing = _RADIUS if params.has(_SEPARATION.name) else _SEPARATION
            raise ParameterError(
                f"Parameter '{params.resolve(missing.name)}' is missing, and there is "
                "no robot description to read it from.",
                remedy=f"Give {missing.name} [m].",
                details={"parameter": params.resolve(missing.name)},
            )
        urdf = parse_urdf(xml)
    separation = (
        _SEPARATION.read_float(params)
        if urdf is None or params.has(_SEPARATION.name)
        else wheel_separation(urdf, left, right)
    )
    radius = (
        _RADIUS.read_float(params)
        if urdf is None or params.has(_RADIUS.name)
        else wheel_radius(urdf, left)
    )
    return separation, radius


def _constant_part(params: Parameters) -> dict[str, object]:
    _ENABLE_TF.read_bool(params)
    _MULTIPLE.read_bool(params)
    return {
        "frame_id": _ODOM_FRAME.read_str(params),
        "child_frame_id": _BASE_FRAME.read_str(params),
        "pose_covariance_diagonal": _POSE_COVARIANCE.read_float_list(params),
        "twist_covariance_diagonal": _TWIST_COVARIANCE.read_float_list(params),
    }
