"""The limits that a command or a reading of an arm violates, as codes and as errors.

A check compares numbers and stores codes. Only this module turns codes into `ArmError`.
"""

from station.core.franka.franka_errors import ArmError
from station.hw.franka.arm.self_collision import LINKS_OF_PAIR
from station.memory.doubles import zeros

CAPACITY = 32
"""Most violations of one check: four of each joint, and some of the whole arm."""
_COLUMNS = 4

(
    JOINT_START,
    JOINT_POSITION,
    JOINT_VELOCITY,
    JOINT_ACCELERATION,
    JOINT_JERK,
    SOLVED_POSITION,
    SOLVED_VELOCITY,
    SOLVED_ACCELERATION,
    SOLVED_JERK,
    TORQUE_RATE,
    LOST_COMMANDS,
    INVALID_FRAME,
    POSE_START,
    ELBOW_SIGN,
    ELBOW_START,
    TRANSLATION_VELOCITY,
    TRANSLATION_ACCELERATION,
    TRANSLATION_JERK,
    ROTATION_VELOCITY,
    ROTATION_ACCELERATION,
    ROTATION_JERK,
    ELBOW_VELOCITY,
    ELBOW_ACCELERATION,
    ELBOW_JERK,
    MEASURED_POSITION,
    MEASURED_VELOCITY,
    MEASURED_TORQUE,
    SELF_COLLISION,
    WALL,
    END_EFFECTOR_SPEED,
    POWER,
    DEVIATION,
) = range(32)
"""Codes. `SOLVED` are joint motions that the arm computes from a Cartesian command."""

_JOINTS = tuple(f"joint{number}" for number in range(1, 8))
_PATH = ("translation", "rotation", "elbow")
_JOINT_MOTION = "joint_motion_generator"
_CARTESIAN = "cartesian_motion_generator"
_ELBOW_LIMIT = f"{_CARTESIAN}_elbow_limit_violation"
# For each code: name of the error, its unit, and the names of its parts.
_WORDS: tuple[
    tuple[str, str | tuple[str, ...], tuple[str, ...] | dict[int, str]], ...
] = (
    ("joint_position_motion_generator_start_pose_invalid", "rad", _JOINTS),
    (f"{_JOINT_MOTION}_position_limits_violation", "rad", _JOINTS),
    (f"{_JOINT_MOTION}_velocity_limits_violation", "rad/s", _JOINTS),
    (f"{_JOINT_MOTION}_velocity_discontinuity", "rad/s^2", _JOINTS),
    (f"{_JOINT_MOTION}_acceleration_discontinuity", "rad/s^3", _JOINTS),
    (f"{_CARTESIAN}_joint_position_limits_violation", "rad", _JOINTS),
    (f"{_CARTESIAN}_joint_velocity_limits_violation", "rad/s", _JOINTS),
    (f"{_CARTESIAN}_joint_velocity_discontinuity", "rad/s^2", _JOINTS),
    (f"{_CARTESIAN}_joint_acceleration_discontinuity", "rad/s^3", _JOINTS),
    ("controller_torque_discontinuity", "Nm/s", _JOINTS),
    ("communication_constraints_violation", "commands lost in a row", ("",)),
    ("cartesian_position_motion_generator_invalid_frame", "", ("O_T_EE",)),
    ("cartesian_position_motion_generator_start_pose_invalid", ("m", "rad"), _PATH),
    (f"{_CARTESIAN}_elbow_sign_inconsistent", "", ("elbow",)),
    (f"{_CARTESIAN}_start_elbow_invalid", "rad", ("elbow",)),
    (f"{_CARTESIAN}_velocity_limits_violation", "m/s", ("translation",)),
    (f"{_CARTESIAN}_velocity_discontinuity", "m/s^2", ("translation",)),
    (f"{_CARTESIAN}_acceleration_discontinuity", "m/s^3", ("translation",)),
    (f"{_CARTESIAN}_velocity_limits_violation", "rad/s", ("rotation",)),
    (f"{_CARTESIAN}_velocity_discontinuity", "rad/s^2", ("rotation",)),
    (f"{_CARTESIAN}_acceleration_discontinuity", "rad/s^3", ("rotation",)),
    (_ELBOW_LIMIT, "rad/s", ("elbow",)),
    (_ELBOW_LIMIT, "rad/s^2", ("elbow",)),
    (_ELBOW_LIMIT, "rad/s^3", ("elbow",)),
    ("joint_position_limits_violation", "rad", _JOINTS),
    ("joint_velocity_violation", "rad/s", _JOINTS),
    ("tau_j_range_violation", "Nm", _JOINTS),
    ("self_collision_avoidance_violation", "m", LINKS_OF_PAIR),
    ("cartesian_position_limits_violation", "m", ("x", "y", "z")),
    ("cartesian_velocity_violation", "m/s", ("end effector",)),
    ("power_limit_violation", "W", ("",)),
    ("max_path_pose_deviation_violation", ("m", "rad", "rad"), _PATH),
)


class Violations:
    """The findings of a check, in memory that is made once.

    Attributes:
        count: Number of violations; setting it to 0 forgets them.
    """

    def __init__(self) -> None:
        self.count = 0
        self.rows = zeros(CAPACITY * _COLUMNS)

    def add(self, code: int, part: int, value: float, bound: float) -> None:
        """Add a violation.

        Args:
            code: The limit that is violated.
            part: Index of the joint, or of another part of the code.
            value: The value that violates the limit.
            bound: The limit.
        """
        # A full table ends the motion just as a longer one would.
        if self.count < CAPACITY:
            row = self.count * _COLUMNS
            self.rows[row], self.rows[row + 1] = code, part
            self.rows[row + 2], self.rows[row + 3] = value, bound
            self.count += 1

    def errors(self) -> list[ArmError]:
        """Return the violations as errors.

        Errors of a command are ordered by code, errors of the readings by joint.
        """
        rows = [
            tuple(self.rows[start : start + _COLUMNS])
            for start in range(0, self.count * _COLUMNS, _COLUMNS)
        ]
        rows.sort(key=lambda row: min(row[0], MEASURED_POSITION))
        return [_error(int(code), int(part), *rest) for code, part, *rest in rows]


def _error(code: int, part: int, value: float, bound: float) -> ArmError:
    name, unit, parts = _WORDS[code]
    return ArmError(
        name, parts[part], value, bound, unit if isinstance(unit, str) else unit[part]
    )
