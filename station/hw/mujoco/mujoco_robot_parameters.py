"""The parameters of MujocoRobotHW, read and checked.

```yaml
robot:
  type: mujoco_hw/MujocoRobotHW
  robot_description: example-robot-data:ur5   # or the path of a URDF
  base: fixed                                 # or floating, planar
  base_xyz: [0.0, 0.0, 0.5]                   # where the root link stands [m], [rad]
  base_rpy: [0.0, 0.0, 0.0]
  gravity_compensation: true                  # the robot carries its own weight; false
                                              # when the base is floating
  armature: 0.1                               # of driven joints [kg m^2], [kg]
  floor: true
  timestep: 0.001                             # of the simulation [s]
  integrator: auto                            # or implicitfast, rk4
  initial_positions: {elbow_joint: 1.57}      # [rad or m]; others at 0 or mid-range
  limit_mode: ros_control                     # or rate
  joint_limits: {elbow_joint: {…}}            # see limits_from_parameters
  pid_gains: {elbow_joint: {p: 100, d: 10}}   # see station.core.numerics.pid
  strict: false                               # refuse what would be repaired
  zero_range: lock                            # or free: joints with a range of 0 to 0
  self_collision: srdf                        # or all, off
  ros2_control: use                           # or ignore: <ros2_control> of the URDF
  sensors:
    wrist_ft: {type: force_torque, link: tool0}
    imu: {type: imu, link: forearm_link}
    front: {type: range, link: bumper, max_range: 4.0}   # along the link's x axis [m]
    compass: {type: magnetometer, link: base_link}
    battery: {type: battery, values: {battery_voltage: 24.5}}   # constant, as gps
  magnetic_field: [1.52e-6, 21.01e-6, -43.94e-6]  # to east, north and up [T]
  gpios: {flange: {command_interfaces: [vacuum], state_interfaces: [vacuum]}}
```

All but `robot_description` are optional.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from math import inf, pi
from typing import Literal, NoReturn, TypeVar, get_args

from station.core.description.ros2_control import ComponentTag
from station.core.description.urdf import Pose
from station.core.description.urdf_repair import ZeroRange
from station.core.errors import ParameterError
from station.core.hardware.limits import LimitMode
from station.core.parameters import Parameters
from station.hw.mujoco.bases import BaseType
from station.hw.simulated_gpios import read_gpios

SelfCollision = Literal["off", "srdf", "all"]
"""The links of a robot that can touch one another: none; those that its SRDF allows,
unless they touch at the start; or all links that no joint connects."""
Integrator = Literal["auto", "implicitfast", "rk4"]
"""How a time step of the world is integrated; `auto` chooses according to the robot."""
_KEYS = frozenset({
    "type",
    "is_async",
    "async_parameters",
    "robot_description",
    "base",
    "base_xyz",
    "base_rpy",
    "gravity_compensation",
    "armature",
    "floor",
    "timestep",
    "integrator",
    "initial_positions",
    "limit_mode",
    "joint_limits",
    "pid_gains",
    "sensors",
    "magnetic_field",
    "gpios",
    "ros2_control",
    "strict",
    "zero_range",
    "self_collision",
})
_MUNICH = (1.52e-6, 21.01e-6, -43.94e-6)
"""Magnetic field in Munich to the east, to the north and upwards [T].
Source: World Magnetic Model 2025 (NOAA NCEI and BGS, WMM_2025.COF), at 48.137 N,
11.575 E, 520 m, 2025.0."""
_SENSOR_KEYS = frozenset({"type", "link", "values", "max_range"})


class SensorType(Enum):
    """The kinds of simulated sensors."""

    FORCE_TORQUE = "force_torque"
    IMU = "imu"
    RANGE = "range"
    MAGNETOMETER = "magnetometer"
    GPS = "gps"
    BATTERY = "battery"

    @property
    def is_constant(self) -> bool:
        """Return whether the sensor only returns its configured values."""
        return self in {SensorType.GPS, SensorType.BATTERY}


@dataclass(frozen=True, slots=True)
class SensorRequest:
    """A sensor of the robot.

    Attributes:
        name: Name of the sensor.
        type: Kind of the sensor.
        link: Link in whose frame the sensor measures.
        values: The values of a constant sensor by name.
        max_range: Distance beyond which a range sensor sees nothing [m].
    """

    name: str
    type: SensorType
    link: str
    values: Mapping[str, float] = field(default_factory=dict)
    max_range: float = inf


@dataclass(frozen=True, slots=True)
class MujocoRobotParameters:
    """The parameters of MujocoRobotHW, with the units and meanings listed above."""

    robot_description: str
    base: Pose
    has_own_place: bool
    base_type: BaseType
    gravity_compensation: bool
    armature: float
    has_floor: bool
    timestep: float
    integrator: Integrator
    initial_positions: Mapping[str, float]
    limit_mode: LimitMode
    strict: bool
    zero_range: ZeroRange
    self_collision: SelfCollision
    sensors: tuple[SensorRequest, ...]
    magnetic_field: tuple[float, ...]
    gpios: tuple[ComponentTag, ...]
    uses_ros2_control: bool


def read_parameters(params: Parameters) -> MujocoRobotParameters:
    """Read the parameters of MujocoRobotHW, except limits and gains of joints.

    Args:
        params: The robot's namespace.

    Raises:
        ParameterError: A parameter is missing, unknown or impossible.
    """
    _refuse_unknown(params, _KEYS)
    armature = params.get_float("armature", 0.1)
    if armature < 0.0:
        _refuse(params, "armature", armature, "0 or more")
    timestep = params.get_float("timestep", 0.001)
    if not 0.0 < timestep <= 0.01:
        _refuse(params, "timestep", timestep, "above 0 and at most 0.01 s")
    positions = params.namespace("initial_positions")
    base_type = _read_choice(params, "base", get_args(BaseType), "fixed")
    return MujocoRobotParameters(
        robot_description=params.get_str("robot_description"),
        base=_read_base(params),
        has_own_place=params.has("base_xyz"),
        base_type=base_type,
        # A floating robot without weight would stay in the air.
        gravity_compensation=params.get_bool(
            "gravity_compensation", default=base_type != "floating"
        ),
        armature=armature,
        has_floor=params.get_bool("floor", default=True),
        timestep=timestep,
        integrator=_read_choice(params, "integrator", get_args(Integrator), "auto"),
        initial_positions={k: positions.get_float(k) for k in positions.keys()},  # noqa: SIM118 - no mapping
        limit_mode=LimitMode.from_parameters(params),
        strict=params.get_bool("strict", default=False),
        zero_range=_read_choice(params, "zero_range", get_args(ZeroRange), "lock"),
        self_collision=_read_self_collision(params),
        sensors=tuple(_read_sensors(params.namespace("sensors"))),
        magnetic_field=tuple(params.get_float_list("magnetic_field", 3, list(_MUNICH))),
        gpios=read_gpios(params),
        uses_ros2_control=_read_choice(params, "ros2_control", ("use", "ignore"), "use")
        == "use",
    )


_Choice = TypeVar("_Choice", bound=str)


def _read_choice(
    params: Parameters, key: str, allowed: tuple[_Choice, ...], default: _Choice
) -> _Choice:
    value = params.get_str(key, default)
    for choice in allowed:
        if choice == value:
            return choice
    return _refuse(params, key, value, f"one of {', '.join(allowed)}")


def _read_self_collision(params: Parameters) -> SelfCollision:
    # YAML reads the bare word `off` as false.
    if params.get("self_collision") is False:
        return "off"
    return _read_choice(params, "self_collision", get_args(SelfCollision), "srdf")


def _read_base(params: Parameters) -> Pose:
    x, y, z = params.get_float_list("base_xyz", 3, [0.0, 0.0, 0.0])
    roll, pitch, yaw = params.get_float_list("base_rpy", 3, [0.0, 0.0, 0.0])
    if max(abs(roll), abs(pitch), abs(yaw)) > 2.0 * pi:
        _refuse(params, "base_rpy", [roll, pitch, yaw], "angles in radians")
    return Pose.from_rpy((x, y, z), (roll, pitch, yaw))


def _read_sensors(params: Parameters) -> list[SensorRequest]:
    types = {kind.value: kind for kind in SensorType}
    requests = []
    for name in params.keys():  # noqa: SIM118 - no mapping
        entry = params.namespace(name)
        _refuse_unknown(entry, _SENSOR_KEYS)
        kind = entry.get_str("type")
        if kind not in types:
            _refuse(entry, "type", kind, f"one of {', '.join(types)}")
        values = entry.namespace("values")
        requests.append(
            SensorRequest(
                name,
                types[kind],
                entry.get_str("link", "" if types[kind].is_constant else None),
                {each: values.get_float(each) for each in values.keys()},  # noqa: SIM118 - no mapping
                entry.get_float("max_range") if entry.has("max_range") else inf,
            )
        )
    return requests


def _refuse_unknown(params: Parameters, known: Sequence[str] | frozenset[str]) -> None:
    for key in sorted(set(params.keys()) - set(known)):
        raise ParameterError(
            f"Parameter '{params.resolve(key)}' is unknown to MujocoRobotHW.",
            remedy=f"Known are {', '.join(sorted(known))}.",
            details={"parameter": params.resolve(key)},
        )


def _refuse(params: Parameters, key: str, value: object, wanted: str) -> NoReturn:
    raise ParameterError(
        f"Parameter '{params.resolve(key)}' is {value!r}; it must be {wanted}.",
        remedy="Correct the configuration.",
        details={"parameter": params.resolve(key)},
    )
