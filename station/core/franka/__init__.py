"""The interfaces of an arm and its hand, which franka_hw adds to ros_control."""

from station.core.franka.arm_simulation import (
    ArmSimulation,
    FaultKind,
    SimulatedFault,
)
from station.core.franka.franka_cartesian import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_model import (
    Frame,
    FrankaModel,
    FrankaModelHandle,
    FrankaModelInterface,
)
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import (
    CollisionBehavior,
    FrankaServices,
    FrankaServicesInterface,
)
from station.core.franka.franka_state import FrankaStateHandle, FrankaStateInterface
from station.core.franka.gripper_services import (
    DEFAULT_EPSILON,
    DEFAULT_SPEED,
    GraspRequest,
    GripperAction,
    GripperActivity,
    GripperCommand,
    GripperServices,
    GripperServicesInterface,
    GripperState,
)
from station.reports import ArmRecord

__all__ = [
    "DEFAULT_EPSILON",
    "DEFAULT_SPEED",
    "ArmError",
    "ArmRecord",
    "ArmSimulation",
    "CollisionBehavior",
    "FaultKind",
    "Frame",
    "FrankaCartesianPoseHandle",
    "FrankaCartesianVelocityHandle",
    "FrankaModel",
    "FrankaModelHandle",
    "FrankaModelInterface",
    "FrankaPoseCartesianInterface",
    "FrankaServices",
    "FrankaServicesInterface",
    "FrankaStateHandle",
    "FrankaStateInterface",
    "FrankaVelocityCartesianInterface",
    "GraspRequest",
    "GripperAction",
    "GripperActivity",
    "GripperCommand",
    "GripperServices",
    "GripperServicesInterface",
    "GripperState",
    "RobotMode",
    "RobotState",
    "SimulatedFault",
]
