"""The tree of everything that can go wrong, as one root and named leaves.

```
StationError
├── HardwareInterfaceError        a handle or interface cannot be built or used
│   └── ResourceNotFoundError     no such resource in that interface (KeyError)
├── ParameterError                a parameter is missing or impossible (ValueError)
├── ControllerNotFoundError       no controller of that name is loaded (KeyError)
├── ControllerTypeNotFoundError   no loader knows that type (KeyError)
├── ControllerLoadError           a controller cannot be created or initialised
│   └── ControllerExistsError     that name is loaded already (ValueError)
├── ControllerStateError          not possible in the controller's state (RuntimeError)
├── SwitchRefusedError            a switch is not carried out; nothing changed
│   └── ResourceConflictError     two controllers want the same resource
├── SwitchTimeoutError            the switch missed its deadline (TimeoutError)
├── InvalidCommandError           a set-point is malformed (ValueError)
├── ArmNotFoundError              there is no arm of that name (KeyError)
├── ArmCommandError               an arm refuses a request in its mode (RuntimeError)
├── GripperNotFoundError          there is no hand at that arm (KeyError)
├── GripperCommandError           a hand cannot do that now (RuntimeError)
├── CommandTimeoutError           no new set-point arrived in time (TimeoutError)
├── InvalidTrajectoryError        a trajectory cannot be followed (ValueError)
├── GoalNotFoundError             no goal of that name is known (KeyError)
├── InvalidGainError              a gain is unknown or out of range (ValueError)
├── GainsChangedError             the gains are not the ones the caller has read
├── StaleEpochError               the command belongs to an older epoch
├── StoppedError                  the latched stop is engaged; nothing may move
├── LoopError                     the control loop is not running or died (RuntimeError)
├── SimulationError               there is no simulation, or not now (RuntimeError)
└── RobotDescriptionError         a URDF or mesh cannot be used (ValueError)
```
"""

from collections.abc import Mapping

from typing_extensions import override


class StationError(Exception):
    """Base of all errors the station raises on purpose.

    The message names the thing, its value and what is allowed; `remedy` says what
    to do. Both reach a REST client word by word.

    Attributes:
        code: Stable machine-readable name of the kind of failure.
        message: What is wrong, one sentence or more.
        remedy: What to do about it; may be empty.
        details: The facts of the message as data (JSON-compatible values).
    """

    code = "station_error"

    def __init__(
        self,
        message: str,
        *,
        remedy: str = "",
        details: Mapping[str, object] | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.remedy = remedy
        self.details: dict[str, object] = dict(details or {})

    @override
    def __str__(self) -> str:
        """Return the message as written (KeyError would quote it)."""
        return self.message


class HardwareInterfaceError(StationError):
    """A handle or interface cannot be built or used."""

    code = "hardware_interface"


class ResourceNotFoundError(HardwareInterfaceError, KeyError):
    """An interface has no resource of that name."""

    code = "resource_not_found"


class ParameterError(StationError, ValueError):
    """A parameter is missing, has a wrong type or an impossible value."""

    code = "invalid_parameter"


class ControllerNotFoundError(StationError, KeyError):
    """No controller of that name is loaded."""

    code = "controller_not_found"


class ControllerTypeNotFoundError(StationError, KeyError):
    """No loader knows a controller of that type."""

    code = "controller_type_not_found"


class ControllerLoadError(StationError):
    """A controller cannot be created or initialised."""

    code = "controller_load_failed"


class ControllerExistsError(ControllerLoadError, ValueError):
    """A controller of that name is loaded already."""

    code = "controller_exists"


class ControllerStateError(StationError, RuntimeError):
    """The request is not possible in the controller's present state."""

    code = "controller_state"


class SwitchRefusedError(StationError):
    """A switch is not carried out; controllers and hardware are as before."""

    code = "switch_refused"


class ResourceConflictError(SwitchRefusedError):
    """Two controllers would own the same resource."""

    code = "resource_conflict"


class SwitchTimeoutError(StationError, TimeoutError):
    """The switch was not finished at its deadline and has been withdrawn."""

    code = "switch_timeout"


class InvalidCommandError(StationError, ValueError):
    """A set-point has the wrong length, is not finite or is out of range."""

    code = "invalid_command"


class ArmNotFoundError(StationError, KeyError):
    """There is no arm of that name."""

    code = "arm_not_found"


class ArmCommandError(StationError, RuntimeError):
    """An arm refuses a request in its present mode, or cannot do it at all."""

    code = "arm_command_refused"


class ServiceNotFoundError(StationError, KeyError):
    """The robot has no service of that name."""

    code = "service_not_found"


class GripperNotFoundError(StationError, KeyError):
    """The arm has no hand."""

    code = "gripper_not_found"


class GripperCommandError(StationError, RuntimeError):
    """A hand cannot do that now."""

    code = "gripper_command_refused"


class CommandTimeoutError(StationError, TimeoutError):
    """No new set-point arrived in time, and the controller was told to stop then."""

    code = "command_timeout"


class InvalidTrajectoryError(StationError, ValueError):
    """A trajectory is malformed or cannot be followed as it is."""

    code = "invalid_trajectory"


class GoalNotFoundError(StationError, KeyError):
    """The controller knows no goal of that name."""

    code = "goal_not_found"


class InvalidGainError(StationError, ValueError):
    """A gain is unknown, not finite or out of range."""

    code = "invalid_gain"


class GainsChangedError(StationError):
    """The gains were changed by somebody else since they were read."""

    code = "gains_changed"


class StaleEpochError(StationError):
    """The command was issued before the last stop, reset or recovery."""

    code = "stale_epoch"


class StoppedError(StationError):
    """The station is stopped, or released but not armed again."""

    code = "stopped"


class LoopError(StationError, RuntimeError):
    """The control loop is not running, is running already, or died."""

    code = "loop"


class SimulationError(StationError, RuntimeError):
    """The simulation cannot do that now, or there is none."""

    code = "simulation_refused"


class RobotDescriptionError(StationError, ValueError):
    """A robot description (URDF, mesh) is missing or cannot be used."""

    code = "robot_description"
