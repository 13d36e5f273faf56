"""Where the examples start, and how they find their arm."""

from collections.abc import Sequence
from math import pi

from station.core.errors import ControllerStateError, ParameterError
from station.core.parameters import Parameters

START_POSE = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""Joint positions from which the motion examples start [rad], shape (7,)."""
TOLERANCE = 0.1
"""How far a joint may be from it [rad]."""

_REMEDY = (
    "Bring the arm to its start pose first: station goto TRAJECTORY_CONTROLLER "
    + " ".join(f"{q:.6g}" for q in START_POSE)
)


def check_start_pose(q_d: Sequence[float]) -> None:
    """Refuse to move from anywhere else.

    Args:
        q_d: Desired joint positions [rad], shape (7,).

    Raises:
        ControllerStateError: A joint is too far from the start pose.
    """
    for number, (q, start) in enumerate(zip(q_d, START_POSE, strict=True), 1):
        if not abs(q - start) <= TOLERANCE:
            raise ControllerStateError(
                f"joint {number} is at {q:.4f} rad; this example starts at "
                f"{start:.4f} rad, at most {TOLERANCE} rad away. {_REMEDY}.",
                remedy=_REMEDY,
                details={"joint": number, "position": q},
            )


def read_arm_id(params: Parameters) -> str:
    """Return the parameter `arm_id`.

    Raises:
        ParameterError: It is missing or no text.
    """
    return params.get_str("arm_id")


def read_joint_names(params: Parameters) -> list[str]:
    """Return the parameter `joint_names`.

    Raises:
        ParameterError: It is missing, or does not name 7 joints.
    """
    names = params.get_str_list("joint_names")
    if len(set(names)) != len(START_POSE):
        raise ParameterError(
            f"Parameter '{params.resolve('joint_names')}' is {names}; it must name 7 "
            "joints.",
            remedy="Name the joints from base to flange.",
        )
    return names
