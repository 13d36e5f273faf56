"""Let one arm follow another arm that is guided by hand, and feels its contacts.

Source: franka_ros@c11f000 franka_example_controllers,
src/teleop_joint_pd_example_controller.cpp; differs: the phase is published
as well, and a robot description without soft limits is refused.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.franka_arm import (
    claim_torques,
    find_state,
    read_arm_id,
    read_arm_joints,
)
from station.controllers.franka_example_controllers.follower_motion import (
    FollowerMotion,
    ramp,
)
from station.controllers.franka_example_controllers.teleop_parameters import (
    TELEOP_PARAMETERS,
    bounds_of,
    read_teleop_gains,
    read_teleop_parameters,
    teleop_schema,
)
from station.core.control.controller import ControllerSample, MultiInterfaceController
from station.core.control.tunables import Tunables
from station.core.description.robot_description import require_robot_description
from station.core.errors import ControllerStateError
from station.core.franka import FrankaStateHandle, FrankaStateInterface, RobotState
from station.core.hardware.interfaces import EffortJointInterface, JointGroup
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer


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
