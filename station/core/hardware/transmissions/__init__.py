"""Transmissions: from actuators to joints and back."""

from station.core.hardware.transmissions.transmission import (
    DifferentialTransmission as DifferentialTransmission,
    FourBarLinkageTransmission as FourBarLinkageTransmission,
    SimpleTransmission as SimpleTransmission,
    Transmission as Transmission,
    TransmissionInterfaceError as TransmissionInterfaceError,
)
from station.core.hardware.transmissions.transmission_interface import (
    ActuatorData as ActuatorData,
    ActuatorToJointEffortInterface as ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface as ActuatorToJointPositionInterface,
    ActuatorToJointStateInterface as ActuatorToJointStateInterface,
    ActuatorToJointVelocityInterface as ActuatorToJointVelocityInterface,
    Direction as Direction,
    JointData as JointData,
    JointToActuatorEffortInterface as JointToActuatorEffortInterface,
    JointToActuatorPositionInterface as JointToActuatorPositionInterface,
    JointToActuatorStateInterface as JointToActuatorStateInterface,
    JointToActuatorVelocityInterface as JointToActuatorVelocityInterface,
    Propagation as Propagation,
    RobotTransmissions as RobotTransmissions,
    TransmissionHandle as TransmissionHandle,
    TransmissionInterface as TransmissionInterface,
)
from station.core.hardware.transmissions.transmission_interface_loader import (
    LoadedTransmission as LoadedTransmission,
    RawJointData as RawJointData,
    TransmissionInterfaceLoader as TransmissionInterfaceLoader,
)
from station.core.hardware.transmissions.transmission_loader import (
    ActuatorInfo as ActuatorInfo,
    JointInfo as JointInfo,
    TransmissionFactory as TransmissionFactory,
    TransmissionInfo as TransmissionInfo,
    TransmissionParser as TransmissionParser,
    load_transmission as load_transmission,
)
