"""Transmissions: from actuators to joints and back.

Formulas and sources stand in `simple_transmission`, `differential_transmission` and
`four_bar_linkage_transmission`.
"""

from station.core.transmissions.differential_transmission import (
    DifferentialTransmission,
)
from station.core.transmissions.four_bar_linkage_transmission import (
    FourBarLinkageTransmission,
)
from station.core.transmissions.parser import (
    ActuatorInfo,
    JointInfo,
    TransmissionInfo,
    TransmissionParser,
)
from station.core.transmissions.raw_joint_data import RawJointData
from station.core.transmissions.simple_transmission import SimpleTransmission
from station.core.transmissions.transmission import (
    Transmission,
    TransmissionInterfaceError,
)
from station.core.transmissions.transmission_handle import (
    ActuatorData,
    ActuatorToJointEffortHandle,
    ActuatorToJointPositionHandle,
    ActuatorToJointStateHandle,
    ActuatorToJointVelocityHandle,
    JointData,
    JointToActuatorEffortHandle,
    JointToActuatorPositionHandle,
    JointToActuatorStateHandle,
    JointToActuatorVelocityHandle,
    TransmissionHandle,
)
from station.core.transmissions.transmission_interface import (
    ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface,
    ActuatorToJointStateInterface,
    ActuatorToJointVelocityInterface,
    JointToActuatorEffortInterface,
    JointToActuatorPositionInterface,
    JointToActuatorStateInterface,
    JointToActuatorVelocityInterface,
    RobotTransmissions,
    TransmissionInterface,
)
from station.core.transmissions.transmission_interface_loader import (
    LoadedTransmission,
    TransmissionInterfaceLoader,
)
from station.core.transmissions.transmission_loader import (
    TransmissionFactory,
    load_transmission,
)

__all__ = [
    "ActuatorData",
    "ActuatorInfo",
    "ActuatorToJointEffortHandle",
    "ActuatorToJointEffortInterface",
    "ActuatorToJointPositionHandle",
    "ActuatorToJointPositionInterface",
    "ActuatorToJointStateHandle",
    "ActuatorToJointStateInterface",
    "ActuatorToJointVelocityHandle",
    "ActuatorToJointVelocityInterface",
    "DifferentialTransmission",
    "FourBarLinkageTransmission",
    "JointData",
    "JointInfo",
    "JointToActuatorEffortHandle",
    "JointToActuatorEffortInterface",
    "JointToActuatorPositionHandle",
    "JointToActuatorPositionInterface",
    "JointToActuatorStateHandle",
    "JointToActuatorStateInterface",
    "JointToActuatorVelocityHandle",
    "JointToActuatorVelocityInterface",
    "LoadedTransmission",
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
