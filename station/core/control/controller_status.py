"""The status of a loaded controller, for people."""

from dataclasses import dataclass

from station.core.control.controller import ControllerState
from station.core.hardware.robot_hw import InterfaceResources
from station.reports import AsyncStatistics, Percentiles


@dataclass(frozen=True, slots=True)
class ControllerStatus:
    """A controller as `controller_manager_msgs/ControllerState` has it, and more.

    Attributes:
        name: Name under which it is loaded.
        type: Type as the parameters name it.
        state: State of its life cycle.
        claimed_resources: Claims, one entry per hardware interface (CM-85).
        fault: Why the manager stopped it; None if the manager did not.
        traceback: Traceback that belongs to `fault`; None if there is none.
        fallback: Names of the controllers that take over when it fails.
        time: Duration of its updates [s].
        notes: Warnings for its user, e.g. of a parameter that has no effect; one
            sentence or more each.
        update_rate: How often it is updated while it runs [Hz]; 0 while no loop is
            known.
        async_update: Report on its updates in a thread of its own; None if the control
            thread updates it.
    """

    name: str
    type: str
    state: ControllerState
    claimed_resources: tuple[InterfaceResources, ...]
    fault: str | None
    traceback: str | None
    fallback: tuple[str, ...]
    time: Percentiles
    notes: tuple[str, ...] = ()
    update_rate: float = 0.0
    async_update: AsyncStatistics | None = None


@dataclass(frozen=True, slots=True)
class ControllerCondition:
    """The part of a controller's status that changes; cheap to read often.

    Attributes:
        name: Name under which it is loaded.
        type: Type as the parameters name it.
        state: State of its life cycle.
        fault: Why the manager stopped it; None if the manager did not.
        traceback: Traceback that belongs to `fault`; None if there is none.
    """

    name: str
    type: str
    state: ControllerState
    fault: str | None
    traceback: str | None


@dataclass(frozen=True, slots=True)
class ControllerStatistics:
    """A controller as `controller_manager_msgs/ControllerStatistics` has it.

    Attributes:
        name: Name under which it is loaded.
        type: Its type.
        timestamp: Station time of the last cycle [s].
        running: Whether it runs.
        max_time: Longest update [s].
        mean_time: Mean duration of an update [s].
        variance_time: Variance of the durations [s^2].
        num_control_loop_overruns: Updates that took longer than the cycle's period.
        time_last_control_loop_overrun: Station time of the last such update [s].
        time: Percentiles of the durations [s]; its `count` is the number of updates.
        total_updates: Updates since it was loaded; a reset of the statistics does not
            change it.
        total_overruns: Overruns since it was loaded.
        update_rate: Rate of its updates while it runs [Hz].
    """

    name: str
    type: str
    timestamp: float
    running: bool
    max_time: float
    mean_time: float
    variance_time: float
    num_control_loop_overruns: int
    time_last_control_loop_overrun: float
    time: Percentiles
    total_updates: int
    total_overruns: int
    update_rate: float = 0.0
