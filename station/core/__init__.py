"""ros_control itself: the standard library and NumPy, nothing else.

What is needed to write a robot or a controller can be imported from here; a module is
read when one of its names is asked for, so that this costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.core.clock import Clock, ManualClock, SystemClock
    from station.core.combined_robot_hw import CombinedRobotHW
    from station.core.control_loop import ControlLoop
    from station.core.controller import (
        Controller,
        ControllerBase,
        ControllerSample,
        ControllerState,
        MultiInterfaceController,
    )
    from station.core.controller_loader import (
        ControllerLoader,
        TableLoader,
        default_loaders,
    )
    from station.core.controller_manager import ControllerManager
    from station.core.controller_status import ControllerStatistics, ControllerStatus
    from station.core.errors import StationError, SwitchRefusedError
    from station.core.interfaces import (
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
        PositionJointInterface,
        PosVelAccJointHandle,
        PosVelAccJointInterface,
        PosVelJointHandle,
        PosVelJointInterface,
        ResourceHandle,
        ResourceManager,
        VelocityJointInterface,
    )
    from station.core.limits import JointLimits, SoftJointLimits
    from station.core.parameters import Parameters, ParameterTree
    from station.core.pid import Pid, PidGains
    from station.core.realtime import (
        RealtimeBox,
        RealtimeBuffer,
        RealtimeClock,
        RealtimePublisher,
        RealtimeServerGoalHandle,
    )
    from station.core.robot_hw import (
        ControllerInfo,
        InterfaceResources,
        ResourceConflict,
        RobotHW,
        SwitchState,
    )
    from station.core.set_point import SetPointElement, SetPointPort
    from station.core.station import Station
    from station.core.switching import Strictness, SwitchRequest, SwitchResult
    from station.core.tunables import Tunable

_MODULES = {
    "clock": ("Clock", "ManualClock", "SystemClock"),
    "combined_robot_hw": ("CombinedRobotHW",),
    "control_loop": ("ControlLoop",),
    "controller": (
        "Controller",
        "ControllerBase",
        "ControllerSample",
        "ControllerState",
        "MultiInterfaceController",
    ),
    "controller_loader": ("ControllerLoader", "TableLoader", "default_loaders"),
    "controller_manager": ("ControllerManager",),
    "controller_status": ("ControllerStatistics", "ControllerStatus"),
    "errors": ("StationError", "SwitchRefusedError"),
    "interfaces": (
        "EffortJointInterface",
        "ForceTorqueSensorHandle",
        "ForceTorqueSensorInterface",
        "HardwareResourceManager",
        "ImuSensorHandle",
        "ImuSensorInterface",
        "JointCommandMode",
        "JointGroup",
        "JointHandle",
        "JointModeHandle",
        "JointModeInterface",
        "JointStateGroup",
        "JointStateHandle",
        "JointStateInterface",
        "PositionJointInterface",
        "PosVelAccJointHandle",
        "PosVelAccJointInterface",
        "PosVelJointHandle",
        "PosVelJointInterface",
        "ResourceHandle",
        "ResourceManager",
        "VelocityJointInterface",
    ),
    "limits": ("JointLimits", "SoftJointLimits"),
    "parameters": ("Parameters", "ParameterTree"),
    "pid": ("Pid", "PidGains"),
    "realtime": (
        "RealtimeBox",
        "RealtimeBuffer",
        "RealtimeClock",
        "RealtimePublisher",
        "RealtimeServerGoalHandle",
    ),
    "robot_hw": (
        "ControllerInfo",
        "InterfaceResources",
        "ResourceConflict",
        "RobotHW",
        "SwitchState",
    ),
    "set_point": ("SetPointElement", "SetPointPort"),
    "station": ("Station",),
    "switching": ("Strictness", "SwitchRequest", "SwitchResult"),
    "tunables": ("Tunable",),
}
_HOMES = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "Clock",
    "CombinedRobotHW",
    "ControlLoop",
    "Controller",
    "ControllerBase",
    "ControllerInfo",
    "ControllerLoader",
    "ControllerManager",
    "ControllerSample",
    "ControllerState",
    "ControllerStatistics",
    "ControllerStatus",
    "EffortJointInterface",
    "ForceTorqueSensorHandle",
    "ForceTorqueSensorInterface",
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
    "ParameterTree",
    "Parameters",
    "Pid",
    "PidGains",
    "PosVelAccJointHandle",
    "PosVelAccJointInterface",
    "PosVelJointHandle",
    "PosVelJointInterface",
    "PositionJointInterface",
    "RealtimeBox",
    "RealtimeBuffer",
    "RealtimeClock",
    "RealtimePublisher",
    "RealtimeServerGoalHandle",
    "ResourceConflict",
    "ResourceHandle",
    "ResourceManager",
    "RobotHW",
    "SetPointElement",
    "SetPointPort",
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
    "Tunable",
    "VelocityJointInterface",
    "default_loaders",
]


def __getattr__(name: str) -> object:
    """Import the module of `name` and return what it holds.

    Raises:
        AttributeError: There is no such name.
    """
    if name not in _HOMES:
        raise AttributeError(f"module 'station.core' has no attribute {name!r}")
    return getattr(import_module(f"station.core.{_HOMES[name]}"), name)
