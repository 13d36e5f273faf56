"""The interfaces of an arm and its hand, as franka_hw adds them to ros_control."""

from station.core.franka.franka_errors import ArmError as ArmError
from station.core.franka.franka_interfaces import (
    FrankaCartesianPoseHandle as FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle as FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface as FrankaPoseCartesianInterface,
    FrankaStateHandle as FrankaStateHandle,
    FrankaStateInterface as FrankaStateInterface,
    FrankaVelocityCartesianInterface as FrankaVelocityCartesianInterface,
)
from station.core.franka.franka_model import (
    Frame as Frame,
    FrankaModel as FrankaModel,
    FrankaModelHandle as FrankaModelHandle,
    FrankaModelInterface as FrankaModelInterface,
)
from station.core.franka.franka_robot_state import (
    RobotMode as RobotMode,
    RobotState as RobotState,
)
from station.core.franka.franka_services import (
    ArmSimulation as ArmSimulation,
    CollisionBehavior as CollisionBehavior,
    FaultKind as FaultKind,
    FrankaServices as FrankaServices,
    FrankaServicesInterface as FrankaServicesInterface,
    SimulatedFault as SimulatedFault,
)
from station.core.franka.gripper_services import (
    DEFAULT_EPSILON as DEFAULT_EPSILON,
    DEFAULT_SPEED as DEFAULT_SPEED,
    GraspRequest as GraspRequest,
    GripperAction as GripperAction,
    GripperActivity as GripperActivity,
    GripperCommand as GripperCommand,
    GripperServices as GripperServices,
    GripperServicesInterface as GripperServicesInterface,
    GripperState as GripperState,
)
from station.reports import ArmRecord as ArmRecord
