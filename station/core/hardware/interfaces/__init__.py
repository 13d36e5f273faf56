"""Handles and hardware interfaces, one family in each file."""

from station.core.hardware.interfaces.joint import (
    ActuatorCommandInterface as ActuatorCommandInterface,
    ActuatorHandle as ActuatorHandle,
    ActuatorStateHandle as ActuatorStateHandle,
    ActuatorStateInterface as ActuatorStateInterface,
    EffortActuatorInterface as EffortActuatorInterface,
    EffortJointInterface as EffortJointInterface,
    JointCommandInterface as JointCommandInterface,
    JointCommandMode as JointCommandMode,
    JointHandle as JointHandle,
    JointModeHandle as JointModeHandle,
    JointModeInterface as JointModeInterface,
    JointStateHandle as JointStateHandle,
    JointStateInterface as JointStateInterface,
    PositionActuatorInterface as PositionActuatorInterface,
    PositionJointInterface as PositionJointInterface,
    VelocityActuatorInterface as VelocityActuatorInterface,
    VelocityJointInterface as VelocityJointInterface,
)
from station.core.hardware.interfaces.joint_group import (
    JointGroup as JointGroup,
    JointStateGroup as JointStateGroup,
)
from station.core.hardware.interfaces.pos_vel import (
    PositionVelocityTorqueGainsJointHandle as PositionVelocityTorqueGainsJointHandle,
    PositionVelocityTorqueGainsJointInterface as PositionVelocityTorqueGainsJointInterface,  # noqa: E501
    PosVelAccJointHandle as PosVelAccJointHandle,
    PosVelAccJointInterface as PosVelAccJointInterface,
    PosVelJointHandle as PosVelJointHandle,
    PosVelJointInterface as PosVelJointInterface,
)
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager as HardwareResourceManager,
    InterfaceManager as InterfaceManager,
    ResourceHandle as ResourceHandle,
    ResourceManager as ResourceManager,
    interface_type_name as interface_type_name,
)
from station.core.hardware.interfaces.sensors import (
    BatterySensorInterface as BatterySensorInterface,
    ForceTorqueSensorHandle as ForceTorqueSensorHandle,
    ForceTorqueSensorInterface as ForceTorqueSensorInterface,
    GpioCommandHandle as GpioCommandHandle,
    GpioCommandInterface as GpioCommandInterface,
    GpioStateHandle as GpioStateHandle,
    GpioStateInterface as GpioStateInterface,
    GpsSensorInterface as GpsSensorInterface,
    ImuSensorHandle as ImuSensorHandle,
    ImuSensorInterface as ImuSensorInterface,
    MagneticFieldSensorInterface as MagneticFieldSensorInterface,
    RangeSensorInterface as RangeSensorInterface,
    ValuesSensorHandle as ValuesSensorHandle,
)
