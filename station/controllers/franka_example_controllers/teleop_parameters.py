"""Parameters of the teleoperation: fixed ones and run-time parameters.

Source: franka_ros@c11f000 franka_example_controllers, cfg/teleop_param.cfg and
src/teleop_joint_pd_example_controller.cpp, init; differs: the run-time
parameters can always be changed, not only with `debug`, and start with the configured
values.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm import ARM_ID, JOINT_NAMES
from station.controllers.franka_example_controllers.follower_motion import MotionBounds
from station.core.control.tunables import Tunable
from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.parameters import Parameters

_DOF = 7


def _seven(name: str, unit: str, text: str) -> DeclaredParameter:
    return DeclaredParameter(
        name=name, type=ParameterType.NUMBERS, unit=unit, size=_DOF, description=text
    )


_LEADER = (
    _seven("leader/d_gains_lower", "Nms/rad", "damping of the leader at low velocity"),
    _seven("leader/d_gains_upper", "Nms/rad", "damping of the leader at high velocity"),
    _seven(
        "leader/dq_max_lower",
        "rad/s",
        "velocity at which that damping starts to change",
    ),
    _seven(
        "leader/dq_max_upper", "rad/s", "velocity at which that damping stops to change"
    ),
)
_FOLLOWER = (
    _seven("follower/p_gains", "Nm/rad", "stiffness of the follower"),
    _seven("follower/d_gains", "Nms/rad", "damping of the follower"),
    _seven(
        "follower/drift_comp_gains",
        "1/s",
        "velocity of the follower per distance to the leader",
    ),
)
_MOTION = {
    "dq_l": _seven(
        "follower/dq_max_lower",
        "rad/s",
        "largest velocity of the follower far behind the leader",
    ),
    "dq_u": _seven(
        "follower/dq_max_upper",
        "rad/s",
        "largest velocity of the follower close to the leader",
    ),
    "ddq_l": _seven(
        "follower/ddq_max_lower",
        "rad/s^2",
        "largest acceleration of the follower far behind the leader",
    ),
    "ddq_u": _seven(
        "follower/ddq_max_upper",
        "rad/s^2",
        "largest acceleration of the follower close to the leader",
    ),
}
_CONTACT = DeclaredParameter(
    name="contact_force_threshold",
    type=ParameterType.NUMBER,
    unit="N",
    description="force at the hand above which the arm is in contact",
)
ROLES = ("leader", "follower")
"""The arm that is guided, and the arm that follows."""
TELEOP_PARAMETERS = (
    *(each.inside(role) for role in ROLES for each in (ARM_ID, JOINT_NAMES, _CONTACT)),
    *_LEADER,
    *_FOLLOWER,
    *_MOTION.values(),
)
"""All parameters of the teleoperation."""
_SMALLEST = 0.1
_LARGEST_VELOCITY = (2.17, 2.17, 2.17, 2.17, 2.6, 2.6, 2.6)
_LARGEST_ACCELERATION = (15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0)
_BOUNDS = {
    "dq_l": _LARGEST_VELOCITY,
    "dq_u": _LARGEST_VELOCITY,
    "ddq_l": _LARGEST_ACCELERATION,
    "ddq_u": _LARGEST_ACCELERATION,
}
_SCALARS = {
    "leader_damping_scaling": Tunable("", 0.0, 8.0, "factor of the leader's damping"),
    "follower_stiffness_scaling": Tunable(
        "", 0.1, 1.3, "factor of the follower's stiffness"
    ),
    "force_feedback_idle": Tunable(
        "", 0.0, 1.0, "share of the torques felt by a leader that is not guided"
    ),
    "force_feedback_guiding": Tunable(
        "", 0.0, 1.0, "share of the torques felt by a guided leader"
    ),
    "leader_contact_force_threshold": Tunable(
        "N", 0.1, 10.0, "a larger force is a contact"
    ),
    "follower_contact_force_threshold": Tunable(
        "N", 0.1, 10.0, "a larger force is a contact"
    ),
}


@dataclass(frozen=True, slots=True)
class LeaderDamping:
    """Damping of the leader, which changes with its velocity; shape (7,) each.

    Attributes:
        slow: Damping up to the velocity `lower` [Nms/rad].
        fast: Damping from the velocity `upper` on [Nms/rad].
        lower: Velocity at which the damping starts to change [rad/s].
        upper: Velocity at which the damping stops to change, > `lower` [rad/s].
    """

    slow: NDArray[np.float64]
    fast: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]

    def damping(self, dq: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the damping at velocities `dq` [rad/s]: [Nms/rad], shape (7,)."""
        share = np.clip((np.abs(dq) - self.lower) / (self.upper - self.lower), 0.0, 1.0)
        result: NDArray[np.float64] = self.slow + share * (self.fast - self.slow)
        return result


@dataclass(frozen=True, slots=True)
class TeleopParameters:
    """Parameters that do not change while the teleoperation runs.

    Attributes:
        damping: Damping of the leader.
        stiffness: Stiffness of the follower [Nm/rad], shape (7,).
        follower_damping: Damping of the follower [Nms/rad], shape (7,).
        drift_gains: Drift gains of `FollowerMotion` [1/s], shape (7,).
    """

    damping: LeaderDamping
    stiffness: NDArray[np.float64]
    follower_damping: NDArray[np.float64]
    drift_gains: NDArray[np.float64]


def read_teleop_parameters(params: Parameters) -> TeleopParameters:
    """Read the parameters that do not change at run time.

    Raises:
        ParameterError: A parameter is missing, or is not a list of seven numbers.
    """
    damping = [np.array(each.read_float_list(params)) for each in _LEADER]
    follower = [np.array(each.read_float_list(params)) for each in _FOLLOWER]
    return TeleopParameters(LeaderDamping(*damping), *follower)


def read_teleop_gains(params: Parameters) -> dict[str, float]:
    """Read the first values of the run-time parameters, by their run-time names.

    Raises:
        ParameterError: A parameter is missing, or is not a list of seven numbers.
    """
    gains = {
        "leader_damping_scaling": 1.0,
        "follower_stiffness_scaling": 1.0,
        "force_feedback_idle": 0.5,
        "force_feedback_guiding": 0.95,
        **{
            f"{role}_{_CONTACT.name}": _CONTACT.inside(role).read_float(params)
            for role in ROLES
        },
    }
    for prefix, parameter in _MOTION.items():
        for number, value in enumerate(parameter.read_float_list(params), 1):
            gains[f"{prefix}_{number}"] = value
    return gains


def teleop_schema(gains: Mapping[str, float]) -> dict[str, Tunable]:
    """Return unit and range of each; a configured value beyond a range widens it."""
    schema = dict(_SCALARS)
    for prefix, largest in _BOUNDS.items():
        declared = _MOTION[prefix]
        for number, maximum in enumerate(largest, 1):
            text = f"{declared.description}, joint {number}"
            schema[f"{prefix}_{number}"] = Tunable(
                declared.unit, _SMALLEST, maximum, text
            )
    return {
        name: replace(
            tunable,
            minimum=min(tunable.minimum, gains[name]),
            maximum=max(tunable.maximum, gains[name]),
        )
        for name, tunable in schema.items()
    }


def bounds_of(gains: Mapping[str, float]) -> MotionBounds:
    """Return the limits of the follower's motion that the gains define."""

    def collect(prefix: str) -> NDArray[np.float64]:
        return np.array(_numbered(gains, prefix))

    return MotionBounds(
        velocity_far=collect("dq_l"),
        velocity_near=collect("dq_u"),
        acceleration_far=collect("ddq_l"),
        acceleration_near=collect("ddq_u"),
    )


def _numbered(gains: Mapping[str, float], prefix: str) -> Sequence[float]:
    return [gains[f"{prefix}_{number}"] for number in range(1, _DOF + 1)]
