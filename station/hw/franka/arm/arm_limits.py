"""The limits of an arm's joints and of its end effector, Panda and FR3.

The thresholds at which an arm stops by itself are here, too; Franka does not publish
them.

Source: Franka Control Interface documentation, Robot and interface specifications;
libfranka@0.9.2 and @0.15.0 include/franka/rate_limiting.h; libfranka@0.20.4
test/fr3.urdf, `position_based_velocity_limits`; franka_ros@c11f000
franka_description/robots/fr3/joint_limits.yaml; franka_description@1.0.1
robots/fr3/inertials.yaml; differs: the Panda's
translational velocity is that of libfranka's limiter, 2.0 m/s, not the documented
1.7 m/s, so that the limiter's output raises no error.
"""

from dataclasses import dataclass
from math import inf, pi

from station.hw.franka.arm.velocity_curves import velocity_towards_end


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Limits of one motion: translation [m], rotation [rad] or elbow [rad].

    Attributes:
        velocity: Largest speed [unit/s], > 0.
        acceleration: Largest acceleration [unit/s^2], > 0.
        jerk: Largest jerk [unit/s^3], > 0.
    """

    velocity: float
    acceleration: float
    jerk: float

    def bounds(self) -> tuple[float, float, float]:
        """Return velocity, acceleration and jerk."""
        return self.velocity, self.acceleration, self.jerk


@dataclass(frozen=True, slots=True)
class UrdfValues:
    """The values of a kind of arm that differ from those in a Panda's URDF.

    A URDF cannot state velocity limits that depend on the position. It states a range
    of positions in which a lower velocity is always allowed.

    Attributes:
        lower: Lowest positions of the joints [rad], shape (7,).
        upper: Highest positions [rad], shape (7,).
        velocity: Highest speeds of the joints [rad/s], shape (7,).
        inertials: For links 0 to 7, in their frames: mass [kg], centre of mass [m], and
            inertia about it, xx, yy, zz, xy, xz, yz [kg m^2]; shape (8, 10).
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    velocity: tuple[float, ...]
    inertials: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class ArmLimits:
    """Limits of one kind of arm; tuples have one number per joint, shape (7,).

    Attributes:
        lower: Lowest positions [rad].
        upper: Highest positions [rad].
        velocity: Highest speeds of the joints [rad/s].
        acceleration: Largest accelerations of the joints [rad/s^2].
        jerk: Largest jerks of the joints [rad/s^3].
        translation: Limits of the end effector's translation.
        rotation: Limits of the end effector's rotation.
        elbow: Limits of the elbow angle.
        limiter_elbow_velocity: Highest speed of the elbow that libfranka's limiter
            allows [rad/s].
        tolerated_losses: Number of lost packets for which the velocity limit leaves
            room.
        urdf: Values that differ from those in a Panda's URDF; None if none do.
        curves: (a, b, upper, lower) for each joint whose limits depend on the position,
            see `velocity_range`; empty if they do not. The limits are 0 at the ends of
            the range, so that commands need no position limits as well.
        filters_first_pose: Whether the low-pass acts on the first position or pose of a
            motion, too.
        torque: Largest torques of the joints [Nm].
        torque_rate: Largest rate of commanded torques [Nm/s].
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    velocity: tuple[float, ...]
    acceleration: tuple[float, ...]
    jerk: tuple[float, ...]
    translation: MotionLimits
    rotation: MotionLimits
    elbow: MotionLimits
    limiter_elbow_velocity: float
    tolerated_losses: int
    urdf: UrdfValues | None = None
    curves: tuple[tuple[float, float, float, float], ...] = ()
    filters_first_pose: bool = True
    torque: tuple[float, ...] = (87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0)
    torque_rate: float = 1000.0

    def velocity_range(self, joint: int, q: float) -> tuple[float, float]:
        """Return the lowest and the highest velocity of a joint [rad/s].

        Args:
            joint: Index of the joint, 0 to 6.
            q: Position of the joint [rad].
        """
        highest = self.velocity[joint]
        if not self.curves:
            return -highest, highest
        a, b, upper, lower = self.curves[joint]
        down = velocity_towards_end(highest, a, b, q - lower)
        return 0.0 - down, velocity_towards_end(highest, a, b, upper - q)


PANDA_LIMITS = ArmLimits(
    lower=(-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973),
    upper=(2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973),
    velocity=(2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61),
    acceleration=(15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0),
    jerk=(7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0),
    translation=MotionLimits(2.0, 13.0, 6500.0),
    rotation=MotionLimits(2.5, 25.0, 12500.0),
    elbow=MotionLimits(2.175, 10.0, 5000.0),
    limiter_elbow_velocity=2.175,
    tolerated_losses=3,
)
"""Limits of the Panda (FER)."""

_FR3_INERTIALS = (
    (2.3966, -0.0172, 0.0004, 0.0745,
     0.009, 0.0115, 0.0085,
     0.0, 0.002, 0.0),
    (2.9274653454, 4.128e-07, -0.0181251324, -0.038603597,
     0.023927316485107913, 0.0224821613275756, 0.006350098258530016,
     1.3317903455714081e-05, -0.00011404774918616684, -0.0019950320628240115),
    (2.9355370338, 0.0031828864, -0.0743221644, 0.0088146084,
     0.041938946257609425, 0.02514514885014724, 0.06170214472888839,
     0.00020257331521090626, 0.004077784227179924, -0.0042252158006570156),
    (2.2449013699, 0.0407015686, -0.0048200565, -0.0289730823,
     0.02410142547240885, 0.01974053266708178, 0.019044494482244823,
     0.002404694559042109, -0.002856269270114313, -0.002104212683891874),
    (2.6155955791, -0.0459100965, 0.063049296, -0.0085187868,
     0.03452998321913202, 0.028881621933049058, 0.04125471171146641,
     0.01322552265982813, 0.01015142998484113, -0.0009762833870704552),
    (2.3271207594, -0.0016039605, 0.0292536262, -0.097296599,
     0.051610278463662895, 0.04787729713371481, 0.016423625579357254,
     -0.005715173387783472, -0.0035673167625872135, 0.010673985108535986),
    (1.8170376524, 0.0597131221, -0.0410294666, -0.0101692726,
     0.005412333594383447, 0.014058329545509979, 0.016080817924212554,
     0.006193456360285834, 0.0014219289306117652, -0.0013140753741120031),
    (0.6271432862, 0.0045225817, 0.0086261921, -0.0161633251,
     0.00021092389150104718, 0.00017718568002411474, 5.993190599659971e-05,
     -2.433299114461931e-05, 4.564480393778983e-05, 8.744070223226438e-05),
)  # fmt: skip

FR3_LIMITS = ArmLimits(
    lower=(-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159),
    upper=(2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159),
    velocity=(2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26),
    acceleration=(10.0,) * 7,
    jerk=(5000.0,) * 7,
    translation=MotionLimits(3.0, 9.0, 4500.0),
    rotation=MotionLimits(2.5, 17.0, 8500.0),
    elbow=MotionLimits(2.62, 10.0, 5000.0),
    limiter_elbow_velocity=1.5,
    tolerated_losses=0,
    urdf=UrdfValues(
        lower=(-2.3093, -1.5133, -2.4937, -2.7478, -2.4800, 0.8521, -2.6895),
        upper=(2.3093, 1.5133, 2.4937, -0.4461, 2.4800, 4.2094, 2.6895),
        velocity=(2.0, 1.0, 1.5, 1.25, 3.0, 1.5, 3.0),
        inertials=_FR3_INERTIALS,
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
"""Limits of the Franka Research 3."""

LIMITS_OF_ARM = {"panda": PANDA_LIMITS, "fr3": FR3_LIMITS}
"""Limits by the kind of arm."""


@dataclass(frozen=True, slots=True)
class SupervisorLimits:
    """Thresholds of measured quantities that Franka does not publish.

    Attributes:
        position_tolerance: Distance beyond a position limit [rad]; negative before it.
        velocity_factor: Share of the velocity limits of joints and end effector. A
            joint of the simulation is never faster than `OVERSPEED` times its limit, so
            above that factor only the end effector can be too fast.
        torque_factor: Share of the torque limits: the range of the torque sensors.
        debounce: Cycles for which a measured value must be out of its range, >= 1.
        power: Largest sum over the joints of |tau_J dq| [W].
        self_collision_distance: Least distance between links that are not neighbours
            [m]; the links are capsules, and a negative distance lets them overlap.
        cartesian_lower: Lowest x, y, z of the end effector, axes of the base [m].
        cartesian_upper: Highest x, y, z [m]; both are the walls of a box.
        path_deviation: Largest distance of the end effector from the desired motion:
            translation [m], rotation [rad], elbow [rad]. Source: libfranka@0.9.2
            src/robot_impl.h, kDefaultDeviation: 10 m, 3.12 rad, 2 pi.
        singular_start: Least singular value of the Jacobian [m, rad] at which a
            Cartesian motion may start. Joint 3, whose position the elbow gives, is left
            out. 0 lets every motion start.
    """

    position_tolerance: float = 0.003
    velocity_factor: float = 1.01
    torque_factor: float = 1.0
    debounce: int = 3
    power: float = inf
    self_collision_distance: float = 0.03
    cartesian_lower: tuple[float, ...] = (-inf, -inf, -inf)
    cartesian_upper: tuple[float, ...] = (inf, inf, inf)
    path_deviation: tuple[float, ...] = (10.0, 3.12, 2.0 * pi)
    singular_start: float = 0.01
