"""The exceptions that the station raises on purpose, in one tree.

```
StationError
├── HardwareInterfaceError        a handle or interface cannot be built or used
│   └── ResourceNotFoundError     no such resource in that interface (KeyError)
├── ParameterError                a parameter is missing or impossible (ValueError)
│   ├── ParameterNotFoundError    the tree has no such parameter (KeyError)
│   └── ConfigError               all that is wrong with a configuration
├── ControllerNotFoundError       no controller of that name is loaded (KeyError)
├── ControllerTypeNotFoundError   no loader knows that type (KeyError)
├── ControllerLoadError           a controller cannot be created or initialised
│   ├── ControllerExistsError     that name is loaded already (ValueError)
│   └── ControllerModuleRefusedError   its module may not be imported (PermissionError)
├── ControllerStateError          not possible in the controller's state (RuntimeError)
├── SwitchRefusedError            a switch was refused; nothing changed
│   └── ResourceConflictError     two controllers want the same resource
├── SwitchTimeoutError            the switch missed its deadline (TimeoutError)
├── InvalidCommandError           a set-point is malformed (ValueError)
├── HardwareComponentNotFoundError   no such hardware component (KeyError)
├── HardwareComponentError        it is in use, or refuses a state (RuntimeError)
├── ArmNotFoundError              there is no arm of that name (KeyError)
├── ArmCommandError               an arm refuses a request in its mode (RuntimeError)
├── ServiceNotFoundError          the robot has no service of that name (KeyError)
├── GripperNotFoundError          there is no hand at that arm (KeyError)
├── GripperCommandError           a hand cannot carry out a request (RuntimeError)
├── GripperLostError              there is no connection to a hand (ConnectionError)
├── CommandTimeoutError           no new set-point arrived in time (TimeoutError)
├── InvalidTrajectoryError        a trajectory cannot be followed (ValueError)
├── GoalNotFoundError             no goal of that name is known (KeyError)
├── InvalidGainError              a gain is unknown or out of range (ValueError)
├── GainSetNotFoundError          there is no gain set of that name (KeyError)
├── GainSetError                  a gain set cannot be read or written (OSError)
├── PlotLayoutNotFoundError       there is no plot layout of that name (KeyError)
├── PlotLayoutError               a plot layout cannot be read or written (OSError)
├── SceneObjectNotFoundError      the scene has no object of that name (KeyError)
├── SavedSceneNotFoundError       there is no saved scene of that name (KeyError)
├── SavedSceneError               a saved scene cannot be read or written (OSError)
├── SceneRefusedError             a solid object cannot be changed now (RuntimeError)
├── WaypointPathNotFoundError     there is no waypoint path of that name (KeyError)
├── WaypointPathError             a waypoint path cannot be read or written (OSError)
├── PathRefusedError              a path cannot be played now (RuntimeError)
├── NothingToUndoError            no change of gains is left to be taken back
├── GainsChangedError             the gains changed since the caller read them
├── RecordingNotFoundError        there is no recording of that name (KeyError)
├── RecordingRefusedError         not possible in the recording's state (RuntimeError)
├── RecordingFileError            a recording cannot be read or written (OSError)
│   └── RecordingDamagedError     it has damaged bytes, or lacks its end
├── StaleEpochError               the command belongs to an older epoch
├── StoppedError                  the latched stop is engaged; nothing may move
├── LoopError                     the control loop is not running or died (RuntimeError)
├── SimulationError               a simulation refuses a request (RuntimeError)
├── RehearsalError                a rehearsal cannot be made (RuntimeError)
├── NoPathError                   there is no way to a pose, or none was found
├── RehearsalNeededError          the caller may move nothing without a rehearsal
├── CertificateNotFoundError      no certificate of that name is valid (KeyError)
├── CertificateVoidError          something has changed since the rehearsal
└── RobotDescriptionError         a URDF or mesh cannot be used (ValueError)
```

Controllers and robots that users wrote may raise an exception of any type. Its text may
fail to print, be of any length, or contain surrogates that no JSON can carry;
`describe` makes a text of it.
"""

import difflib
import traceback
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from numbers import Real
from typing import NoReturn

from typing_extensions import override

_MAX_SHOWN = 80
_MAX_LISTED = 8
_LIKELY = 0.6
"""Likeness of a name that may have been meant; the default of `difflib`."""
_FAINT = 0.3
"""Likeness below which the nearest names are nearest by chance."""
MAX_REASON = 1000
"""Longest text of a fault [characters]; every list of controllers contains it."""
MAX_TRACE = 20_000
"""Longest traceback [characters]; a longer one loses its beginning."""
CONTAINED = (Exception, SystemExit)
"""Exceptions that end only the plugin that raised them; `exit()` raises the second."""


def show(value: object) -> str:
    """Return a value as a message shows it, shortened to 80 characters.

    Args:
        value: Any plain data.
    """
    # An integer of thousands of digits has no text: Python refuses to write it.
    if isinstance(value, int) and value.bit_length() > 4 * _MAX_SHOWN:
        return f"an integer of {value.bit_length()} bits"
    text = repr(value)
    return text if len(text) <= _MAX_SHOWN else f"{text[: _MAX_SHOWN - 1]}…"


def counted(number: int, word: str) -> str:
    """Return a number with its noun: `1 joint`, `2 joints`.

    Args:
        number: The number.
        word: The noun in the singular, whose plural has an s.
    """
    return f"{number} {word}" if number == 1 else f"{number} {word}s"


def suggest(name: str, known: Iterable[str]) -> str:
    """Return a sentence about known names that resemble `name`.

    The sentence lists all known names if they are few. Otherwise it gives the three
    nearest ones and the number of all, or the first three if none resembles it.

    Args:
        name: The name that is unknown.
        known: The names there are, in the order in which they are listed.
    """
    return _suggest(name, tuple(dict.fromkeys(known)))


# A controller that is loaded again has the same unknown parameters again.
@lru_cache(maxsize=4096)
def _suggest(name: str, names: tuple[str, ...]) -> str:
    if not names:
        return "There are none."
    if len(names) <= _MAX_LISTED:
        likely = difflib.get_close_matches(name, names, 1)
        meant = f"Did you mean '{likely[0]}'? " if likely and len(names) > 1 else ""
        return f"{meant}There are: {', '.join(names)}."
    (ratio, first), (_, second), (_, third) = _nearest(name, names)
    if ratio >= _LIKELY:
        meant = f"'{first}', '{second}' or '{third}'"
        return f"Did you mean {meant}? There are {len(names)} in all."
    if ratio >= _FAINT:
        return f"The nearest of {len(names)} are '{first}', '{second}' and '{third}'."
    first, second, third = names[:3]
    return f"There are {len(names)}, such as '{first}', '{second}' and '{third}'."


def _nearest(name: str, names: Sequence[str]) -> list[tuple[float, str]]:
    """Return the three names that resemble `name` most, each after its likeness.

    They are those of `difflib.get_close_matches`, which compares all names in full.
    """
    matcher = difflib.SequenceMatcher(b=name)
    bounds: list[tuple[float, str]] = []
    for one in names:
        matcher.set_seq1(one)
        bounds.append((matcher.quick_ratio(), one))
    best: list[tuple[float, str]] = []
    for bound, one in sorted(bounds, reverse=True):
        if len(best) == 3 and bound < best[-1][0]:
            break
        matcher.set_seq1(one)
        best = sorted([*best, (matcher.ratio(), one)], reverse=True)[:3]
    return best


class StationError(Exception):
    """Base of all errors that the station raises on purpose.

    The message names the thing, its value and the allowed values; `remedy` says what
    to do. A REST client receives both unchanged.

    Attributes:
        code: Stable machine-readable name of the kind of failure.
        message: The problem, in one sentence or more.
        remedy: Advice to the user, in full sentences; may be empty.
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


class HardwareComponentNotFoundError(StationError, KeyError):
    """There is no hardware component of that name."""

    code = "hardware_component_not_found"


class HardwareComponentError(StationError, RuntimeError):
    """A hardware component keeps its state: it is in use, or refuses the change."""

    code = "hardware_component_state"


class ParameterError(StationError, ValueError):
    """A parameter is missing, has a wrong type or an impossible value."""

    code = "invalid_parameter"


class ParameterNotFoundError(ParameterError, KeyError):
    """The tree has no parameter of that path."""

    code = "parameter_not_found"


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


class ControllerModuleRefusedError(ControllerLoadError, PermissionError):
    """The module of a controller is not among those that may be imported."""

    code = "controller_module_refused"


class ControllerStateError(StationError, RuntimeError):
    """A request is not possible in the present state of the controller."""

    code = "controller_state"


class SwitchRefusedError(StationError):
    """A switch was refused; controllers and hardware are as before."""

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


def is_number(value: object) -> bool:
    """Return whether a value of any type is a number; a boolean is not."""
    # Nearly every value is a float, and `isinstance` of an abstract class takes ten
    # times as long.
    if type(value) is float:
        return True
    return isinstance(value, Real) and not isinstance(value, bool)


def refuse_non_number(name: str, command: object) -> NoReturn:
    """Refuse a command that is not a number.

    Args:
        name: Commanded resource, usually a joint.
        command: The command.

    Raises:
        InvalidCommandError: Always.
    """
    raise InvalidCommandError(
        f"The command for '{name}' is {show(command)}; it must be a number.",
        remedy="Send one number per joint.",
        details={"element": name},
    )


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
    """A hand cannot carry out a request in its present state."""

    code = "gripper_command_refused"


class GripperLostError(StationError, ConnectionError):
    """There is no connection to a hand."""

    code = "gripper_lost"


class CommandTimeoutError(StationError, TimeoutError):
    """No new set-point arrived within the timeout of the last one."""

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


class GainSetNotFoundError(StationError, KeyError):
    """There is no gain set of that name."""

    code = "gain_set_not_found"


class GainSetError(StationError, OSError):
    """The file of a gain set cannot be read or written, or is malformed."""

    code = "gain_set_file"


class PlotLayoutNotFoundError(StationError, KeyError):
    """There is no plot layout of that name."""

    code = "plot_layout_not_found"


class PlotLayoutError(StationError, OSError):
    """A plot layout cannot be read or written, or its file is malformed."""

    code = "plot_layout_unusable"


class SavedSceneNotFoundError(StationError, KeyError):
    """There is no saved scene of that name."""

    code = "saved_scene_not_found"


class SavedSceneError(StationError, OSError):
    """A saved scene cannot be read or written, or its file is malformed."""

    code = "saved_scene_unusable"


class SceneObjectNotFoundError(StationError, KeyError):
    """The scene has no object of that name."""

    code = "scene_object_not_found"


class SceneRefusedError(StationError, RuntimeError):
    """A solid object of a simulated world refuses such a change while it runs."""

    code = "scene_refused"


class WaypointPathNotFoundError(StationError, KeyError):
    """There is no waypoint path of that name."""

    code = "waypoint_path_not_found"


class WaypointPathError(StationError, OSError):
    """A waypoint path cannot be read from disk or written to it."""

    code = "waypoint_path_unusable"


class PathRefusedError(StationError, RuntimeError):
    """A waypoint path cannot be played, paused or resumed in the present state."""

    code = "path_refused"


class NothingToUndoError(StationError):
    """No change of gains is left to be taken back."""

    code = "nothing_to_undo"


class GainsChangedError(StationError):
    """The gains have changed since they were read."""

    code = "gains_changed"


class RecordingNotFoundError(StationError, KeyError):
    """There is no recording or incident of that name."""

    code = "recording_not_found"


class RecordingRefusedError(StationError, RuntimeError):
    """A recording cannot be started, stopped, read or deleted now."""

    code = "recording_refused"


class RecordingFileError(StationError, OSError):
    """The file of a recording cannot be read or written, or is not a recording."""

    code = "recording_file"


class RecordingDamagedError(RecordingFileError):
    """The file of a recording has damaged bytes, or lacks its end."""

    code = "recording_damaged"


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
    """The simulation refuses a request now, or there is no simulation."""

    code = "simulation_refused"


class RehearsalError(StationError, RuntimeError):
    """A rehearsal cannot be made on this machine, or came to no result."""

    code = "rehearsal_failed"


class NoPathError(StationError, RuntimeError):
    """There is no path free of collisions, or none was found in time."""

    code = "no_path"


class RehearsalNeededError(StationError, PermissionError):
    """The caller may command a motion only with the certificate of a rehearsal."""

    code = "rehearsal_needed"


class CertificateNotFoundError(StationError, KeyError):
    """There is no certificate of that name, or it has been used or has expired."""

    code = "certificate_not_found"


class CertificateVoidError(StationError):
    """The command is not the rehearsed one, or something that matters has changed."""

    code = "certificate_void"


class RobotDescriptionError(StationError, ValueError):
    """A robot description (URDF, mesh) is missing or cannot be used."""

    code = "robot_description"


class ConfigError(ParameterError):
    """A configuration cannot be read, or holds something that is not allowed.

    Args:
        problems: One sentence each: place, key, value and allowed values.
        remedy: Advice to the user.

    Attributes:
        problems: The sentences.
    """

    code = "invalid_configuration"

    def __init__(self, problems: Sequence[str], *, remedy: str) -> None:
        super().__init__(
            "\n".join(problems), remedy=remedy, details={"errors": list(problems)}
        )
        self.problems = tuple(problems)


def key_text(path: Sequence[str | int]) -> str:
    """Return the path of a key as a message names it, such as `robot.arms[0].base`.

    Args:
        path: Keys of mappings and indices of lists, from the root.
    """
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return "".join(parts).removeprefix(".")


def reason_of(where: str, error: BaseException) -> str:
    """Return one line that names a callback and the exception it raised.

    Args:
        where: Name of the callback.
        error: The exception.
    """
    return f"{where} raised {describe(error)}"


def describe(error: BaseException) -> str:
    """Return an exception as `Type: text`, without lone surrogates."""
    try:
        text = str(error)
    except CONTAINED:
        text = "(its text cannot be read)"
    if len(text) > MAX_REASON:
        text = f"{text[:MAX_REASON]}... ({len(text)} characters)"
    return printable(f"{type(error).__name__}: {text}")


def trace_of_fault() -> str:
    """Return the traceback of the exception that is being handled."""
    return printable(traceback.format_exc()[-MAX_TRACE:])


def printable(text: str) -> str:
    """Return `text` with lone surrogates, which UTF-8 cannot encode, as escapes."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
