"""The parameters of FrankaHW, read and checked.

Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp, FrankaHW::initParameters,
setupParameterCallbacks, and franka_control/config/franka_control_node.yaml; differs:
every default in that YAML file is the default here, too; unknown parameters and
impossible values are refused; and no wrong value is replaced by a default.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import pi
from typing import NoReturn

from station.core.description.urdf import Pose
from station.core.errors import ParameterError
from station.core.franka.franka_model import GRAVITY_EARTH
from station.core.franka.franka_services import CollisionBehavior
from station.core.hardware.limits import LimitMode
from station.core.parameters import Parameters
from station.hw.franka.arm.arm_description import joint_names
from station.hw.franka.arm.arm_limits import LIMITS_OF_ARM, ArmLimits, SupervisorLimits
from station.hw.franka.arm.collision_behavior import (
    DEFAULT_COLLISION_BEHAVIOR,
    collision_behavior_problem,
)
from station.hw.franka.arm.robot_arm import MOST_LOST_PACKETS, ControllerMode
from station.hw.franka.arm.service_limits import ServiceLimits
from station.hw.franka.commands.rate_limiter import CommandSettings

_DOF = 7
_INTERNAL_CONTROLLERS = {
    mode.value: mode
    for mode in (ControllerMode.JOINT_IMPEDANCE, ControllerMode.CARTESIAN_IMPEDANCE)
}
_KEYS = frozenset({
    "type",
    "arm",
    "arm_id",
    "joint_names",
    "robot_description",
    "robot_ip",
    "rate_limiting",
    "cutoff_frequency",
    "internal_controller",
    "joint_limit_warning_threshold",
    "initial_positions",
    "base_xyz",
    "base_rpy",
    "arm_type",
    "gravity",
    "realtime_config",
    "collision_config",
    "service_limits",
    "supervisor",
    "limit_mode",
    "realism",
    "realism_seed",
    "identified",
    "fingers_in_joint_states",
})

# Viscous friction of 200 Nm s/rad would reverse the motion of the lightest joint, 0.1
# kg m^2, in a step of 1 ms; a Franka has less than 2 Nm of Coulomb friction.
MOST_FRICTION = {"coulomb": 50.0, "viscous": 50.0}
"""Largest friction of a joint [Nm, Nm s/rad]."""
INITIAL_POSITIONS = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""Pose in which a simulated arm starts [rad], joints 1 to 7. Source: libfranka@0.9.2
examples/generate_joint_velocity_motion.cpp, q_goal."""


@dataclass(frozen=True, slots=True)
class FrankaParameters:
    """The settings that FrankaHW reads once.

    Attributes:
        arm: The kind of arm, a key of `LIMITS_OF_ARM`.
        arm_id: Name of the arm, with which the names of its joints begin.
        joint_names: The 7 joints, from base to flange.
        robot_description: `example-robot-data:<robot>` or the path of a URDF.
        joint_limit_warning_threshold: Distance to a position limit below which there is
            a warning [rad], >= 0.
        initial_positions: First positions of the simulated arm [rad], shape (7,).
        base: The base's pose in the world.
        limits: Limits of this kind of arm.
        gravity: Acceleration of gravity in the axes of the world [m/s^2].
        most_lost_packets: Largest number of cycles in which a late loop gives the arm
            no command (`realtime_config`): 20, which stops the arm, with `enforce`; 19
            with `ignore`.
        collision_behavior: Thresholds at the start (`collision_config`).
        limit_mode: How joint commands are limited.
        thresholds: The supervisor's thresholds that Franka does not publish
            (`supervisor`).
        service_limits: The largest loads and pushes (`service_limits`).
        is_realistic: Whether a simulated arm has friction, noise and an observer
            (`realism: typical`), or none of them (`ideal`).
        realism_seed: Seed of the simulated arm's random numbers, >= 0.
        identified: Identified Coulomb [Nm] and viscous [Nm s/rad] friction by joint,
            which a simulated arm uses instead of typical values.
        publishes_fingers: Whether the joint states contain the fingers of a simulated
            hand, as franka_gripper publishes them (`fingers_in_joint_states`).
        robot_ip: Address of the real arm; None for a simulated one.
    """

    arm: str
    arm_id: str
    joint_names: tuple[str, ...]
    robot_description: str
    joint_limit_warning_threshold: float
    initial_positions: tuple[float, ...]
    base: Pose
    limits: ArmLimits
    gravity: tuple[float, float, float]
    most_lost_packets: int
    collision_behavior: CollisionBehavior
    limit_mode: LimitMode
    thresholds: SupervisorLimits
    service_limits: ServiceLimits
    is_realistic: bool
    realism_seed: int
    identified: Mapping[str, tuple[float, float]]
    publishes_fingers: bool
    robot_ip: str | None

    @property
    def waits_for_late_loop(self) -> bool:
        """Return whether `realtime_config` is `ignore`."""
        return self.most_lost_packets < MOST_LOST_PACKETS

    @property
    def remark(self) -> str | None:
        """Return a remark if the arm has the name of another kind of arm; else None."""
        named = _kind_named(self.arm_id)
        if named in {None, self.arm}:
            return None
        return (
            f"The parameter arm chooses a model {self.arm}, but arm_id is "
            f"{self.arm_id}, the name of a {named}. Write arm_id: {self.arm} for the "
            f"names of this model, or arm: {named} for the model with these names."
        )


def read_parameters(params: Parameters) -> FrankaParameters:
    """Read the parameters that FrankaHW reads only once.

    Args:
        params: The robot's namespace.

    Raises:
        ParameterError: A parameter is missing, unknown or impossible.
    """
    # Unknown keys are refused: a misspelt limit would silently have its default.
    for key in sorted(set(params.keys()) - _KEYS):
        raise ParameterError(
            f"Parameter '{params.resolve(key)}' is unknown to FrankaHW.",
            remedy=f"Known are {', '.join(sorted(_KEYS))}.",
            details={"parameter": params.resolve(key)},
        )
    arm_id = params.get_str("arm_id")
    if not arm_id.isidentifier():
        _refuse(params, "arm_id", arm_id, "a name of letters, digits and _")
    names = params.get_str_list("joint_names", joint_names(arm_id))
    if len(set(names)) != _DOF or any(
        not name.startswith(f"{arm_id}_joint") for name in names
    ):
        wanted = f"{_DOF} different names that begin with {arm_id}_joint"
        _refuse(params, "joint_names", names, wanted)
    threshold = params.get_float("joint_limit_warning_threshold", 0.1)
    if threshold < 0.0:
        _refuse(params, "joint_limit_warning_threshold", threshold, "0 or more")
    arm = _arm(params, arm_id)
    return FrankaParameters(
        arm=arm,
        arm_id=arm_id,
        joint_names=tuple(names),
        robot_description=params.get_str("robot_description"),
        joint_limit_warning_threshold=threshold,
        initial_positions=_floats(params, "initial_positions", INITIAL_POSITIONS),
        base=_base(params),
        limits=LIMITS_OF_ARM[arm],
        gravity=_gravity(params),
        most_lost_packets=_most_lost_packets(params),
        collision_behavior=_collision_behavior(params.namespace("collision_config")),
        limit_mode=LimitMode.from_parameters(params),
        publishes_fingers=params.get_bool("fingers_in_joint_states", default=False),
        thresholds=_thresholds(params.namespace("supervisor")),
        service_limits=_service_limits(params.namespace("service_limits")),
        is_realistic=_is_realistic(params),
        realism_seed=_seed(params),
        identified=_identified(params, names),
        robot_ip=_robot_ip(params),
    )


def read_command_settings(params: Parameters) -> CommandSettings:
    """Read the parameters that may change between two switches.

    Args:
        params: The robot's namespace.

    Raises:
        ParameterError: A parameter is impossible.
    """
    frequency = params.get_float("cutoff_frequency", 100.0)
    if frequency <= 0.0:
        _refuse(params, "cutoff_frequency", frequency, "above 0 Hz")
    chosen = None
    if params.has("internal_controller"):
        controller = params.get_str("internal_controller")
        if controller not in _INTERNAL_CONTROLLERS:
            wanted = f"one of {', '.join(_INTERNAL_CONTROLLERS)}"
            _refuse(params, "internal_controller", controller, wanted)
        chosen = _INTERNAL_CONTROLLERS[controller]
    return CommandSettings(
        rate_limiting=params.get_bool("rate_limiting", default=True),
        cutoff_frequency=frequency,
        internal_controller=chosen,
    )


def _robot_ip(params: Parameters) -> str | None:
    if not params.has("robot_ip"):
        return None
    address = params.get_str("robot_ip").strip()
    if not address:
        wanted = "the address of a real arm, or left out for a simulated one"
        _refuse(params, "robot_ip", address, wanted)
    return address


def _base(params: Parameters) -> Pose:
    x, y, z = _floats(params, "base_xyz", (0.0, 0.0, 0.0))
    roll, pitch, yaw = _floats(params, "base_rpy", (0.0, 0.0, 0.0))
    # An angle above one turn is probably in degrees.
    if max(abs(roll), abs(pitch), abs(yaw)) > 2.0 * pi:
        wanted = "angles in radians"
        _refuse(params, "base_rpy", [roll, pitch, yaw], wanted)
    return Pose.from_rpy((x, y, z), (roll, pitch, yaw))


def _arm(params: Parameters, arm_id: str) -> str:
    # The arm's name implies its kind, as in the launch files of franka_ros.
    chosen = _kind_named(arm_id) or "panda"
    for key in ("arm_type", "arm"):  # the first is the older name of the second
        if not params.has(key):
            continue
        value = params.get_str(key)
        if value not in LIMITS_OF_ARM:
            _refuse(params, key, value, f"one of {', '.join(LIMITS_OF_ARM)}")
        if key == "arm" and params.has("arm_type") and value != chosen:
            _refuse(params, key, value, f"{chosen} as arm_type, or arm_type left out")
        chosen = value
    return chosen


def _kind_named(arm_id: str) -> str | None:
    return next((kind for kind in LIMITS_OF_ARM if arm_id.startswith(kind)), None)


def _gravity(params: Parameters) -> tuple[float, float, float]:
    x, y, z = _floats(params, "gravity", GRAVITY_EARTH)
    return x, y, z


def _is_realistic(params: Parameters) -> bool:
    profile = params.get_str("realism", "typical")
    if profile not in {"ideal", "typical"}:
        _refuse(params, "realism", profile, "ideal or typical")
    return profile == "typical"


def _identified(
    params: Parameters, joints: Sequence[str]
) -> dict[str, tuple[float, float]]:
    found = {}
    given = params.namespace("identified")
    if not isinstance(given.get("", {}), dict):
        _refuse(params, "identified", given.get(), "frictions by joint")
    for joint in given.keys():  # noqa: SIM118 - a view has no iterator
        if joint not in joints:
            _refuse(params, "identified", joint, f"one of {', '.join(joints)}")
        one = given.namespace(joint)
        unknown = sorted({*one.keys()} - MOST_FRICTION.keys())
        if unknown or not _is_realistic(params):
            wanted = "coulomb and viscous of a joint, with realism: typical"
            _refuse(params, "identified", given.get(joint), wanted)
        for key, most in MOST_FRICTION.items():
            if not 0.0 <= one.get_float(key) <= most:
                _refuse(one, key, one.get_float(key), f"0 to {most:g}")
        found[joint] = (one.get_float("coulomb"), one.get_float("viscous"))
    return found


def _seed(params: Parameters) -> int:
    seed = params.get_int("realism_seed", 0)
    if seed < 0:
        _refuse(params, "realism_seed", seed, "0 or more")
    return seed


def _most_lost_packets(params: Parameters) -> int:
    config = params.get_str("realtime_config", "enforce")
    if config not in {"enforce", "ignore"}:
        _refuse(params, "realtime_config", config, "enforce or ignore")
    # With `ignore`, one less than the number that ends a motion.
    return MOST_LOST_PACKETS if config == "enforce" else MOST_LOST_PACKETS - 1


def _collision_behavior(params: Parameters) -> CollisionBehavior:
    values: dict[str, tuple[float, ...]] = {}
    for one in fields(CollisionBehavior):
        default = getattr(DEFAULT_COLLISION_BEHAVIOR, one.name)
        values[one.name] = _floats(params, one.name, default)
    behavior = CollisionBehavior(**values)
    problem = collision_behavior_problem(behavior)
    if problem is not None:
        _refuse(params, problem.field, values[problem.field], problem.allowed)
    return behavior


def _thresholds(params: Parameters) -> SupervisorLimits:
    default = SupervisorLimits()
    known = {one.name for one in fields(SupervisorLimits)}
    for key in sorted(set(params.keys()) - known):
        _refuse(params, key, params.get(key), f"one of {', '.join(sorted(known))}")
    read = SupervisorLimits(
        position_tolerance=params.get_float(
            "position_tolerance", default.position_tolerance
        ),
        velocity_factor=params.get_float("velocity_factor", default.velocity_factor),
        torque_factor=params.get_float("torque_factor", default.torque_factor),
        debounce=params.get_int("debounce", default.debounce),
        power=params.get_float("power") if params.has("power") else default.power,
        self_collision_distance=params.get_float(
            "self_collision_distance", default.self_collision_distance
        ),
        cartesian_lower=_walls(params, "cartesian_lower", default.cartesian_lower),
        cartesian_upper=_walls(params, "cartesian_upper", default.cartesian_upper),
        path_deviation=_floats(params, "path_deviation", default.path_deviation),
        singular_start=params.get_float("singular_start", default.singular_start),
    )
    for key in ("velocity_factor", "torque_factor", "debounce", "power"):
        # `not … >`, so that NaN is refused, too.
        if not getattr(read, key) > 0.0:
            _refuse(params, key, getattr(read, key), "above 0")
    if not read.singular_start >= 0.0:
        _refuse(params, "singular_start", read.singular_start, "at least 0")
    if not min(read.path_deviation) > 0.0:
        _refuse(params, "path_deviation", read.path_deviation, "above 0")
    if any(
        low >= high
        for low, high in zip(read.cartesian_lower, read.cartesian_upper, strict=True)
    ):
        wanted = "below cartesian_upper"
        _refuse(params, "cartesian_lower", read.cartesian_lower, wanted)
    return read


def _service_limits(params: Parameters) -> ServiceLimits:
    default = ServiceLimits()
    known = [one.name for one in fields(ServiceLimits)]
    for key in sorted(set(params.keys()) - set(known)):
        _refuse(params, key, params.get(key), f"one of {', '.join(known)}")
    values = {key: params.get_float(key, getattr(default, key)) for key in known}
    for key, value in values.items():
        if value <= 0.0:
            _refuse(params, key, value, "above 0")
    return ServiceLimits(**values)


def _walls(
    params: Parameters, key: str, default: tuple[float, ...]
) -> tuple[float, ...]:
    return _floats(params, key, default) if params.has(key) else default


def _floats(
    params: Parameters, key: str, default: Sequence[float]
) -> tuple[float, ...]:
    return tuple(params.get_float_list(key, len(default), list(default)))


def _refuse(params: Parameters, key: str, value: object, wanted: str) -> NoReturn:
    raise ParameterError(
        f"Parameter '{params.resolve(key)}' is {value!r}; it must be {wanted}.",
        remedy="Correct the configuration.",
        details={"parameter": params.resolve(key)},
    )
