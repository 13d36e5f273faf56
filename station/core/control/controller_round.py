"""Update the running controllers once per cycle, and keep their commands."""

from typing import TYPE_CHECKING, Any

import cython

from station.core.control.command_pieces import CommandPieces, Piece
from station.core.control.records import Layout, Records
from station.core.control.sample_columns import SampleColumns
from station.core.control.usual_update import UsualUpdate
from station.core.hardware.stages import RobotWatch, Stage
from station.core.numerics.durations import Durations
from station.memory.wall_time import wall_time

if cython.compiled:
    from cython.cimports.cpython.pythread import PyThread_get_thread_ident as get_ident
else:
    from threading import get_ident

if TYPE_CHECKING:
    from collections.abc import Callable

_INF = float("inf")


class OwnerFlags:
    """Tells whether the owners of commands have to be looked at.

    Attributes:
        is_stale: Whether controllers have started or stopped since the owners were
            noted.
        traced_cycles: For how many cycles more somebody looks after every call for
            whoever writes commands that it does not own.
    """

    def __init__(self) -> None:
        self.is_stale = True
        self.traced_cycles = 0


class ControllerTurn:
    """What a round knows of one controller.

    Args:
        one: The controller as the manager keeps it: its flags `fresh` and
            `late_updates` are looked at, and its `overruns` are counted.
        controller: The controller itself.
        name: Its name.
        durations: Where the duration of each update goes [s].
        pieces: The commands that it has claimed.
        usual: Does the same as its `update` in usual cycles; None if nothing does.
        sampled: The columns of its sample; None if it makes samples itself.
    """

    def __init__(
        self,
        one: Any,  # noqa: ANN401 - what the manager keeps is unknown here
        controller: Any,  # noqa: ANN401 - whatever has `update`, `state` and `sample`
        name: str,
        durations: Durations,
        pieces: list[Piece],
        usual: UsualUpdate | None,
        sampled: SampleColumns | None,
    ) -> None:
        self.one = one
        self.controller = controller
        self.name = name
        self.durations = durations
        self.pieces = pieces
        self.usual = usual
        self.sampled = sampled
        self.place = -1


class ControllerRound(Stage):
    """The updates of a cycle, as far as it is a usual one; subclasses do the rest.

    Args:
        gate: Notes the owners of commands. While it `is_stale` or has `traced_cycles`,
            `look_closely` does the whole cycle.
        watch: Tells whether the robot has ended what controllers command.
        running: The state of a controller that runs.
        contained: Exceptions that end only the controller that raises them.

    Attributes:
        turns: The controllers that run, in the order of loading; see `take_turns`.
        layout: Where their samples are in a row of the records.
        kept: The commands that are written anew at the end of a cycle.
        update_budget: How long an update may take [s]; infinite without a budget.
        cycle: Number of cycles.
        time: Station time of the last cycle [s].
        thread: The thread of the last cycle.
        updating: Whether controllers are being updated.
        pending: The switch that is under way; None without one.
        resets: Whether the next cycle restarts all controllers first.
        stopwatch: Returns wall time [s]; None takes the clock of the system.
    """

    def __init__(
        self,
        gate: OwnerFlags,
        watch: RobotWatch,
        running: object,
        contained: tuple[type[BaseException], ...],
    ) -> None:
        self.gate = gate
        self.watch = watch
        self.running = running
        self.contained = contained
        self.turns: list[ControllerTurn] = []
        self.layout: Layout = ()
        self.records = Records(2)
        self.kept = CommandPieces([])
        self.update_budget = _INF
        self.cycle = 0
        self.time = 0.0
        self.thread = 0
        self.updating = False
        self.pending: Any = None
        self.resets = False
        self.stopwatch: Callable[[], float] | None = None

    def refuse(self, time: float, period: float) -> None:
        """Refuse a time or a period that is impossible."""
        raise NotImplementedError

    def look_closely(self, time: float, period: float) -> None:
        """Do a whole cycle that is not a usual one."""
        raise NotImplementedError

    def fail(self, one: Any, time: float, error: BaseException) -> None:  # noqa: ANN401
        """Take a controller off the robot whose update has raised."""
        raise NotImplementedError

    def attend(self, one: Any, time: float, duration: float, is_finite: bool) -> None:  # noqa: ANN401, FBT001
        """Look at an update that was not a usual one."""
        raise NotImplementedError

    def go_on_after(self, one: Any, time: float, period: float) -> None:  # noqa: ANN401
        """Do the rest of a cycle in which a controller has failed."""
        raise NotImplementedError

    def run(self, time: float, period: float) -> None:
        """Update all running controllers, then carry on with a pending switch."""
        # A negative or unknown period would turn integrators and filters around.
        if not (0.0 <= time < _INF and 0.0 <= period < _INF):
            self.refuse(time, period)
        self.thread = get_ident()
        self.updating = True
        self.cycle += 1
        self.time = time
        try:
            if (
                self.gate.is_stale
                or self.gate.traced_cycles
                or self.resets
                or self.pending is not None
                or self.watch.is_interrupted()
            ):
                self.look_closely(time, period)
            else:
                self.update_all(time, period)
        finally:
            self.updating = False

    def update_all(self, time: float, period: float) -> None:
        """Update all running controllers in a usual cycle."""
        for turn in self.turns:
            if turn.controller.state is self.running:
                self.update_one(turn, time, period)
                if self.gate.is_stale:
                    # It failed, and another one may have taken over.
                    self.go_on_after(turn.one, time, period)
                    return
        self.kept.keep()

    def update_one(self, turn: ControllerTurn, time: float, period: float) -> None:
        """Update one controller, and look at what it has commanded."""
        one, stopwatch = turn.one, self.stopwatch
        begin = wall_time() if stopwatch is None else stopwatch()
        try:
            if turn.usual is None or not turn.usual.run(time, period):
                turn.controller.update(time, period)
        except self.contained as error:
            self.fail(one, time, error)
            return
        is_finite = True
        for piece in turn.pieces:
            if not piece.take():
                is_finite = False
        duration = (wall_time() if stopwatch is None else stopwatch()) - begin
        turn.durations.put(duration)
        if duration > period and period > 0.0:
            one.overruns += 1
            one.last_overrun = time
        if (
            not is_finite
            or one.fresh
            or duration > self.update_budget
            or one.late_updates
        ):
            self.attend(one, time, duration, is_finite)

    def leave_in(self, records: Records) -> None:
        """Leave the cycles in these records from now on."""
        self.records = records
        self.take_turns(self.turns)

    def take_turns(self, turns: list[ControllerTurn]) -> None:
        """Update these controllers from now on, in their order."""
        layout = []
        at, room = 0, self.records.room
        for turn in turns:
            turn.place, width, size = -1, 0, 0
            sampled = turn.sampled
            if sampled is not None and at + sampled.width <= room:
                turn.place, width, size = at, sampled.width, sampled.size
                at += width
            layout.append((turn.name, turn.place, width, size))
        self.turns, self.layout = turns, tuple(layout)

    def leave(self, cycle: int, epoch: int, time: float, period: float) -> None:
        """Leave a row of the cycle: joints, and what each running controller did last.

        Args:
            cycle: Number of the cycle.
            epoch: The station's epoch.
            time: Station time [s].
            period: Time since the last cycle [s].
        """
        records = self.records
        at = records.begin(cycle, epoch, time, period, self.watch.mode())
        objects: dict[str, object] | None = None
        for turn in self.turns:
            controller = turn.controller
            is_running = controller.state is self.running
            sampled = turn.sampled
            if sampled is not None and turn.place >= 0:
                records.add(at + turn.place, sampled, is_running)
            elif is_running:
                sample = controller.sample if sampled is None else sampled.newest
                if sample is not None:
                    if objects is None:
                        objects = {}
                    objects[turn.name] = sample
        records.end(cycle, self.layout, objects)
