"""Check that the joints can follow a motion of the end effector until it rests.

The arm keeps the position of joint 3 during a Cartesian motion. Near a position limit
of a joint and near singular poses the arm would abort the motion with an error. Every
step is therefore checked ahead, at the pose where the motion could rest after the step.
Jacobians and distances are computed again only when the joints have moved, not in every
cycle.
"""

from enum import Enum

from station.controllers.cartesian_motion.arm_configuration import (
    ELBOW,
    ArmConfiguration,
)
from station.controllers.cartesian_motion.cartesian_motion_generator import (
    CartesianMotionGenerator,
)
from station.controllers.cartesian_motion.lookahead_settings import LookaheadSettings
from station.core.description.robot_description import JointDescription
from station.core.franka import Frame, FrankaModelHandle
from station.core.franka.franka_robot_state import RobotState
from station.kernel.doubles import Doubles, doubles, put, zeros
from station.kernel.linear_kinematics import limited_joint, moved, way_between
from station.kernel.rigid_motion import twist_between

# Results for one configuration are used for configurations within this distance [rad].
_NEAR = 0.01
# Largest distance of a part of the arm from a joint axis that moves it [m].
_REACH = 1.2


class Obstacle(Enum):
    """The reason why the end effector waits or slows down."""

    NONE = "none"
    JOINT_LIMIT = "joint_limit"
    SINGULARITY = "singularity"
    SELF_COLLISION = "self_collision"
    JOINT_SPEED = "joint_speed"


class JointLookahead:
    """Computes the joint motion up to rest ahead of time. Control thread only.

    Args:
        model: The arm's model.
        joints: The arm's seven joints with their limits, from base to flange.
        settings: Margins that the motion keeps.

    Attributes:
        obstacle: What prevents the step that was checked last.
        joint: Name of the joint that is at its limit; None when no joint is.
    """

    def __init__(
        self,
        model: FrankaModelHandle,
        joints: list[JointDescription],
        settings: LookaheadSettings,
    ) -> None:
        self._model = model.model
        self._joints = joints
        self._settings = settings
        margin = settings.joint_limit_margin
        self._lower = doubles(joint.lower + margin for joint in joints)
        self._upper = doubles(joint.upper - margin for joint in joints)
        share = settings.joint_velocity_share
        self._velocity = doubles(joint.velocity * share for joint in joints)
        self._acceleration = doubles(settings.max_joint_acceleration)
        self.obstacle = Obstacle.NONE
        self.joint: str | None = None
        self._state = RobotState()
        self._elbow = 0.0
        self._q_d = self._state.doubles("q_d")
        nowhere = ArmConfiguration([0.0] * 7, [0.0] * 42)
        self._present = self._resting = nowhere
        # Pose of the end effector at the configuration at rest.
        self._pose = zeros(16)
        # Joint positions at rest: after the last allowed step, and after a new one.
        self._rest, self._new = zeros(7), zeros(7)
        self._way, self._step = zeros(6), zeros(7)
        self._dexterity = 0.0
        self._clearance, self._clear_at = 0.0, zeros(7)

    def start(self, state: RobotState) -> None:
        """Start at rest at the desired joint positions.

        Args:
            state: The arm's state, which is updated in every cycle.
        """
        self._state, self._q_d = state, state.doubles("q_d")
        self._elbow = self._q_d[ELBOW]
        self.obstacle, self.joint = Obstacle.NONE, None
        self._rest[:] = self._new[:] = self._clear_at[:] = self._q_d
        self._present = self._resting = self._configuration(self._q_d)
        self._place_pose()
        self._dexterity = self._resting.dexterity()
        self._clearance = self._model.clearance(self._q_d)

    def allows(self, motion: CartesianMotionGenerator) -> bool:
        """Return whether the joints can follow a step; note the obstacle if not.

        A step that increases the distance to an obstacle is allowed, so that the arm
        can leave a pose with too small a margin.

        Args:
            motion: The motion after the step.
        """
        resting, q, step = self._resting, self._new, self._step
        twist_between(self._pose, motion.resting_pose(), 1.0, self._way)
        resting.motion.joint_step(self._way, self._elbow, step)
        if moved(resting.q, step, q) > _NEAR:
            resting = self._configuration(q)
        self.joint = None
        self.obstacle = self._obstacle_at(resting)
        if self.obstacle is Obstacle.NONE:
            self.obstacle = self._speed_obstacle(resting, motion)
        if self.obstacle is not Obstacle.NONE:
            return False
        if resting is not self._resting:
            self._resting = resting
            self._place_pose()
        self._rest[:] = q
        return True

    def _obstacle_at(self, resting: ArmConfiguration) -> Obstacle:
        """Return what keeps the arm from resting at the new joint positions.

        Args:
            resting: A configuration near these positions.
        """
        q = self._new
        limited = limited_joint(q, self._rest, self._lower, self._upper)
        if limited >= 0:
            self.joint = self._joints[limited].name
            return Obstacle.JOINT_LIMIT
        dexterity = self._dexterity
        if resting is not self._resting:
            dexterity = resting.dexterity()
            if dexterity < min(self._settings.least_dexterity, self._dexterity):
                return Obstacle.SINGULARITY
        least = self._settings.least_clearance
        room = max(_NEAR, (self._clearance - least) / _REACH)
        if way_between(q, self._clear_at) > room:
            clearance = self._model.clearance(q)
            if clearance < min(least, self._clearance):
                return Obstacle.SELF_COLLISION
            self._clearance = clearance
            self._clear_at[:] = q
        self._dexterity = dexterity
        return Obstacle.NONE

    def _speed_obstacle(
        self, resting: ArmConfiguration, motion: CartesianMotionGenerator
    ) -> Obstacle:
        if way_between(self._q_d, self._present.q) > _NEAR:
            self._present = self._configuration(self._q_d)
        for configuration in (self._present, resting):
            fastest = configuration.motion.fastest_joint(
                motion.twist,
                motion.accelerations,
                self._velocity,
                self._acceleration,
            )
            if fastest >= 0:
                self.joint = self._joints[fastest].name
                return Obstacle.JOINT_SPEED
        return Obstacle.NONE

    def _configuration(self, q: Doubles) -> ArmConfiguration:
        state, model, frame = self._state, self._model, Frame.END_EFFECTOR
        jacobian = model.zero_jacobian(frame, q, state.F_T_EE, state.EE_T_K)
        return ArmConfiguration(q, jacobian)

    def _place_pose(self) -> None:
        state, model, frame = self._state, self._model, Frame.END_EFFECTOR
        q = self._resting.q
        put(self._pose, model.pose(frame, q, state.F_T_EE, state.EE_T_K))
