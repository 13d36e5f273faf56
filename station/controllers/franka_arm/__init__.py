"""The parameters, handles and poses shared by all controllers of a Franka arm."""

from station.controllers.franka_arm.arm_handles import (
    ARM_ID,
    JOINT_NAMES,
    LARGEST_STEP,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
    require,
    saturate_torque_rate,
)
from station.controllers.franka_arm.pose_port import PosePort

__all__ = [
    "ARM_ID",
    "JOINT_NAMES",
    "LARGEST_STEP",
    "PosePort",
    "claim_torques",
    "find_model",
    "find_state",
    "read_arm_id",
    "read_arm_joints",
    "require",
    "saturate_torque_rate",
]
