"""Drive a base by the velocities of its left and right wheels.

Source: ros_controllers@678b92a diff_drive_controller/src/diff_drive_controller.cpp,
DiffDriveController; ros2_controllers@6.x diff_drive_controller/src.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import cos, isfinite, sin
from typing import ClassVar

from typing_extensions import override

from station.controllers.diff_drive_controller.odometry import Odometry
from station.controllers.diff_drive_controller.speed_limits import (
    limiter_parameters,
    read_limiter,
)
from station.core.control.chainable_controller import ChainableController, Reference
from station.core.control.controller import ControllerSample, require_interface
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
from station.core.errors import HardwareInterfaceError, ParameterError
from station.core.hardware.interfaces import JointGroup, VelocityJointInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    read_command_timeout,
    timeout_parameters,
)
from station.core.toolbox.publish_timer import PublishTimer
from station.memory.doubles import put, zeros

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


def _side(side: str) -> tuple[DeclaredParameter, DeclaredParameter]:
    text = f"the joints of the {side} wheels"
    return (
        declare_strings(
            f"{side}_wheel",
            f"{text}, or one name",
            names=NameKind.JOINT,
            default_text=f"{side}_wheel_names",
        ),
        declare_strings(
            f"{side}_wheel_names",
            f"{text}; the controller is then that of ROS 2",
            names=NameKind.JOINT,
            default_text=f"{side}_wheel",
        ),
    )


def _diagonal(name: str) -> DeclaredParameter:
    return declare_numbers(
        name,
        "diagonal of a covariance in the topic `odom`",
        _ZEROS,
        size=6,
        minimum=0.0,
    )


(_LEFT, _LEFT_NAMES), (_RIGHT, _RIGHT_NAMES) = _side("left"), _side("right")
_SEPARATION = _number("wheel_separation", "m", None, "distance of both sides")
_RADIUS = _number("wheel_radius", "m", None, "radius of the wheels")
_SEPARATION_FACTOR = _number(
    "wheel_separation_multiplier", "", 1.0, "factor of wheel_separation"
)
_RADIUS_FACTOR = _number("wheel_radius_multiplier", "", 1.0, "factor of wheel_radius")
_RADIUS_FACTORS = tuple(
    _number(f"{side}_wheel_radius_multiplier", "", 1.0, f"factor of the {side} radius")
    for side in ("left", "right")
)
_RATE = replace(
    _number("publish_rate", "Hz", None, "rate of the topics"),
    default_text="50; with left_wheel_names every cycle",
)
_TIMEOUT = replace(
    _number(
        "cmd_vel_timeout", "s", 0.5, "time after which a command expires; 0: never"
    ),
    excludes_minimum=False,
)
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
_POSITIONS = declare_boolean(
    "position_feedback",
    "whether the odometry follows positions; else velocities",
    default=True,
)
_PUBLISH_CMD, _PUBLISH_LIMITED = (
    declare_boolean(name, "whether there is `cmd_vel_out`", default=False)
    for name in ("publish_cmd", "publish_limited_velocity")
)
_PREFIX = declare_string("tf_frame_prefix", "prefix of both frames", "")
_HAS_PREFIX = declare_boolean(
    "tf_frame_prefix_enable", "false: there is no prefix", default=True
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


class DiffDriveController(ChainableController):
    """Drives a base at a velocity forwards and a velocity about z.

    A set-point is `cmd_vel`: linear x [m/s] and angular z [rad/s]. It expires after
    `cmd_vel_timeout` (or `command_timeout`), and the base brakes within its limits. A
    preceding controller may command the references `linear/velocity` and
    `angular/velocity`. The limits `linear/x` and `angular/z` are those of the original,
    and so are all other parameters.

    Wheels that are named by `left_wheel_names` and `right_wheel_names` have the limits,
    the odometry and the publications of ROS 2; a wheel that reads NaN then ends the
    controller.

    Attributes:
        odometry: Pose and velocity of the base.

    Source:
        DiffDriveController; differs: a set-point that is not finite is refused; the
        topic `odom` is published in the cycle in which it is due; a diagonal of a
        covariance is 0 when absent; the topics `cmd_vel` and tf of the original are the
        set-points and `odom` of this station.
    """

    odometry: Odometry
    required_interfaces: ClassVar[tuple[type, ...]] = (VelocityJointInterface,)
    own_parameters = (
        *(_LEFT, _RIGHT, _SEPARATION, _RADIUS, _SEPARATION_FACTOR, _RADIUS_FACTOR),
        *(_LEFT_NAMES, _RIGHT_NAMES, *_RADIUS_FACTORS, _POSITIONS, _PUBLISH_LIMITED),
        *(_RATE, _TIMEOUT, _WINDOW, _OPEN_LOOP, _PUBLISH_CMD, _PUBLISH_STATE),
        *(_ENABLE_TF, _MULTIPLE, _BASE_FRAME, _ODOM_FRAME, _PREFIX, _HAS_PREFIX),
        *(_POSE_COVARIANCE, _TWIST_COVARIANCE),
        *_VALIDITY_AND_ACTION,
        *limiter_parameters("linear/x", "m"),
        *limiter_parameters("angular/z", "rad"),
    )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        # Whoever names one side in the words of ROS 2 has to name the other one so.
        sides = (_LEFT_NAMES, _RIGHT_NAMES)
        self._is_ros2 = any(each.read_str_list(params, []) for each in sides)
        of_left, of_right = _LEFT, _RIGHT
        if self._is_ros2:
            of_left, of_right = _LEFT_NAMES, _RIGHT_NAMES
        left, right = _names(params, of_left), _names(params, of_right)
        if len(left) != len(right):
            count = f"{of_right.name}, which has {len(right)}"
            of_left.refuse(params, left, f"as many wheels as {count}")
        separation, radius = _read_size(params, left[0], right[0])
        self._separation = separation * _SEPARATION_FACTOR.read_float(params)
        radius *= _RADIUS_FACTOR.read_float(params)
        first, second = (radius * each.read_float(params) for each in _RADIUS_FACTORS)
        self._radii = (first, second)
        self._linear, self._angular = (
            read_limiter(params, axis, is_ros2=self._is_ros2)
            for axis in ("linear/x", "angular/z")
        )
        self._is_open_loop = _OPEN_LOOP.read_bool(params)
        self._follows_positions = _POSITIONS.read_bool(params)
        publishes = [
            each.read_bool(params) for each in (_PUBLISH_CMD, _PUBLISH_LIMITED)
        ]
        self._publishes_commands = any(publishes)
        self._publishes_wheels = _PUBLISH_STATE.read_bool(params)
        self._message = _constant_part(params)
        self._timer = None
        if params.has(_RATE.name) or not self._is_ros2:
            self._timer = PublishTimer(_RATE.read_float(params, 50.0))
        window = max(1, int(_WINDOW.read_float(params)))
        self.odometry = Odometry(
            self._separation, self._radii, window, is_ros2=self._is_ros2
        )
        self._connect([*left, *right], hw, params)

    def _connect(self, names: list[str], hw: RobotHW, params: Parameters) -> None:
        self.joint_names = names
        self._count = len(names) // 2
        wheels = require_interface(hw, VelocityJointInterface)
        self._group = JointGroup([wheels.get_handle(name) for name in names])
        self._references = zeros(2)
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
    def on_export_reference_interfaces(self) -> Sequence[Reference]:
        names = ("linear/velocity", "angular/velocity")
        return [Reference(name, self._references, k) for k, name in enumerate(names)]

    @override
    def on_set_chained_mode(self, chained_mode: bool) -> bool:
        # A set-point from before the chain must not come back after it.
        if not chained_mode:
            self._active.start_at_rest()
        return True

    @override
    def starting(self, time: float) -> None:
        self._active.start_at_rest()
        put(self._references, [0.0, 0.0])
        self._last = self._before = (0.0, 0.0)
        self._group.set_commands([0.0] * len(self.joint_names))
        if self._timer is not None:
            self._timer.start(time, at_once=False)
        self.odometry.forget_velocity(*self._sides(), time)

    @override
    def stopping(self, time: float) -> None:
        self._group.set_commands([0.0] * len(self.joint_names))

    @override
    def update_reference_from_subscribers(self, time: float, period: float) -> None:
        put(self._references, self._active.newest())

    @override
    def update_and_write_commands(self, time: float, period: float) -> None:
        """Follow the wheels or the commands, then limit and send the newest command."""
        odometry = self.odometry
        if not self._is_open_loop:
            self._follow_wheels(time)
        elif not self._is_ros2:
            odometry.follow_commands(*self._last, time)
        wanted = [*self._references]
        last, before = self._last, self._before
        linear = self._linear.limit(wanted[0], last[0], before[0], period)
        angular = self._angular.limit(wanted[1], last[1], before[1], period)
        self._before, self._last = last, (linear, angular)
        # The odometry of ROS 2 has what is commanded now.
        if self._is_open_loop and self._is_ros2:
            odometry.follow_commands(linear, angular, time)
        self._group.set_commands(self._wheel_velocities())
        actual = [odometry.linear, odometry.angular]
        error = [w - a for w, a in zip(wanted, actual, strict=True)]
        # One command per number of the set-point: the velocities of both sides.
        self.sample = ControllerSample(time, wanted, actual, error, [linear, angular])
        if self._timer is None or self._timer.is_due(time):
            self._publish(time)

    def _follow_wheels(self, time: float) -> None:
        if self._follows_positions:
            left, right = self._sides()
            follow = self.odometry.follow_wheels
        else:
            left, right = self._means(self._group.get_velocities())
            follow = self.odometry.follow_velocities
        if isfinite(left + right):
            follow(left, right, time)
        elif self._is_ros2:
            raise HardwareInterfaceError(
                f"The odometry has no reading of a wheel: {left:g} and {right:g}.",
                remedy="Repair the sensor of the wheel, or set `open_loop`.",
            )

    def _wheel_velocities(self) -> list[float]:
        """Return the commands of the wheels, those of the left side first [rad/s]."""
        linear, angular = self._last
        across = angular * self._separation / 2.0
        left, right = (linear - across), (linear + across)
        return [left / self._radii[0]] * self._count + [
            right / self._radii[1]
        ] * self._count

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
        return {
            "joint_names": self.joint_names,
            "desired_velocities": self._wheel_velocities(),
            "actual_positions": self._group.get_positions(),
            "actual_velocities": self._group.get_velocities(),
        }

    def _sides(self) -> tuple[float, float]:
        """Return the mean positions of the left and of the right wheels [rad]."""
        return self._means(self._group.get_positions())

    def _means(self, values: list[float]) -> tuple[float, float]:
        count = self._count
        return sum(values[:count]) / count, sum(values[count:]) / count


def _names(params: Parameters, side: DeclaredParameter) -> list[str]:
    """Return the wheels of one side, from a list or one name.

    Raises:
        ParameterError: The names are missing, not strings, or there are none.
    """
    if isinstance(params.get(side.name), str):
        return [params.get_str(side.name)]
    names = side.read_str_list(params, [])
    if not names:
        side.refuse(params, names, "a list of joints, or one name")
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
    # A station has no namespace, which `~` and an empty prefix stand for.
    prefix = _PREFIX.read_str(params).replace("~", "", 1).strip("/")
    prefix = f"{prefix}/" if _HAS_PREFIX.read_bool(params) and prefix else ""
    return {
        "frame_id": prefix + _ODOM_FRAME.read_str(params),
        "child_frame_id": prefix + _BASE_FRAME.read_str(params),
        "pose_covariance_diagonal": _POSE_COVARIANCE.read_float_list(params),
        "twist_covariance_diagonal": _TWIST_COVARIANCE.read_float_list(params),
    }
