"""Distances between angles, with and without joint limits.

Source: angles@1.9.13 include/angles/angles.h.
"""

from station.core.numerics.joint_errors import (
    shortest_angular_distance,
    shortest_angular_distance_with_limits,
)

__all__ = ["shortest_angular_distance", "shortest_angular_distance_with_limits"]
