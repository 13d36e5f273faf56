"""What a controller can claim: handles and hardware interfaces, one family a file."""

from station.core.interfaces.actuator import (
    ActuatorCommandInterface,
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
    EffortActuatorInterface,
    PositionActuatorInterface,
    VelocityActuatorInterface,
)
from station.core.interfaces.force_torque_sensor import (
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
)
from station.core.interfaces.franka_cartesian import (
    FrankaCartesianPoseHandle,
    FrankaCartesianVelocityHandle,
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.interfaces.franka_errors import ArmError
from station.core.interfaces.franka_model import (
    Frame,
    FrankaModel,
    FrankaModelHandle,
    FrankaModelInterface,
)
from station.core.interfaces.franka_robot_state import RobotMode, RobotState
from station.core.interfaces.franka_services import (
    ArmRecord,
    CollisionBehavior,
    FaultKind,
    FrankaServices,
    FrankaServicesInterface,
    SimulatedFault,
)
from station.core.interfaces.franka_state import (
    FrankaStateHandle,
    FrankaStateInterface,
)
from station.core.interfaces.gripper_services import (
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
from station.core.interfaces.imu_sensor import ImuSensorHandle, ImuSensorInterface
from station.core.interfaces.interface_manager import (
    InterfaceManager,
    interface_type_name,
)
from station.core.interfaces.joint import (
    EffortJointInterface,
    JointCommandInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.interfaces.joint_group import JointGroup, JointStateGroup
from station.core.interfaces.joint_mode import (
    JointCommandMode,
    JointModeHandle,
    JointModeInterface,
)
from station.core.interfaces.pos_vel import (
    PositionVelocityTorqueGainsJointHandle,
    PositionVelocityTorqueGainsJointInterface,
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
)
from station.core.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    ResourceManager,
)

__all__ = [
    "DEFAULT_EPSILON",
    "DEFAULT_SPEED",
    "ActuatorCommandInterface",
    "ActuatorHandle",
    "ActuatorStateHandle",
    "ActuatorStateInterface",
    "ArmError",
    "ArmRecord",
    "CollisionBehavior",
    "EffortActuatorInterface",
    "EffortJointInterface",
    "FaultKind",
    "ForceTorqueSensorHandle",
    "ForceTorqueSensorInterface",
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
    "HardwareResourceManager",
    "ImuSensorHandle",
    "ImuSensorInterface",
    "InterfaceManager",
    "JointCommandInterface",
    "JointCommandMode",
    "JointGroup",
    "JointHandle",
    "JointModeHandle",
    "JointModeInterface",
    "JointStateGroup",
    "JointStateHandle",
    "JointStateInterface",
    "PosVelAccJointHandle",
    "PosVelAccJointInterface",
    "PosVelJointHandle",
    "PosVelJointInterface",
    "PositionActuatorInterface",
    "PositionJointInterface",
    "PositionVelocityTorqueGainsJointHandle",
    "PositionVelocityTorqueGainsJointInterface",
    "ResourceHandle",
    "ResourceManager",
    "RobotMode",
    "RobotState",
    "SimulatedFault",
    "VelocityActuatorInterface",
    "VelocityJointInterface",
    "interface_type_name",
]
