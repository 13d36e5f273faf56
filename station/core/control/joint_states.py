"""Joint states as clients see them, the shape of `sensor_msgs/JointState`."""

from typing import NamedTuple


class JointStates(NamedTuple):
    """State of several joints in one cycle; all lists have the shape (n,).

    Attributes:
        stamp: Station time of the cycle [s].
        name: Names of the joints.
        position: Positions [rad or m].
        velocity: Velocities [rad/s or m/s].
        effort: Efforts [Nm or N].
    """

    stamp: float
    name: list[str]
    position: list[float]
    velocity: list[float]
    effort: list[float]
