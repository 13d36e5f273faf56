"""Handles and hardware interfaces, one family in each file."""

from station.core.hardware.interfaces.interface_manager import (
    InterfaceManager,
    interface_type_name,
)
from station.core.hardware.interfaces.joint import (
    ActuatorCommandInterface,
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
    EffortActuatorInterface,
    EffortJointInterface,
    JointCommandInterface,
    JointCommandMode,
    JointHandle,
    JointModeHandle,
    JointModeInterface,
    JointStateHandle,
    JointStateInterface,
    PositionActuatorInterface,
    PositionJointInterface,
    VelocityActuatorInterface,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.joint_group import JointGroup, JointStateGroup
from station.core.hardware.interfaces.pos_vel import (
    PositionVelocityTorqueGainsJointHandle,
    PositionVelocityTorqueGainsJointInterface,
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
)
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    ResourceManager,
)
from station.core.hardware.interfaces.sensors import (
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
    ImuSensorHandle,
    ImuSensorInterface,
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
