"""The pose from which the motion examples start."""

from collections.abc import Sequence
from math import pi

from station.core.errors import ControllerStateError

START_POSE = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""Joint positions from which the motion examples start [rad], shape (7,)."""
TOLERANCE = 0.1
"""Largest distance of a joint from the start pose [rad]."""

_REMEDY = (
    "Bring the arm to its start pose first: station goto TRAJECTORY_CONTROLLER "
    + " ".join(f"{q:.6g}" for q in START_POSE)
)


def check_start_pose(q_d: Sequence[float]) -> None:
    """Refuse an arm that is not near the start pose.

    Args:
        q_d: Desired joint positions [rad], shape (7,).

    Raises:
        ControllerStateError: A joint is too far from the start pose.
    """
    for number, (q, start) in enumerate(zip(q_d, START_POSE, strict=True), 1):
        if not abs(q - start) <= TOLERANCE:
            raise ControllerStateError(
                f"Joint {number} is at {q:.4f} rad; this example starts at "
                f"{start:.4f} rad, at most {TOLERANCE} rad away. {_REMEDY}.",
                remedy=_REMEDY,
                details={"joint": number, "position": q},
            )
