"""Check that the joints can follow a motion of the end effector until it rests.

The arm keeps the position of joint 3 during a Cartesian motion. Near a position limit
of a joint and near singular poses the arm would abort the motion with an error. Every
step is therefore checked ahead, at the pose where the motion could rest after the step.
Jacobians and distances are computed again only when the joints have moved, not in every
cycle.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

import numpy as np

from station.controllers.cartesian_motion.cartesian_motion_generator import PoseMotion
from station.controllers.cartesian_motion.linear_kinematics import (
    LinearKinematics,
    StopPrediction,
)
from station.core.declared_parameter import (
    DeclaredParameter,
    ParameterType,
    declare_number,
)
from station.core.description.robot_description import JointDescription
from station.core.franka import Frame, FrankaModelHandle
from station.core.franka.franka_model import FrankaModel
from station.core.franka.franka_robot_state import RobotState
from station.core.parameters import Parameters
from station.memory.doubles import Doubles, own, zeros
from station.memory.vectors import copy_into

_DOF = 7
ELBOW = 2
"""Index of joint 3, whose position is kept."""


class ArmConfiguration:
    """The linearised kinematics at one configuration of an arm with seven joints.

    Args:
        model: The arm's model.
        state: State of the arm, which has frame and load of the end effector.
        velocity: Largest joint velocities [rad/s], shape (7,).
        acceleration: Largest joint accelerations [rad/s^2], shape (7,).

    Attributes:
        motion: Motions of the joints that belong to motions of the end effector.
    """

    def __init__(
        self,
        model: FrankaModel,
        state: RobotState,
        velocity: Iterable[float],
        acceleration: Iterable[float],
    ) -> None:
        q, jacobian = own([0.0] * _DOF), own([0.0] * (6 * _DOF))
        frame = Frame.END_EFFECTOR
        tool = state.doubles("F_T_EE"), state.doubles("EE_T_K")
        self._pose_source = model.pose_source(frame, q, *tool)
        self._jacobian_source = model.zero_jacobian_source(frame, q, *tool)
        self.motion = LinearKinematics(q, jacobian, own(velocity), own(acceleration))
        self._q, self._jacobian = q, jacobian

    def move_to(self, q: Doubles) -> None:
        """Take another configuration.

        Args:
            q: Joint positions [rad], shape (7,).
        """
        copy_into(self._q, 0, q, _DOF)
        self._jacobian_source.write(self._jacobian)
        self.motion.invert()

    def place(self, pose: Doubles) -> None:
        """Write the pose of the end effector, 16 numbers."""
        self._pose_source.write(pose)

    def dexterity(self) -> float:
        """Return the smallest singular value of the extended Jacobian.

        The extended Jacobian maps joint velocities to the twist of the end effector and
        the velocity of joint 3. The value is 0 at a singular pose.
        """
        matrix = np.zeros((_DOF, _DOF))
        matrix[:6] = np.reshape(self._jacobian, (_DOF, 6)).T
        matrix[6, ELBOW] = 1.0
        return float(np.linalg.svd(matrix, compute_uv=False).min())


LARGEST_JOINT_ACCELERATION = (10.0, 7.5, 10.0, 10.0, 10.0, 10.0, 10.0)
"""Largest joint accelerations that both kinds of Franka arms allow [rad/s^2].

Source: Franka Control Interface documentation, Robot and interface specifications.
"""


@dataclass(frozen=True, slots=True)
class LookaheadSettings:
    """Margins that a motion keeps.

    Attributes:
        joint_limit_margin: Smallest distance to the position limits of the joints
            [rad], 0 to 1.
        least_dexterity: Smallest value allowed of `ArmConfiguration.dexterity`, 0.01 to
            1. The dexterity is 0 at a singular pose, and about 0.2 in the middle of the
            workspace.
        least_clearance: Smallest distance between two parts of the arm [m], 0 to 0.3.
        joint_velocity_share: Share of the joints' velocity limits that a motion may
            use, 0.01 to 1.
        max_joint_acceleration: Largest acceleration of each joint [rad/s^2], shape
            (7,), above 0 and at most `LARGEST_JOINT_ACCELERATION`.
    """

    joint_limit_margin: float = 0.05
    least_dexterity: float = 0.05
    least_clearance: float = 0.05
    joint_velocity_share: float = 0.5
    max_joint_acceleration: tuple[float, ...] = (7.0, 5.0, 7.0, 7.0, 7.0, 7.0, 7.0)


def _declare(
    name: str, unit: str, bounds: tuple[float, float], description: str
) -> DeclaredParameter:
    return declare_number(
        name,
        description,
        float(getattr(_DEFAULT, name)),
        unit,
        minimum=bounds[0],
        maximum=bounds[1],
    )


_DEFAULT = LookaheadSettings()
_MARGINS = (
    _declare(
        "joint_limit_margin",
        "rad",
        (0.0, 1.0),
        "distance to a joint's position limit at which the arm waits",
    ),
    _declare(
        "least_dexterity",
        "",
        (0.01, 1.0),
        "smallest singular value of the Jacobian at which the arm waits: 0 at a "
        "singular pose, about 0.2 in mid-range",
    ),
    _declare(
        "least_clearance",
        "m",
        (0.0, 0.3),
        "distance between two parts of the arm, hand included, at which the arm waits",
    ),
    _declare(
        "joint_velocity_share",
        "",
        (0.01, 1.0),
        "share of the joints' velocity limits that a motion may use",
    ),
)
_MAX_JOINT_ACCELERATION = DeclaredParameter(
    name="max_joint_acceleration",
    type=ParameterType.NUMBER_OR_NUMBERS,
    unit="rad/s^2",
    default=_DEFAULT.max_joint_acceleration,
    minimum=0.0,
    excludes_minimum=True,
    maximum=max(LARGEST_JOINT_ACCELERATION),
    size=len(LARGEST_JOINT_ACCELERATION),
    description="largest joint acceleration; one number, or seven; at most 10, "
    "joint 2: 7.5",
)
LOOKAHEAD_PARAMETERS = (*_MARGINS, _MAX_JOINT_ACCELERATION)
"""The parameters that are named after the attributes of `LookaheadSettings`."""


def read_lookahead_settings(params: Parameters) -> LookaheadSettings:
    """Read the parameters that are named after the attributes of the settings.

    `max_joint_acceleration` is one number for all joints, or a list with one number per
    joint.

    Args:
        params: The controller's namespace.

    Raises:
        ParameterError: A value is out of its range.
    """
    margins = {each.name: each.read_float(params) for each in _MARGINS}
    accelerations = _MAX_JOINT_ACCELERATION.read_per_axis(params)
    for value, bound in zip(accelerations, LARGEST_JOINT_ACCELERATION, strict=True):
        if value > bound:
            allowed = f"at most {list(LARGEST_JOINT_ACCELERATION)}"
            _MAX_JOINT_ACCELERATION.refuse(params, accelerations, allowed)
    return LookaheadSettings(**margins, max_joint_acceleration=tuple(accelerations))


# Largest distance of a part of the arm from a joint axis that moves it [m].
_REACH = 1.2


class Obstacle(Enum):
    """The reason why the end effector waits or slows down."""

    NONE = "none"
    JOINT_LIMIT = "joint_limit"
    SINGULARITY = "singularity"
    SELF_COLLISION = "self_collision"
    JOINT_SPEED = "joint_speed"


# A member of an enumeration takes Python ten times as long to find.
_NONE = Obstacle.NONE


class JointLookahead:
    """Computes the joint motion up to rest ahead of time. Control thread only.

    Args:
        model: The arm's model.
        joints: The arm's seven joints with their limits, from base to flange.
        settings: Margins that the motion keeps.

    Attributes:
        obstacle: Reason that prevents the step that was checked last.
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
        # Pose of the end effector at the configuration at rest, and joint positions at
        # rest after a new step.
        self._pose, self._new = zeros(16), zeros(7)
        self._prediction = StopPrediction(
            self._pose,
            self._new,
            lower=[joint.lower + margin for joint in joints],
            upper=[joint.upper - margin for joint in joints],
        )
        self.obstacle = _NONE
        self.joint: str | None = None
        # One near the desired positions, one near those at rest, and one for the next.
        self._present: ArmConfiguration
        self._resting: ArmConfiguration
        self._other: ArmConfiguration
        self._know(RobotState())
        self._dexterity, self._clearance = 0.0, 0.0

    def start(self, state: RobotState) -> None:
        """Start at rest at the desired joint positions.

        Args:
            state: The arm's state, which is updated in every cycle.
        """
        self._know(state)
        self.obstacle, self.joint = _NONE, None
        self._prediction.start_at_rest(self._q_d)
        for each in (self._present, self._resting):
            each.move_to(self._q_d)
        self._resting.place(self._pose)
        self._dexterity = self._resting.dexterity()
        self._note_clearance(self._model.clearance(self._q_d))

    def passes(self, motion: PoseMotion) -> bool:
        """Accept a step that is certainly allowed; return whether it was accepted.

        A step that comes near a limit or leads away from the known configurations stays
        undecided: `allows` has to check it.

        Args:
            motion: The motion after the step.
        """
        if not self._prediction.passes(motion):
            return False
        self.obstacle, self.joint = _NONE, None
        return True

    def allows(self, motion: PoseMotion) -> bool:
        """Return whether the joints can follow a step; note the obstacle if not.

        A step that increases the distance to an obstacle is allowed, so that the arm
        can leave a pose with too small a margin.

        Args:
            motion: The motion after the step.
        """
        resting = self._resting
        if self._prediction.leads_away(motion):
            resting = self._other
            resting.move_to(self._new)
        self.joint = None
        self.obstacle = self._obstacle_at(resting)
        if self.obstacle is _NONE:
            self.obstacle = self._speed_obstacle(resting.motion, motion)
        if self.obstacle is not _NONE:
            return False
        if resting is not self._resting:
            self._resting, self._other = resting, self._resting
            self._prediction.resting = resting.motion
            resting.place(self._pose)
        self._prediction.accept()
        return True

    def _obstacle_at(self, resting: ArmConfiguration) -> Obstacle:
        """Return the obstacle that keeps the arm from resting at the new positions.

        Args:
            resting: A configuration near these positions.
        """
        limited = self._prediction.limited_joint()
        if limited >= 0:
            self.joint = self._joints[limited].name
            return Obstacle.JOINT_LIMIT
        dexterity = self._dexterity
        if resting is not self._resting:
            dexterity = least = self._settings.least_dexterity
            # Singular values take long to compute, so only where they matter.
            if not resting.motion.is_dexterous(least):
                dexterity = resting.dexterity()
                if dexterity < min(least, self._dexterity):
                    return Obstacle.SINGULARITY
        if self._prediction.may_collide():
            clearance = self._model.clearance(self._new)
            if clearance < min(self._settings.least_clearance, self._clearance):
                return Obstacle.SELF_COLLISION
            self._note_clearance(clearance)
        self._dexterity = dexterity
        return _NONE

    def _speed_obstacle(
        self, resting: LinearKinematics, motion: PoseMotion
    ) -> Obstacle:
        if self._prediction.has_left():
            self._present.move_to(self._q_d)
        for kinematics in (self._present.motion, resting):
            fastest = kinematics.fastest_joint(motion.twist, motion.accelerations)
            if fastest >= 0:
                self.joint = self._joints[fastest].name
                return Obstacle.JOINT_SPEED
        return _NONE

    def _note_clearance(self, clearance: float) -> None:
        """Note the least distance of parts of the arm [m] at the new positions."""
        self._clearance = clearance
        # No part of the arm moves further than its distance from a joint times the way
        # of that joint.
        self._prediction.note_clearance(
            (clearance - self._settings.least_clearance) / _REACH
        )

    def _know(self, state: RobotState) -> None:
        """Make room for configurations of an arm with this state."""
        self._q_d = state.doubles("q_d")
        share = self._settings.joint_velocity_share
        velocity = [joint.velocity * share for joint in self._joints]
        largest = self._settings.max_joint_acceleration
        self._present, self._resting, self._other = (
            ArmConfiguration(self._model, state, velocity, largest) for _ in range(3)
        )
        self._prediction.present = self._present.motion
        self._prediction.resting = self._resting.motion
