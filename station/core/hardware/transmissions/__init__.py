"""Transmissions: from actuators to joints and back.

Formulas and sources stand in `simple_transmission`, `differential_transmission` and
`four_bar_linkage_transmission`.
"""

from station.core.hardware.transmissions.differential_transmission import (
    DifferentialTransmission,
)
from station.core.hardware.transmissions.four_bar_linkage_transmission import (
    FourBarLinkageTransmission,
)
from station.core.hardware.transmissions.parser import (
    ActuatorInfo,
    JointInfo,
    TransmissionInfo,
    TransmissionParser,
)
from station.core.hardware.transmissions.propagation import Propagation
from station.core.hardware.transmissions.raw_joint_data import RawJointData
from station.core.hardware.transmissions.simple_transmission import SimpleTransmission
from station.core.hardware.transmissions.transmission import (
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
