"""Thresholds at which an arm stops by itself and that Franka does not publish."""

from dataclasses import dataclass
from math import inf, pi


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
