"""Transmissions: from actuators to joints and back."""

from station.core.hardware.transmissions.parser import (
    ActuatorInfo,
    JointInfo,
    TransmissionInfo,
    TransmissionParser,
)
from station.core.hardware.transmissions.raw_joint_data import RawJointData
from station.core.hardware.transmissions.transmission import (
    DifferentialTransmission,
    FourBarLinkageTransmission,
    SimpleTransmission,
    Transmission,
    TransmissionInterfaceError,
)
from station.core.hardware.transmissions.transmission_handle import (
    ActuatorData,
    Direction,
    JointData,
    TransmissionHandle,
)
from station.core.hardware.transmissions.transmission_interface import (
    ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface,
    ActuatorToJointStateInterface,
    ActuatorToJointVelocityInterface,
    JointToActuatorEffortInterface,
    JointToActuatorPositionInterface,
    JointToActuatorStateInterface,
    JointToActuatorVelocityInterface,
    Propagation,
    RobotTransmissions,
    TransmissionInterface,
)
from station.core.hardware.transmissions.transmission_interface_loader import (
    LoadedTransmission,
    TransmissionInterfaceLoader,
)
from station.core.hardware.transmissions.transmission_loader import (
    TransmissionFactory,
    load_transmission,
)

__all__ = [
    "ActuatorData",
    "ActuatorInfo",
    "ActuatorToJointEffortInterface",
    "ActuatorToJointPositionInterface",
    "ActuatorToJointStateInterface",
    "ActuatorToJointVelocityInterface",
    "DifferentialTransmission",
    "Direction",
    "FourBarLinkageTransmission",
    "JointData",
    "JointInfo",
    "JointToActuatorEffortInterface",
    "JointToActuatorPositionInterface",
    "JointToActuatorStateInterface",
    "JointToActuatorVelocityInterface",
    "LoadedTransmission",
    "Propagation",
    "RawJointData",
    "RobotTransmissions",
    "SimpleTransmission",
    "Transmission",
    "TransmissionFactory",
    "TransmissionHandle",
    "TransmissionInfo",
    "TransmissionInterface",
    "TransmissionInterfaceError",
    "TransmissionInterfaceLoader",
    "TransmissionParser",
    "load_transmission",
]
