"""The tool of a Franka arm and the force on it, read from the arm's state."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from station.core.description.urdf import Pose, Vector3

_IDENTITY = (*(1.0, 0.0, 0.0, 0.0, 0.0) * 3, 1.0)

ARM_FIELDS = ("F_T_EE", "EE_T_K", "O_F_ext_hat_K")
"""Fields of an arm's state that `arm_facts` reads."""


@dataclass(frozen=True, slots=True)
class ArmFacts:
    """The tool of a Franka arm.

    Attributes:
        flange_to_tool: Pose of EE in the flange frame.
        tool_to_stiffness: Pose of K in EE.
        force: Force on the robot at K, in the axes of its base [N]; None where the
            arm cannot tell.
    """

    flange_to_tool: Pose
    tool_to_stiffness: Pose
    force: Vector3 | None


def arm_facts(state: Mapping[str, object]) -> ArmFacts:
    """Return the tool of an arm and the force on it.

    Args:
        state: The fields of `FrankaState` that `ARM_FIELDS` names.
    """
    wrench = _numbers(state, "O_F_ext_hat_K", 6)
    # The arm reports the wrench that it exerts; the opposite acts on it.
    force = None if wrench is None else (-wrench[0], -wrench[1], -wrench[2])
    return ArmFacts(
        pose_of(_numbers(state, "F_T_EE", 16) or _IDENTITY),
        pose_of(_numbers(state, "EE_T_K", 16) or _IDENTITY),
        force,
    )


def _numbers(
    state: Mapping[str, object], name: str, count: int
) -> tuple[float, ...] | None:
    """Return an array of a state; None where it is missing or not finite."""
    values = state.get(name)
    if not isinstance(values, Sequence) or len(values) != count:
        return None
    numbers = tuple(value for value in values if isinstance(value, (int, float)))
    return numbers if len(numbers) == count else None


def pose_of(matrix: Sequence[float]) -> Pose:
    """Return the pose of a homogeneous matrix in column-major order, shape (16,).

    The quaternion comes from the trace or, where that is small, from the largest
    element of the diagonal (Shepperd's method), so that no division loses digits.
    """
    m = matrix
    xx, yx, zx, xy, yy, zy, xz, yz, zz = (*m[0:3], *m[4:7], *m[8:11])
    squares = (1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz)
    largest = max(range(4), key=squares.__getitem__)
    four = 2.0 * math.sqrt(max(squares[largest], 1e-12))
    rows = (
        (four * four / 4, zy - yz, xz - zx, yx - xy),
        (zy - yz, four * four / 4, xy + yx, xz + zx),
        (xz - zx, xy + yx, four * four / 4, yz + zy),
        (yx - xy, xz + zx, yz + zy, four * four / 4),
    )
    w, x, y, z = (part / four for part in rows[largest])
    return Pose((m[12], m[13], m[14]), (w, x, y, z))
