"""What franka_hw adds to ros_control: the interfaces of an arm and of its hand."""

from station.core.franka.franka_errors import ArmError
from station.core.franka.franka_interfaces import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaStateHandle,
    FrankaStateInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.franka.franka_model import (
    Frame,
    FrankaModel,
    FrankaModelHandle,
    FrankaModelInterface,
)
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.franka.franka_services import (
    ArmSimulation,
    CollisionBehavior,
    FaultKind,
    FrankaServices,
    FrankaServicesInterface,
    SimulatedFault,
)
from station.core.franka.grippers import (
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
