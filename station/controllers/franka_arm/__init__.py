"""The parameters, handles and poses shared by all controllers of a Franka arm."""

from station.controllers.franka_arm.arm_handles import (
    ARM_ID as ARM_ID,
    JOINT_NAMES as JOINT_NAMES,
    LARGEST_STEP as LARGEST_STEP,
    ArmTorqueController as ArmTorqueController,
    claim_torques as claim_torques,
    find_model as find_model,
    find_state as find_state,
    read_arm_id as read_arm_id,
    read_arm_joints as read_arm_joints,
    saturate_torque_rate as saturate_torque_rate,
)
from station.controllers.franka_arm.pose_target import PosePort as PosePort
