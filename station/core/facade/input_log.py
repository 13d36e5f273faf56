"""The inputs of a station, each with the cycle before which it took effect.

A station that is stepped from the same configuration, with the same inputs before the
same cycles, moves in the same way bit for bit. A recording keeps the inputs for such a
re-run.
"""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from station.core.loop.control_loop import ControlLoop
from station.core.ports.command_ticket import CommandTicket
from station.reports import LoopState

CAPACITY = 10_000
"""Largest number of inputs that wait; without a recorder no thread takes them."""
_MOTIONS = frozenset({
    "set_point", "goal", "trajectory", "cancel_goal", "hold_trajectory", "expire"
})  # fmt: skip


@dataclass(frozen=True, slots=True)
class Input:
    """One request that changed the station.

    Attributes:
        kind: Kind of input; `operation` if a re-run cannot repeat it.
        arguments: The arguments, as JSON-compatible values.
        after: Returns the last cycle before the input took effect; None before that.
        until: Returns the last cycle before a set-point expired; None before that.
    """

    kind: str
    arguments: Mapping[str, object]
    after: Callable[[], int | None]
    until: Callable[[], int | None] = lambda: None


class InputLog:
    """Keeps the inputs of a station since its first cycle. Any thread.

    Args:
        loop: The loop.

    Attributes:
        is_complete: Whether no input was dropped before it was taken.
        changes: Number of inputs that changed more than the motion.
        last_change: Kind of the last such input; empty before the first.
        commands: Number of inputs by name of the controller.
    """

    def __init__(self, loop: ControlLoop) -> None:
        self.is_complete = True
        self.changes = 0
        self.last_change = ""
        self.commands: dict[str, int] = {}
        self._loop = loop
        # Appending and popping are atomic, so no lock is needed.
        self._inputs: deque[Input] = deque(maxlen=CAPACITY)

    def note(self, kind: str, **arguments: object) -> None:
        """Note an input that takes effect now, between two cycles or without a loop."""
        cycle = self._loop.cycle
        self._add(kind, arguments, lambda: cycle)

    def note_in_cycle(self, kind: str, **arguments: object) -> None:
        """Note the effect of an operation; called within the operation."""
        # In the thread, the number of the cycle has been counted up already.
        running = self._loop.state is LoopState.RUNNING
        cycle = self._loop.cycle - (1 if running else 0)
        self._add(kind, arguments, lambda: cycle)

    def note_command(
        self, kind: str, ticket: CommandTicket, **arguments: object
    ) -> None:
        """Note a command, which a later cycle may pick up.

        If the command was planned, the input names the station time from which it was
        planned, because cycles may have passed until the plan was ready.
        """

        def after() -> int | None:
            return None if ticket.accepted_cycle is None else ticket.accepted_cycle - 1

        def until() -> int | None:
            return None if ticket.ended is None else ticket.ended - 1

        if ticket.planned_at is not None:
            arguments["planned_at"] = ticket.planned_at
        self._add(kind, arguments, after, until)

    def note_stop(self, reason: str) -> None:
        """Note that the stop was engaged; the next cycle carries it out."""
        latch, cycle = self._loop.stop_latch, self._loop.cycle
        running = self._loop.state is LoopState.RUNNING

        def after() -> int | None:
            if not running:
                return cycle
            return latch.cycle - 1 if latch.cycle > cycle else None

        self._add("stop", {"reason": reason}, after)

    def take_inputs(self) -> list[Input]:
        """Return the inputs since the last call; there is only one recorder."""
        taken = []
        while self._inputs:
            taken.append(self._inputs.popleft())
        return taken

    def _add(
        self,
        kind: str,
        arguments: Mapping[str, object],
        after: Callable[[], int | None],
        until: Callable[[], int | None] = lambda: None,
    ) -> None:
        if kind not in _MOTIONS:
            self.last_change = str(arguments.get("service", kind))
            self.changes += 1
        name = str(arguments.get("name", ""))
        self.commands[name] = self.commands.get(name, 0) + 1
        # The oldest input is lost, so a recording must not claim to be complete.
        if len(self._inputs) >= CAPACITY:
            self.is_complete = False
        self._inputs.append(Input(kind, arguments, after, until))
