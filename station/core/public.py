"""The names that people write robots, controllers and loops with.

`from station.core import …` finds them here; docs/python.md lists them by purpose.
"""

from station.core.clock import Clock, ManualClock, SystemClock
from station.core.control.controller import (
    Controller,
    ControllerBase,
    ControllerSample,
    ControllerState,
    MultiInterfaceController,
)
from station.core.control.controller_loader import (
    ControllerLoader,
    TableLoader,
    default_loaders,
)
from station.core.control.controller_manager import ControllerManager
from station.core.control.controller_status import (
    ControllerStatistics,
    ControllerStatus,
)
from station.core.control.switching import Strictness, SwitchRequest, SwitchResult
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import DeclaredParameter, NameKind, ParameterType
from station.core.errors import (
    ControllerLoadError,
    HardwareInterfaceError,
    ParameterError,
    StationError,
    SwitchRefusedError,
)
from station.core.facade.station import Station
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.hardware.interfaces import (
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
    EffortActuatorInterface,
    EffortJointInterface,
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
    HardwareResourceManager,
    ImuSensorHandle,
    ImuSensorInterface,
    JointCommandMode,
    JointGroup,
    JointHandle,
    JointModeHandle,
    JointModeInterface,
    JointStateGroup,
    JointStateHandle,
    JointStateInterface,
    PositionActuatorInterface,
    PositionJointInterface,
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
    ResourceHandle,
    ResourceManager,
    VelocityActuatorInterface,
    VelocityJointInterface,
)
from station.core.hardware.limits import (
    EffortJointSoftLimitsHandle,
    EffortJointSoftLimitsInterface,
    JointLimits,
    PositionJointSoftLimitsHandle,
    PositionJointSoftLimitsInterface,
    SoftJointLimits,
    VelocityJointSoftLimitsHandle,
    VelocityJointSoftLimitsInterface,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    ResourceConflict,
    RobotHW,
    SwitchState,
)
from station.core.hardware.services import (
    RobotServices,
    RobotServicesInterface,
    ServiceKind,
    service,
)
from station.core.hardware.transmissions import (
    DifferentialTransmission,
    FourBarLinkageTransmission,
    SimpleTransmission,
    Transmission,
    TransmissionInterfaceLoader,
)
from station.core.loop.control_loop import ControlLoop
from station.core.loop.snapshot import Snapshot, SnapshotRing
from station.core.numerics.pid import Pid, PidGains
from station.core.parameters import Parameters, ParameterTree
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.core.toolbox.realtime import (
    RealtimeBox,
    RealtimeBuffer,
    RealtimeClock,
    RealtimePublisher,
    RealtimeServerGoalHandle,
)

__all__: list[str] = [
    "ActuatorHandle",
    "ActuatorStateHandle",
    "ActuatorStateInterface",
    "Clock",
    "CombinedRobotHW",
    "ControlLoop",
    "Controller",
    "ControllerBase",
    "ControllerInfo",
    "ControllerLoadError",
    "ControllerLoader",
    "ControllerManager",
    "ControllerSample",
    "ControllerState",
    "ControllerStatistics",
    "ControllerStatus",
    "DeclaredParameter",
    "DifferentialTransmission",
    "EffortActuatorInterface",
    "EffortJointInterface",
    "EffortJointSoftLimitsHandle",
    "EffortJointSoftLimitsInterface",
    "ForceTorqueSensorHandle",
    "ForceTorqueSensorInterface",
    "FourBarLinkageTransmission",
    "HardwareInterfaceError",
    "HardwareResourceManager",
    "ImuSensorHandle",
    "ImuSensorInterface",
    "InterfaceResources",
    "JointCommandMode",
    "JointGroup",
    "JointHandle",
    "JointLimits",
    "JointModeHandle",
    "JointModeInterface",
    "JointStateGroup",
    "JointStateHandle",
    "JointStateInterface",
    "ManualClock",
    "MultiInterfaceController",
    "NameKind",
    "ParameterError",
    "ParameterTree",
    "ParameterType",
    "Parameters",
    "Pid",
    "PidGains",
    "PosVelAccJointHandle",
    "PosVelAccJointInterface",
    "PosVelJointHandle",
    "PosVelJointInterface",
    "PositionActuatorInterface",
    "PositionJointInterface",
    "PositionJointSoftLimitsHandle",
    "PositionJointSoftLimitsInterface",
    "RealtimeBox",
    "RealtimeBuffer",
    "RealtimeClock",
    "RealtimePublisher",
    "RealtimeServerGoalHandle",
    "ResourceConflict",
    "ResourceHandle",
    "ResourceManager",
    "RobotHW",
    "RobotServices",
    "RobotServicesInterface",
    "ServiceKind",
    "SetPointElement",
    "SetPointPort",
    "SimpleTransmission",
    "Snapshot",
    "SnapshotRing",
    "SoftJointLimits",
    "Station",
    "StationError",
    "Strictness",
    "SwitchRefusedError",
    "SwitchRequest",
    "SwitchResult",
    "SwitchState",
    "SystemClock",
    "TableLoader",
    "Transmission",
    "TransmissionInterfaceLoader",
    "Tunable",
    "Tunables",
    "VelocityActuatorInterface",
    "VelocityJointInterface",
    "VelocityJointSoftLimitsHandle",
    "VelocityJointSoftLimitsInterface",
    "default_loaders",
    "service",
]
