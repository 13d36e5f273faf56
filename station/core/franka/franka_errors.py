"""The errors that an arm reports, each with the measured value and its limit.

Source: libfranka-common@e6aa0fc, the order of the error flags; franka/errors.h, Errors.
"""

from collections.abc import Sequence
from dataclasses import dataclass

ERROR_NAMES = (
    "joint_position_limits_violation",
    "cartesian_position_limits_violation",
    "self_collision_avoidance_violation",
    "joint_velocity_violation",
    "cartesian_velocity_violation",
    "force_control_safety_violation",
    "joint_reflex",
    "cartesian_reflex",
    "max_goal_pose_deviation_violation",
    "max_path_pose_deviation_violation",
    "cartesian_velocity_profile_safety_violation",
    "joint_position_motion_generator_start_pose_invalid",
    "joint_motion_generator_position_limits_violation",
    "joint_motion_generator_velocity_limits_violation",
    "joint_motion_generator_velocity_discontinuity",
    "joint_motion_generator_acceleration_discontinuity",
    "cartesian_position_motion_generator_start_pose_invalid",
    "cartesian_motion_generator_elbow_limit_violation",
    "cartesian_motion_generator_velocity_limits_violation",
    "cartesian_motion_generator_velocity_discontinuity",
    "cartesian_motion_generator_acceleration_discontinuity",
    "cartesian_motion_generator_elbow_sign_inconsistent",
    "cartesian_motion_generator_start_elbow_invalid",
    "force_controller_desired_force_tolerance_violation",
    "start_elbow_sign_inconsistent",
    "communication_constraints_violation",
    "power_limit_violation",
    "cartesian_motion_generator_joint_position_limits_violation",
    "cartesian_motion_generator_joint_velocity_limits_violation",
    "cartesian_motion_generator_joint_velocity_discontinuity",
    "cartesian_motion_generator_joint_acceleration_discontinuity",
    "cartesian_position_motion_generator_invalid_frame",
    "controller_torque_discontinuity",
    "joint_p2p_insufficient_torque_for_planning",
    "tau_j_range_violation",
    "instability_detected",
    "joint_move_in_wrong_direction",
    "cartesian_spline_motion_generator_violation",
    "joint_via_motion_generator_planning_joint_limit_violation",
    "base_acceleration_initialization_timeout",
    "base_acceleration_invalid_reading",
)
"""Names of the 41 flags, in the order of `RobotState.current_errors`."""
ERROR_INDEX = {name: index for index, name in enumerate(ERROR_NAMES)}
"""Index of each name in the flags."""


@dataclass(frozen=True, slots=True)
class ArmError:
    """One error, with the measured value that raised it.

    Attributes:
        name: One of `ERROR_NAMES`.
        where: Joint, axis or quantity concerned, e.g. `joint4`; empty if there is none.
        value: Measured value, in `unit`.
        limit: Allowed value, in `unit`.
        unit: Unit of both; empty if the arm reports no values.
        cycle: Number of the arm's cycle in which the error was raised.
    """

    name: str
    where: str
    value: float
    limit: float
    unit: str
    cycle: int = 0

    @property
    def description(self) -> str:
        """The error as one sentence; without numbers for a real arm."""
        if not self.unit:
            return f"{self.name} (cycle {self.cycle})"
        place = f" at {self.where}" if self.where else ""
        return (
            f"{self.name}{place}: {self.value:.6g} {self.unit}, allowed is "
            f"{self.limit:.6g} {self.unit} (cycle {self.cycle})"
        )


def error_names(flags: Sequence[bool]) -> list[str]:
    """Return the names of the flags that are set.

    Args:
        flags: As in `RobotState.current_errors`, shape (41,).
    """
    return [name for name, flag in zip(ERROR_NAMES, flags, strict=True) if flag]
