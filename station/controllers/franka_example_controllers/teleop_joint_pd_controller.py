"""Let a follower arm track a hand-guided leader, which feels its contacts.

Source: franka_ros@c11f000 franka_example_controllers, cfg/teleop_param.cfg and
src/teleop_joint_pd_example_controller.cpp; differs: the phase is published as well, a
robot description without soft limits is refused, and the run-time parameters can always
be changed, not only with `debug`, and start with the configured values.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt, tanh
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.franka_arm import (
    ARM_ID,
    JOINT_NAMES,
    claim_torques,
    find_state,
    read_arm_id,
    read_arm_joints,
)
from station.core.control.controller import ControllerSample, MultiInterfaceController
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import (
    DeclaredParameter,
    declare_number,
    declare_numbers,
)
from station.core.description.robot_description import require_robot_description
from station.core.errors import ControllerStateError
from station.core.franka import FrankaStateHandle, FrankaStateInterface, RobotState
from station.core.hardware.interfaces import EffortJointInterface, JointGroup
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer

ALIGNMENT_TOLERANCE = 0.01
"""Distance of every joint to the leader's below which the arms are aligned [rad]."""
_ALIGN_P = np.array([45.0, 45.0, 45.0, 45.0, 18.0, 11.0, 5.0])
_ALIGN_D = np.array([4.5, 4.5, 4.5, 4.5, 1.5, 1.5, 1.0])
_ALIGN_VELOCITY = np.full(7, 0.1)
_ALIGN_ACCELERATION = np.full(7, 0.5)
_RAMP_SHIFT = 0.25
_RAMP_INCREASE = 20.0


@dataclass(frozen=True, slots=True)
class MotionBounds:
    """Limits of the follower's motion, shape (7,) each.

    Attributes:
        velocity_far: Largest velocities far behind the leader [rad/s].
        velocity_near: Largest velocities close to the leader [rad/s].
        acceleration_far: Largest accelerations far behind the leader [rad/s^2].
        acceleration_near: Largest accelerations close to the leader [rad/s^2].
    """

    velocity_far: NDArray[np.float64]
    velocity_near: NDArray[np.float64]
    acceleration_far: NDArray[np.float64]
    acceleration_near: NDArray[np.float64]


class FollowerMotion:
    """The desired motion of the follower's joints: first to align, then to track.

    Control thread only. Differs from the original: a cycle with a period of 0 moves
    nothing instead of dividing by zero.

    Args:
        drift_gains: Velocity per distance to the leader [1/s], shape (7,).

    Attributes:
        is_tracking: Whether the arms have been aligned since the start.
        start: Positions of the leader at the start [rad], shape (7,).
        q: Target positions [rad], shape (7,).
        dq: Target velocities [rad/s], shape (7,).
    """

    def __init__(self, drift_gains: NDArray[np.float64]) -> None:
        self._drift_gains = drift_gains
        self.begin_alignment(np.zeros(7), np.zeros(7))

    def begin_alignment(
        self, leader_q: NDArray[np.float64], follower_q: NDArray[np.float64]
    ) -> None:
        """Start to align the follower.

        Args:
            leader_q: Positions of the leader, which is to keep them [rad], shape (7,).
            follower_q: Positions of the follower [rad], shape (7,).
        """
        self.is_tracking = False
        self.start, self.q = leader_q, follower_q
        self.dq = np.zeros(7)
        self._error = leader_q - follower_q

    def update(
        self,
        leader: tuple[NDArray[np.float64], NDArray[np.float64]],
        follower_q: NDArray[np.float64],
        bounds: MotionBounds,
        period: float,
    ) -> None:
        """Advance the desired motion by one period.

        Args:
            leader: Positions [rad] and velocities [rad/s] of the leader, shape (7,)
                each.
            follower_q: Positions of the follower [rad], shape (7,).
            bounds: Limits of the motion while the follower tracks the leader.
            period: Time since the last cycle [s], >= 0.
        """
        q, dq = leader
        if np.abs(q - follower_q).max() < ALIGNMENT_TOLERANCE:
            self.is_tracking = True
        if self.is_tracking:
            behind = np.abs(self.q - q)
            share = np.array([
                ramp(x, 0.0, 1.0, _RAMP_SHIFT, _RAMP_INCREASE) for x in behind
            ])
            velocity = bounds.velocity_near + share * (
                bounds.velocity_far - bounds.velocity_near
            )
            acceleration = bounds.acceleration_near + share * (
                bounds.acceleration_far - bounds.acceleration_near
            )
            wanted = self._drift_gains * (q - self.q) + dq
        else:
            velocity, acceleration = _ALIGN_VELOCITY, _ALIGN_ACCELERATION
            wanted = self._aligning_velocity(follower_q, period)
        step = acceleration * period
        reachable = self.dq + np.clip(wanted - self.dq, -step, step)
        self.dq = np.clip(reachable, -velocity, velocity)
        self.q = self.q + self.dq * period

    def _aligning_velocity(
        self, follower_q: NDArray[np.float64], period: float
    ) -> NDArray[np.float64]:
        last, self._error = self._error, self.start - follower_q
        rate = (self._error - last) / period if period > 0.0 else np.zeros(7)
        result: NDArray[np.float64] = _ALIGN_P * self._error + _ALIGN_D * rate
        return result


def ramp(x: float, low: float, high: float, shift: float, increase: float) -> float:
    """Return a smooth step from `low` to `high` around `shift`.

    Args:
        x: The argument.
        low: Value far below `shift`.
        high: Value far above `shift`.
        shift: Argument at which the value is halfway between `low` and `high`.
        increase: Steepness of the step, > 0.
    """
    return 0.5 * (low + high + (high - low) * tanh(increase * (x - shift)))


_DOF = 7


def _seven(name: str, unit: str, text: str) -> DeclaredParameter:
    return declare_numbers(name, text, unit=unit, size=_DOF)


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
_CONTACT = declare_number(
    "contact_force_threshold",
    "force at the hand above which the arm is in contact",
    unit="N",
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
    **{
        f"{role}_{_CONTACT.name}": Tunable(
            "N",
            0.1,
            10.0,
            "a larger force is a contact",
            parameter=_CONTACT.inside(role).name,
        )
        for role in ROLES
    },
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
    """Return unit and range of each gain; a configured value widens its range."""
    schema = dict(_SCALARS)
    for prefix, largest in _BOUNDS.items():
        declared = _MOTION[prefix]
        for number, maximum in enumerate(largest, 1):
            text = f"{declared.description}, joint {number}"
            schema[f"{prefix}_{number}"] = Tunable(
                declared.unit,
                _SMALLEST,
                maximum,
                text,
                parameter=f"{declared.name}[{number - 1}]",
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


@dataclass(frozen=True, slots=True)
class WallShape:
    """The wall at each end of a joint's range.

    Attributes:
        spring_width: Width of the spring zone next to the limit, in which spring and
            damper act [rad].
        damper_width: Width of the damper zone before the spring zone [rad].
        stiffness: Stiffness of the spring [Nm/rad].
        spring_damping: Damping in the spring zone [Nms/rad].
        damping: Damping in the damper zone [Nms/rad].

    Source:
        franka_ros@c11f000 franka_example_controllers, src/joint_wall.cpp; differs: a
        joint beyond its limits is refused at the start instead of ending the process,
        and a restart computes the width of the walls again.
    """

    spring_width: float
    damper_width: float
    stiffness: float
    spring_damping: float
    damping: float


class JointWall:
    """The walls of one joint. Control thread only.

    A joint that starts inside of a wall is not pushed out of it: the wall is narrowed
    until the joint is at its edge, and grows again while the joint moves away.

    Args:
        name: The joint.
        lower: Lower limit of the joint [rad].
        upper: Upper limit of the joint [rad].
        shape: Widths, stiffness and damping of both walls.
    """

    def __init__(self, name: str, lower: float, upper: float, shape: WallShape) -> None:
        self._name = name
        self._lower = lower
        self._upper = upper
        self._shape = shape
        self._width = shape.spring_width + shape.damper_width
        self._scale = 1.0

    def start_at(self, q: float) -> None:
        """Start at a position [rad].

        Raises:
            ControllerStateError: The position is beyond the limits.
        """
        if not self._lower <= q <= self._upper:
            raise ControllerStateError(
                f"Joint '{self._name}' is at {q:.4f} rad, beyond its soft limits "
                f"{self._lower:.4f} to {self._upper:.4f} rad.",
                remedy="Move the joint between its limits first.",
                details={"joint": self._name, "position": q},
            )
        self._scale = min(1.0, self._room(q) / self._width) if self._width else 1.0

    def torque(self, q: float, dq: float) -> float:
        """Return the wall's torque [Nm].

        Args:
            q: Position [rad].
            dq: Velocity [rad/s].
        """
        self._grow(q, dq)
        shape = self._shape
        spring = self._scale * shape.spring_width
        width = self._scale * self._width
        if q > self._upper - spring:
            return self._spring_torque(self._upper - spring - q, dq)
        if q < self._lower + spring:
            return self._spring_torque(self._lower + spring - q, dq)
        if q >= self._upper - width or q <= self._lower + width:
            return -shape.damping * dq
        return 0.0

    def _room(self, q: float) -> float:
        """Return the distance of a position to the nearer limit [rad]."""
        return min(abs(q - self._lower), abs(q - self._upper))

    def _grow(self, q: float, dq: float) -> None:
        if self._scale == 1.0:
            return
        room = self._room(q)
        if room >= self._width:
            self._scale = 1.0
        elif (dq > 0.0) == (q - self._lower < self._upper - q) and dq != 0.0:
            self._scale = max(self._scale, room / self._width)

    def _spring_torque(self, away: float, dq: float) -> float:
        return self._shape.stiffness * away - self._shape.spring_damping * dq


def wall_torques(
    walls: Sequence[JointWall], q: Sequence[float], dq: Sequence[float]
) -> list[float]:
    """Return the torques of the walls of several joints [Nm], shape (n,)."""
    return [
        wall.torque(position, velocity)
        for wall, position, velocity in zip(walls, q, dq, strict=True)
    ]


RATE_HZ = 60.0
"""Rate at which targets and contacts are published [Hz]."""
DECREASE = 0.95
"""Factor of the torques in each cycle in which an arm has an error."""
_CONTACT_INCREASE = 0.3
_WALLS = [
    WallShape(0.12, 0.12, 2000.0, 30.0, 30.0),
    WallShape(0.09, 0.09, 2000.0, 30.0, 30.0),
    WallShape(0.09, 0.09, 1000.0, 30.0, 30.0),
    WallShape(0.09, 0.09, 1000.0, 10.0, 10.0),
    WallShape(0.0349, 0.0349, 500.0, 5.0, 5.0),
    WallShape(0.0349, 0.0349, 200.0, 5.0, 5.0),
    WallShape(0.0349, 0.0349, 200.0, 5.0, 5.0),
]


@dataclass(slots=True)
class _Arm:
    joint_names: list[str]
    joints: JointGroup
    state: FrankaStateHandle
    walls: list[JointWall]
    tau: NDArray[np.float64]
    contact: float = 0.0

    def command_torques(self, tau: NDArray[np.float64], state: RobotState) -> None:
        """Command torques plus those of the joint walls."""
        self.tau = tau + wall_torques(self.walls, state.q, state.dq)
        self.joints.set_commands(self.tau.tolist())


class TeleopJointPDExampleController(MultiInterfaceController):
    """Lets a follower arm track a leader arm that is guided by hand.

    After the start the leader holds still while the follower moves to the leader's
    pose. Once the arms are aligned, the follower tracks the leader, and the leader
    feels the external torques of the follower.

    Parameters, in `leader` and `follower` each: `arm_id`; `joint_names`, 7 names;
    `contact_force_threshold` [N]. In `leader`: `d_gains_lower`, `d_gains_upper`
    [Nms/rad] and `dq_max_lower`, `dq_max_upper` [rad/s], 7 numbers each, as in
    `LeaderDamping`. In `follower`: `p_gains` [Nm/rad], `d_gains` [Nms/rad],
    `drift_comp_gains` [1/s], and as in `MotionBounds`, `lower` for far and `upper` for
    near, `dq_max_…` [rad/s], `ddq_max_…` [rad/s^2].
    """

    required_interfaces: ClassVar[tuple[type, ...]] = (
        EffortJointInterface,
        FrankaStateInterface,
    )
    own_parameters = TELEOP_PARAMETERS

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        self._parameters = read_teleop_parameters(params)
        gains = read_teleop_gains(params)
        self.tunables = Tunables(teleop_schema(gains), gains, apply=self._set_bounds)
        self._set_bounds(gains)
        self._leader = _find_arm(hw, params, "leader")
        self._follower = _find_arm(hw, params, "follower")
        self._motion = FollowerMotion(self._parameters.drift_gains)
        self.joint_names = self._follower.joint_names
        self._timer = PublishTimer(RATE_HZ)

    @override
    def starting(self, time: float) -> None:
        """Start to align the follower.

        Raises:
            ControllerStateError: A joint is beyond its soft limits.
        """
        for arm in (self._leader, self._follower):
            q = arm.state.get_robot_state().q
            for wall, position in zip(arm.walls, q, strict=True):
                wall.start_at(position)
            arm.tau = np.zeros(len(q))
        self._motion.begin_alignment(
            np.array(self._leader.state.get_robot_state().q),
            np.array(self._follower.state.get_robot_state().q),
        )
        self._timer.start(time, at_once=True)

    @override
    def update(self, time: float, period: float) -> None:
        leader = self._leader.state.get_robot_state()
        follower = self._follower.state.get_robot_state()
        gains = self.tunables.values
        self._leader.contact = _contact(leader, gains["leader_contact_force_threshold"])
        self._follower.contact = _contact(
            follower, gains["follower_contact_force_threshold"]
        )
        lead = (np.array(leader.q), np.array(leader.dq))
        self._motion.update(lead, np.array(follower.q), self._bounds, period)
        if any(leader.current_errors) or any(follower.current_errors):
            led, followed = DECREASE * self._leader.tau, DECREASE * self._follower.tau
        else:
            led = self._leader_torques(leader, follower)
            followed = self._follower_torques(follower)
        self._leader.command_torques(led, leader)
        self._follower.command_torques(followed, follower)
        q_target, tau = self._motion.q.tolist(), self._follower.tau.tolist()
        error = (self._motion.q - follower.q).tolist()
        self.sample = ControllerSample(time, q_target, list(follower.q), error, tau)
        if self._timer.is_due(time):
            self._publish()

    def _set_bounds(self, gains: Mapping[str, float]) -> None:
        self._bounds = bounds_of(gains)

    def _leader_torques(
        self, leader: RobotState, follower: RobotState
    ) -> NDArray[np.float64]:
        tau: NDArray[np.float64]
        if not self._motion.is_tracking:
            tau = self._parameters.stiffness * (self._motion.start - leader.q)
        else:
            gains, dq = self.tunables.values, np.array(leader.dq)
            idle, guiding = (
                gains["force_feedback_idle"],
                gains["force_feedback_guiding"],
            )
            share = idle + self._leader.contact * (guiding - idle)
            felt = share * self._follower.contact
            tau = -felt * np.array(follower.tau_ext_hat_filtered)
            scaling = gains["leader_damping_scaling"]
            tau -= scaling * self._parameters.damping.damping(dq) * dq
        return tau

    def _follower_torques(self, follower: RobotState) -> NDArray[np.float64]:
        scaling = self.tunables.values["follower_stiffness_scaling"]
        stiffness = scaling * self._parameters.stiffness
        damping = sqrt(scaling) * self._parameters.follower_damping
        result: NDArray[np.float64] = stiffness * (self._motion.q - follower.q)
        result += damping * (self._motion.dq - follower.dq)
        return result

    def _publish(self) -> None:
        # The original's topics of targets and contacts, and `phase`.
        leader, follower = self._leader, self._follower
        self.messages = {
            "leader_target": {
                "name": leader.joint_names,
                "effort": leader.tau.tolist(),
            },
            "follower_target": {
                "name": follower.joint_names,
                "position": self._motion.q.tolist(),
                "velocity": self._motion.dq.tolist(),
                "effort": follower.tau.tolist(),
            },
            "leader_contact": {"data": leader.contact},
            "follower_contact": {"data": follower.contact},
            "phase": {"data": "track" if self._motion.is_tracking else "align"},
        }


def _find_arm(hw: RobotHW, params: Parameters, role: str) -> _Arm:
    own = params.namespace(role)
    arm_id, names = read_arm_id(own), read_arm_joints(own)
    return _Arm(
        names,
        claim_torques(hw, names),
        find_state(hw, arm_id),
        _find_walls(params, names),
        np.zeros(len(names)),
    )


def _find_walls(params: Parameters, names: Sequence[str]) -> list[JointWall]:
    description = require_robot_description(params)
    walls = []
    for name, shape in zip(names, _WALLS, strict=True):
        lower, upper = description.soft_limits(name)
        walls.append(JointWall(name, lower, upper, shape))
    return walls


def _contact(state: RobotState, threshold: float) -> float:
    """Return the degree to which an arm is in contact, 0 to 1."""
    force = float(np.linalg.norm(state.K_F_ext_hat_K[:3]))
    return ramp(force, 0.0, 1.0, threshold, _CONTACT_INCREASE)
