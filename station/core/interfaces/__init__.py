"""What a controller can claim: handles and hardware interfaces, one family a file."""

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
from station.core.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
    ResourceManager,
)

__all__ = [
    "EffortJointInterface",
    "HardwareResourceManager",
    "InterfaceManager",
    "JointCommandInterface",
    "JointGroup",
    "JointHandle",
    "JointStateGroup",
    "JointStateHandle",
    "JointStateInterface",
    "PositionJointInterface",
    "ResourceHandle",
    "ResourceManager",
    "VelocityJointInterface",
    "interface_type_name",
]
