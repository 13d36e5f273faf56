"""A loaded controller: its claims, the commands it may write, its faults and times."""

import threading
from math import inf
from typing import TYPE_CHECKING

from station.core.control.chainable_controller import (
    ChainableController,
    ExportedState,
    Reference,
    ReferenceInterface,
)
from station.core.control.command_guard import CommandGuard
from station.core.control.controller import (
    ControllerBase,
    ControllerCondition,
    ControllerState,
    ControllerStatistics,
    ControllerStatus,
)
from station.core.control.controller_commands import ControllerCommands
from station.core.hardware.interfaces.resource_manager import interface_type_name
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.numerics.durations import DurationRing
from station.core.ports.goal import Goal

if TYPE_CHECKING:
    from station.core.control.async_update import AsyncUpdate
    from station.core.control.sample_columns import SampleColumns


class UpdateTimes(DurationRing):
    """Durations of a controller's updates [s], and those that took too long.

    Attributes:
        overruns: Number of updates since loading that took longer than the period.
        overruns_before: `overruns` when the statistics were started anew.
        last_overrun: Station time of the last overrun [s].
        late_updates: Updates in a row that took longer than the budget.
        stalled_at: Station time of the last stall, see `LONGEST_UPDATE` [s]; minus
            infinity if there was none since the start.
    """

    def __init__(self) -> None:
        self.overruns = self.overruns_before = 0
        self.forget_late_updates()
        super().__init__(1024)

    def reset(self) -> None:
        """Start the statistics anew; called in the control thread or between cycles."""
        super().reset()
        self.overruns_before = self.overruns
        self.last_overrun = 0.0

    def forget_late_updates(self) -> None:
        """Forget late updates of earlier runs."""
        self.late_updates = 0
        self.stalled_at = -inf


class LoadedController:
    """The manager's record of a loaded controller.

    Attributes:
        controller: The controller.
        info: Its description for the hardware.
        commands: Every command that it has claimed.
        fallback: Names of the controllers that take over when it fails.
        may_jump: Whether its first command may be anything (`allow_start_jump: true`).
        fault: Why the manager stopped it; None if the manager did not.
        traceback: Traceback of that fault; None if there was none.
        is_unreleased: Whether the robot has not confirmed that the controller has
            stopped, so that the robot may still be in the controller's mode.
        fresh: Whether it was started and has not been updated yet.
        ownership: Lock that a start or an unloading holds; no thread waits for it.
        times: Durations of its updates.
        sampled: The columns of its sample; None if it makes samples itself.
        place: Index of its first column in a snapshot's row; -1 without columns.
        references: References that this controller exports.
        states: States that this controller exports.
        following: Controllers whose references this controller commands.
        read: Controllers whose exported states this controller reads.
        update_rate: The rate that its parameters ask for [Hz]; 0 for every cycle.
        every: Number of cycles from one update to the next, >= 1.
        countdown: Number of cycles until its next update.
        elapsed: Time since its last update, or since its start [s].
        beside: Updates it in a thread of its own; None if the control thread updates
            it.
    """

    def __init__(
        self,
        controller: ControllerBase,
        info: ControllerInfo,
        guards: list[CommandGuard],
        fallback: tuple[str, ...],
        *,
        may_jump: bool,
        notes: tuple[str, ...] = (),
        following: "tuple[LoadedController, ...]" = (),
        read: "tuple[LoadedController, ...]" = (),
    ) -> None:
        self.controller = controller
        self.info = info
        self.commands = ControllerCommands(guards)
        self.blocks = self.commands.blocks
        self.sampled: SampleColumns | None = None
        self.place = -1
        self.fallback = fallback
        self.may_jump = may_jump
        self.notes = notes
        self.references: tuple[Reference, ...] = ()
        self.states: tuple[ExportedState, ...] = ()
        if isinstance(controller, ChainableController):
            self.references = tuple(controller.on_export_reference_interfaces())
            self.states = tuple(controller.on_export_state_interfaces())
        self.following = following
        self.read = read
        self.update_rate = 0.0
        self.beside: AsyncUpdate | None = None
        self.loop_period = 0.0
        self.every = 1
        self.countdown = 0
        self.elapsed = 0.0
        self.fault: str | None = None
        self.traceback: str | None = None
        self.is_unreleased = False
        self.fresh = False
        self.last_set_point: list[float] | None = None
        self.last_goal: Goal | None = None
        self.ownership = threading.Lock()
        self.times = UpdateTimes()

    def set_loop_period(self, period: float) -> None:
        """Choose the number of cycles that is nearest to the requested period.

        Args:
            period: Nominal period of the loop [s], > 0.
        """
        self.loop_period = period
        if self.update_rate > 0.0:
            # A half is rounded up, as std::round of ros2_control does.
            self.every = max(int(1.0 / (period * self.update_rate) + 0.5), 1)

        # The rate of an asynchronous controller is that of its own updates.
        if self.beside is not None:
            self.beside.every, self.every = self.every, 1

    def count_cycle(self, period: float) -> float:
        """Count a cycle; return the time since the last update if the next one is due.

        If none is due, the controller's commands are written again.

        Args:
            period: Time since the last cycle [s].

        Returns:
            The time [s]; negative if no update is due.
        """
        self.elapsed += period
        if self.countdown > 0:
            self.countdown -= 1
            # The robot may have limited them in place: write the unlimited ones.
            self.commands.write_again()
            return -1.0
        self.countdown = self.every - 1
        # As in ros2_control the first update has the period of those that follow.
        is_first = self.fresh and period > 0.0
        elapsed = self.every * self.loop_period if is_first else self.elapsed
        self.elapsed = 0.0
        return elapsed

    def actual_rate(self) -> float:
        """Return the controller's update rate [Hz]; 0 before a loop runs it."""
        every = self.every if self.beside is None else self.beside.every
        period = self.loop_period * every
        return round(1.0 / period, 6) if period > 0.0 else 0.0

    def _rate_notes(self) -> tuple[str, ...]:
        actual, wanted = self.actual_rate(), self.update_rate
        if not wanted or not actual or abs(actual - wanted) <= 1e-6 * wanted:
            return ()
        return (
            f"Its update_rate of {wanted:g} Hz is no whole part of the loop's "
            f"{1.0 / self.loop_period:g} Hz: it is updated at {actual:g} Hz, after "
            "the nearest number of cycles.",
        )

    def watch_first_update(self) -> None:
        """Note that the controller was started and has not been updated yet."""
        controller = self.controller
        port = controller.set_points
        self.fresh = True
        self.countdown = 0
        self.elapsed = 0.0
        self.sampled = controller.sampled
        self.last_set_point = None if port is None else port.last
        self.last_goal = self._newest_goal()

    def got_set_point(self) -> bool:
        """Return whether a set-point or a goal has arrived since the start."""
        port = self.controller.set_points
        if port is not None and port.last is not self.last_set_point:
            return True
        return self._newest_goal() is not self.last_goal

    def _newest_goal(self) -> Goal | None:
        port = self.controller.goals
        goals = [] if port is None else port.goals()
        # Not goals[-1]: compiled code does not accept negative indices.
        return goals[len(goals) - 1] if goals else None

    def abort_goals(self, reason: str) -> None:
        """End the controller's goals because it cannot go on.

        Args:
            reason: Why, one sentence.
        """
        if self.controller.goals is not None:
            self.controller.goals.abort(reason)

    def excessive_jump(self) -> str | None:
        """Return a command that is too far from the previous one; None if none is."""
        return None if self.may_jump else self.commands.excessive_jump()

    def missing_following(self) -> "LoadedController | None":
        """Return a controller that it commands or reads and that does not run.

        Returns:
            None if all run.
        """
        for one in (*self.following, *self.read):
            if one.controller.state is not ControllerState.RUNNING:
                return one
        return None

    def add_fault(self, text: str) -> None:
        """Add another fault after those noted before."""
        self.fault = text if self.fault is None else f"{self.fault} ({text})"

    def status(self) -> ControllerStatus:
        """Return its status. Any thread."""
        tunables = self.controller.tunables
        return ControllerStatus(
            self.info.name,
            self.info.type,
            self.controller.state,
            self._claims(),
            self.fault,
            self.traceback,
            self.fallback,
            self.times.percentiles(),
            (*self.notes, *self._rate_notes(), *tunables.notes(tunables.values)),
            self.actual_rate(),
            None if self.beside is None else self.beside.statistics(),
        )

    def _claims(self) -> tuple[InterfaceResources, ...]:
        """Return its claims of the robot's resources, and of references."""
        claims, references = self.info.claimed_resources, self.info.references
        if not references:
            return claims
        name = interface_type_name(ReferenceInterface)
        return (*claims, InterfaceResources(name, references))

    def condition(self) -> ControllerCondition:
        """Return its state and fault, without statistics. Any thread."""
        return ControllerCondition(
            self.info.name,
            self.info.type,
            self.controller.state,
            self.fault,
            self.traceback,
        )

    def statistics(self, time: float) -> ControllerStatistics:
        """Return its statistics at station time `time` [s]. Any thread."""
        times = self.times
        percentiles = times.percentiles()
        count = max(percentiles.count, 1)
        mean = times.total / count
        return ControllerStatistics(
            self.info.name,
            self.info.type,
            time,
            self.controller.is_running(),
            percentiles.max,
            mean,
            # Rounding can make it slightly negative.
            max(times.squares / count - mean * mean, 0.0),
            times.overruns - times.overruns_before,
            times.last_overrun,
            percentiles,
            times.added,
            times.overruns,
            self.actual_rate(),
        )
