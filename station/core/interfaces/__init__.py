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
    "ActuatorCommandInterface",
    "ActuatorHandle",
    "ActuatorStateHandle",
    "ActuatorStateInterface",
    "EffortActuatorInterface",
    "EffortJointInterface",
    "ForceTorqueSensorHandle",
    "ForceTorqueSensorInterface",
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
    "VelocityActuatorInterface",
    "VelocityJointInterface",
    "interface_type_name",
]
