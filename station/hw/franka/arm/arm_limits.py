"""The limits of an arm's joints and of its end effector, Panda and FR3.

Source: Franka Control Interface documentation, Robot and interface specifications;
libfranka@0.9.2 and @0.15.0 include/franka/rate_limiting.h; franka_ros@c11f000
franka_description/robots/fr3/joint_limits.yaml; differs: the Panda's
translational velocity is that of libfranka's limiter, 2.0 m/s, not the documented
1.7 m/s, so that what the limiter lets pass raises no error.
"""

from dataclasses import dataclass
from math import sqrt


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Limits of one motion, translation [m], rotation [rad] or elbow [rad].

    Attributes:
        velocity: Per second, > 0.
        acceleration: Per second squared, > 0.
        jerk: Per second cubed, > 0.
    """

    velocity: float
    acceleration: float
    jerk: float

    def bounds(self) -> tuple[float, float, float]:
        """Return velocity, acceleration and jerk."""
        return self.velocity, self.acceleration, self.jerk


@dataclass(frozen=True, slots=True)
class UrdfLimits:
    """The limits that a URDF states for an arm's joints, tuples of shape (7,).

    Where velocity limits depend on the position, a URDF can but give a range of
    positions in which a lower velocity is always allowed.

    Attributes:
        lower: Lowest positions [rad].
        upper: Highest positions [rad].
        velocity: [rad/s].
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    velocity: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ArmLimits:
    """Limits of one kind of arm; tuples have one number per joint, shape (7,).

    Attributes:
        lower: Lowest positions [rad].
        upper: Highest positions [rad].
        velocity: Of the joints [rad/s].
        acceleration: Of the joints [rad/s^2].
        jerk: Of the joints [rad/s^3].
        torque: Of the joints [Nm].
        torque_rate: Of commanded torques [Nm/s].
        translation: Of the end effector.
        rotation: Of the end effector.
        elbow: Of the elbow angle.
        limiter_elbow_velocity: Up to which libfranka's limiter lets the elbow go
            [rad/s].
        tolerated_losses: Lost packets for which the velocity limit leaves room.
        urdf: Limits in a URDF of the arm, if they differ; None: these limits.
        curves: (a, b, upper, lower) per joint of limits that depend on the position,
            see `velocity_range`; empty where there are none. They end at rest, so that
            no position limit of commands is needed besides.
        filters_first_pose: The low-pass acts on the first position or pose of a motion,
            too.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]
    torque: tuple[float, ...]
    torque_rate: float
    translation: MotionLimits
    rotation: MotionLimits
    elbow: MotionLimits
    limiter_elbow_velocity: float
    tolerated_losses: int
    urdf: UrdfLimits | None = None
    curves: tuple[tuple[float, float, float, float], ...] = ()
    filters_first_pose: bool = True

    def velocity_range(self, joint: int, q: float) -> tuple[float, float]:
        """Return the lowest and the highest velocity of a joint [rad/s].

        Args:
            joint: Index of the joint, 0 to 6.
            q: Its position [rad].
        """
        highest = self.velocity[joint]
        if not self.curves:
            return -highest, highest
        a, b, upper, lower = self.curves[joint]
        # Beyond its limit, where the root has no real value, a joint may only come
        # back.
        up = min(highest, max(0.0, sqrt(max(0.0, b * (upper - q))) - a))
        down = max(-highest, min(0.0, a - sqrt(max(0.0, b * (q - lower)))))
        return down, up


PANDA_LIMITS = ArmLimits(
    lower=(-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973),
    upper=(2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973),
    velocity=(2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61),
    acceleration=(15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
    jerk=(7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0),
    torque=(87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0),
    torque_rate=1000.0,
    translation=MotionLimits(2.0, 13.0, 6500.0),
    rotation=MotionLimits(2.5, 25.0, 12500.0),
    elbow=MotionLimits(2.175, 10.0, 5000.0),
    limiter_elbow_velocity=2.175,
    tolerated_losses=3,
)
"""The Panda (FER)."""

FR3_LIMITS = ArmLimits(
    lower=(-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159),
    upper=(2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159),
    velocity=(2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26),
    acceleration=(10.0,) * 7,
    jerk=(5000.0,) * 7,
    torque=(87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0),
    torque_rate=1000.0,
    translation=MotionLimits(3.0, 9.0, 4500.0),
    rotation=MotionLimits(2.5, 17.0, 8500.0),
    elbow=MotionLimits(2.62, 10.0, 5000.0),
    limiter_elbow_velocity=1.5,
    tolerated_losses=0,
    urdf=UrdfLimits(
        lower=(-2.3093, -1.5133, -2.4937, -2.7478, -2.4800, 0.8521, -2.6895),
        upper=(2.3093, 1.5133, 2.4937, -0.4461, 2.4800, 4.2094, 2.6895),
        velocity=(2.0, 1.0, 1.5, 1.25, 3.0, 1.5, 3.0),
    ),
    curves=(
        (0.30, 12.0, 2.75010, -2.75010),
        (0.20, 5.17, 1.79180, -1.79180),
        (0.20, 7.00, 2.90650, -2.90650),
        (0.30, 8.00, -0.1458, -3.0481),
        (0.35, 34.0, 2.81010, -2.81010),
        (0.35, 11.0, 4.52050, 0.54092),
        (0.35, 34.0, 3.01960, -3.01960),
    ),
    filters_first_pose=False,
)
"""The Franka Research 3."""

LIMITS_OF_ARM = {"panda": PANDA_LIMITS, "fr3": FR3_LIMITS}
"""Limits by the kind of arm."""
