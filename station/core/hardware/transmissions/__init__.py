"""Transmissions: from actuators to joints and back."""

from station.core.hardware.transmissions.parser import (
    ActuatorInfo as ActuatorInfo,
    JointInfo as JointInfo,
    TransmissionInfo as TransmissionInfo,
    TransmissionParser as TransmissionParser,
)
from station.core.hardware.transmissions.transmission import (
    DifferentialTransmission as DifferentialTransmission,
    FourBarLinkageTransmission as FourBarLinkageTransmission,
    SimpleTransmission as SimpleTransmission,
    Transmission as Transmission,
    TransmissionInterfaceError as TransmissionInterfaceError,
)
from station.core.hardware.transmissions.transmission_handle import (
    ActuatorData as ActuatorData,
    Direction as Direction,
    JointData as JointData,
    TransmissionHandle as TransmissionHandle,
)
from station.core.hardware.transmissions.transmission_interface import (
    ActuatorToJointEffortInterface as ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface as ActuatorToJointPositionInterface,
    ActuatorToJointStateInterface as ActuatorToJointStateInterface,
    ActuatorToJointVelocityInterface as ActuatorToJointVelocityInterface,
    JointToActuatorEffortInterface as JointToActuatorEffortInterface,
    JointToActuatorPositionInterface as JointToActuatorPositionInterface,
    JointToActuatorStateInterface as JointToActuatorStateInterface,
    JointToActuatorVelocityInterface as JointToActuatorVelocityInterface,
    Propagation as Propagation,
    RobotTransmissions as RobotTransmissions,
    TransmissionInterface as TransmissionInterface,
)
from station.core.hardware.transmissions.transmission_interface_loader import (
    LoadedTransmission as LoadedTransmission,
    RawJointData as RawJointData,
    TransmissionInterfaceLoader as TransmissionInterfaceLoader,
)
from station.core.hardware.transmissions.transmission_loader import (
    TransmissionFactory as TransmissionFactory,
    load_transmission as load_transmission,
)
