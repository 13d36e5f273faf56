"""A loaded controller: its claims, the commands it may write, its faults and times."""

import threading

from station.core.control.command_guard import CommandGuard, as_pieces
from station.core.control.controller import ControllerBase
from station.core.control.controller_status import (
    ControllerStatistics,
    ControllerStatus,
)
from station.core.hardware.robot_hw import ControllerInfo
from station.core.numerics.statistics import DurationRing
from station.core.ports.goal import Goal


class LoadedController:
    """What the manager keeps for each loaded controller.

    Attributes:
        controller: The controller.
        info: What the hardware is told about it.
        guards: One per claimed resource that takes commands.
        pieces: The same commands as few slices, for a cheap look every cycle.
        fallback: Names of the controllers that take over when it fails.
        may_jump: Its first command may be anything (`allow_start_jump: true`).
        fault: Why the manager stopped it; empty if it did not.
        traceback: The traceback of that; empty if there was none.
        fresh: Started, and not updated yet.
        ownership: Held while somebody starts or unloads it; never waited for.
        durations: Durations of its updates [s].
    """

    def __init__(
        self,
        controller: ControllerBase,
        info: ControllerInfo,
        guards: list[CommandGuard],
        fallback: tuple[str, ...],
        *,
        may_jump: bool,
    ) -> None:
        self.controller = controller
        self.info = info
        self.guards = guards
        self.pieces = as_pieces([slot for guard in guards for slot in guard.slots])
        self.fallback = fallback
        self.may_jump = may_jump
        self.fault = ""
        self.traceback = ""
        self.fresh = False
        self._last_set_point: list[float] | None = None
        self._last_goal: Goal | None = None
        self.ownership = threading.Lock()
        self.durations = DurationRing(1024)
        self.total = 0.0
        self.squares = 0.0
        self.overruns = 0
        self.last_overrun = 0.0

    def account(self, duration: float) -> None:
        """Note how long an update took [s]."""
        self.durations.add(duration)
        self.total += duration
        self.squares += duration * duration

    def reset_statistics(self) -> None:
        """Start the statistics anew; control thread or between cycles."""
        self.durations.reset()
        self.total = self.squares = 0.0
        self.overruns = 0
        self.last_overrun = 0.0

    def is_finite(self) -> bool:
        """Say whether every command is a finite number; cheap."""
        for storage, piece in self.pieces:
            total = sum(storage[piece])
            if total - total != 0.0:  # an overflow of the sum is no bad command
                return not self.bad_command()
        return True

    def bad_command(self) -> str:
        """Return which command is no finite number; empty if all are."""
        for guard in self.guards:
            value = guard.bad_command()
            if value:
                return f"command {value} for '{guard.name}'"
        return ""

    def write_rest(self) -> None:
        """Command everything it claims to rest where it is."""
        for guard in self.guards:
            guard.write_rest()

    def prepare(self, taken_over: set[tuple[str, str]]) -> str:
        """Make the commands ready for a start; return why that is impossible.

        Resources that nobody commanded until now begin at rest, so that no command of
        long ago reaches the robot; the others go on from the last command.

        Args:
            taken_over: (hardware interface, resource) of what goes on from the last
                command.
        """
        for guard in self.guards:
            if guard.claim not in taken_over:
                guard.write_rest()
            if not guard.remember():
                return f"the state of '{guard.name}' is not finite"
        return ""

    def watch_first_update(self) -> None:
        """Note that it was started and has not been updated yet."""
        port = self.controller.set_points
        self.fresh = True
        self._last_set_point = None if port is None else port.last
        self._last_goal = self._newest_goal()

    def got_set_point(self) -> bool:
        """Say whether it has got a set-point or a goal since it was started."""
        port = self.controller.set_points
        if port is not None and port.last is not self._last_set_point:
            return True
        return self._newest_goal() is not self._last_goal

    def _newest_goal(self) -> Goal | None:
        port = self.controller.goals
        goals = [] if port is None else port.goals()
        return goals[-1] if goals else None

    def abort_goals(self, reason: str) -> None:
        """End the controller's goals because it cannot go on.

        Args:
            reason: Why, one sentence.
        """
        if self.controller.goals is not None:
            self.controller.goals.abort(reason)

    def jumps(self) -> dict[str, float]:
        """Return how far its commands are from before it was started, by resource."""
        return {guard.name: guard.jump() for guard in self.guards}

    def excessive_jump(self) -> str:
        """Return which command is too far from the one before; empty if none is."""
        if self.may_jump:
            return ""
        for guard in self.guards:
            step, limit = guard.excess()
            if step > 0.0:
                return (
                    f"its first command for '{guard.name}' jumps by {step:.6g}; at "
                    f"most {limit:.6g} is allowed"
                )
        return ""

    def status(self) -> ControllerStatus:
        """Return its status. Any thread."""
        return ControllerStatus(
            self.info.name,
            self.info.type,
            self.controller.state,
            self.info.claimed_resources,
            self.fault,
            self.traceback,
            self.fallback,
            self.durations.percentiles(),
        )

    def statistics(self, time: float) -> ControllerStatistics:
        """Return its statistics at station time `time` [s]. Any thread."""
        percentiles = self.durations.percentiles()
        count = max(percentiles.count, 1)
        mean = self.total / count
        return ControllerStatistics(
            self.info.name,
            self.info.type,
            time,
            self.controller.is_running(),
            percentiles.max,
            mean,
            max(self.squares / count - mean * mean, 0.0),
            self.overruns,
            self.last_overrun,
            percentiles,
        )
