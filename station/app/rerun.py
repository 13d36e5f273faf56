"""Re-run a recording: step its configuration with its inputs, and compare.

A station is deterministic: the same configuration with the same inputs before the same
cycles gives the same motion, bit for bit. So a recording is a regression test of
controllers, robots and the station itself.
"""

import json
from collections import deque
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from station.app.composition import compose
from station.config import load_config
from station.core.clock import ManualClock
from station.core.errors import RecordingFileError, StationError
from station.core.facade.repeated_inputs import (
    PLANNED,
    Arguments,
    carry_out,
    carry_out_plan,
)
from station.core.facade.station import Station
from station.records.recording_reader import (
    Trajectory,
    read_inputs,
    read_texts,
    read_trajectory,
)

if TYPE_CHECKING:
    from collections.abc import Callable

_STANDSTILL = ManualClock()
"""Clock for the timeouts of set-points; it stands still, because wall time has no
effect in a re-run."""
_BATCH = 1000
"""Cycles between two reads of the ring of snapshots, which keeps 4096."""


@dataclass(frozen=True, slots=True)
class Difference:
    """The first difference between a re-run and its recording.

    Attributes:
        cycle: The first cycle that differs.
        joint: The first joint that differs in this cycle.
        quantity: position, velocity or effort.
        recorded: Value of the quantity in the recording [rad, m, rad/s, m/s, Nm or N].
        rerun: Value of the quantity in the re-run, in the same unit.
    """

    cycle: int
    joint: str
    quantity: str
    recorded: float
    rerun: float


@dataclass(frozen=True, slots=True)
class RerunResult:
    """The comparison of a re-run with its recording.

    Attributes:
        cycles: Number of cycles that were compared.
        difference: The first difference; None when there is none.
        not_repeated: Inputs that cannot be repeated, one sentence each, with the cycle
            from which the re-run may differ.
    """

    cycles: int
    difference: Difference | None
    not_repeated: tuple[str, ...]

    @property
    def is_equal(self) -> bool:
        """Return whether every cycle is the same, bit for bit."""
        return self.difference is None

    def as_json(self) -> dict[str, object]:
        """Return the result as JSON-compatible data."""
        return {"is_equal": self.is_equal, **asdict(self)}

    def text(self) -> str:
        """Return the result for people."""
        found = self.difference
        if found is None:
            verdict = f"Equal: {self.cycles} cycles are the same, bit for bit."
        else:
            verdict = (
                f"Different from cycle {found.cycle} on: the {found.quantity} of "
                f"'{found.joint}' was {found.recorded!r} and is {found.rerun!r} now."
            )
        return "\n".join((verdict, *self.not_repeated))


def rerun(path: Path | str) -> RerunResult:
    """Step the station of a recording again and compare every cycle.

    Args:
        path: The MCAP file of a recording or an incident.

    Raises:
        RecordingFileError: The file is not a complete recording, or lacks inputs since
            the station's first cycle.
        StationError: The station cannot be built from the recorded configuration.
    """
    path = Path(path)
    inputs = read_inputs(path)
    if not inputs or not inputs[0].get("is_whole"):
        raise RecordingFileError(
            f"{path} cannot be run again: it does not have everything that was asked "
            "of the station since its first cycle.",
            remedy="Record earlier in the life of the station.",
        )
    (configuration,) = read_texts(path, "/configuration")
    values = json.loads(configuration)
    parameters = values.pop("parameters", {})
    config = load_config(values).model_copy(update={"parameters": parameters})
    clock = ManualClock()
    station = compose(config, clock).station
    return _Rerun(station, clock, inputs[1:]).compare(read_trajectory(path))


class _Rerun:
    """Steps a station, and repeats the recorded inputs."""

    def __init__(
        self, station: Station, clock: ManualClock, inputs: list[dict[str, object]]
    ) -> None:
        self._station = station
        self._clock = clock
        # The sort is stable: inputs of the same cycle stay in their order.
        self._inputs = deque(sorted(inputs, key=lambda one: one["after"]))  # type: ignore[arg-type, return-value]  # numbers, by JSON
        self._not_repeated: list[str] = []
        self._prepared: dict[int, list[Callable[[], None]]] = {}
        self._done: set[int] = set()
        self._plans: dict[float, list[Arguments]] = {}
        for one in self._inputs:
            if one["kind"] in PLANNED and one.get("planned_at") is not None:
                self._plans.setdefault(float(str(one["planned_at"])), []).append(one)
        # A switch runs cycles while it waits, and these cycles have inputs, too.
        station.manager.pump = self._advance

    def compare(self, recorded: Trajectory) -> RerunResult:
        """Run until the end of the recording, or until the first difference."""
        loop, done, first = self._station.loop, 0, 0
        if not len(recorded.cycle):
            return RerunResult(0, None, ())
        last = int(recorded.cycle[-1])
        rows = {int(cycle): row for row, cycle in enumerate(recorded.cycle)}
        while done < last:
            while loop.cycle < min(done + _BATCH, last):
                self._advance()
            snapshots, _ = self._station.snapshots.read_since(done)
            for one in snapshots:
                row = rows.get(one.cycle)
                if row is None:
                    continue
                first += 1
                found = _difference(recorded, row, one)
                if found is not None:
                    return RerunResult(first - 1, found, tuple(self._not_repeated))
            done = loop.cycle
        return RerunResult(first, None, tuple(self._not_repeated))

    def _advance(self) -> None:
        loop = self._station.loop
        while self._inputs and self._after(self._inputs[0]) <= loop.cycle:
            self._ask(self._inputs.popleft())
        self._plan_ahead()
        self._clock.advance(loop.period / loop.speed.real_time_factor)
        loop.step()

    def _plan_ahead(self) -> None:
        """Plan the inputs that the recorded station planned now and used later."""
        for one in self._plans.pop(self._station.loop.time, ()):
            if id(one) not in self._done:
                self._prepare(one)

    def _prepare(self, one: Arguments) -> None:
        ticket = self._station.motion.ticket()
        ticket.held = []
        try:
            carry_out_plan(self._station, str(one["kind"]), one, ticket)
        except StationError as error:
            self._refused(one, error)
        self._prepared[id(one)] = ticket.held

    def _hand_over(self, one: Arguments) -> None:
        """Submit a plan that the next cycle takes."""
        if id(one) not in self._prepared:
            planned_at = one.get("planned_at")
            if planned_at is not None and planned_at != self._station.loop.time:
                self._not_repeated.append(
                    f"Not repeated exactly: a {one['kind']} before cycle "
                    f"{self._after(one) + 1} was planned from a cycle that is not "
                    "known; from there on the motion may differ."
                )
            self._prepare(one)
        self._done.add(id(one))
        for deposit in self._prepared.pop(id(one)):
            deposit()

    @staticmethod
    def _after(one: Arguments) -> int:
        return int(one["after"])

    def _ask(self, one: Arguments) -> None:
        if one["kind"] in PLANNED:
            self._hand_over(one)
            return
        try:
            if one["kind"] == "set_point":
                self._let_no_time_pass(str(one["name"]))
            if carry_out(self._station, str(one["kind"]), one):
                return
        except StationError as error:
            self._refused(one, error)
            return
        what = one.get("what", one["kind"])
        self._not_repeated.append(
            f"Cannot be asked again: {what}, after cycle {one['after']}."
        )

    def _let_no_time_pass(self, name: str) -> None:
        """Stop the clock of set-points, which expire only where the recording says."""
        port = self._station.manager.get_controller(name).set_points
        if port is not None:
            port.clock = _STANDSTILL

    def _refused(self, one: Arguments, error: StationError) -> None:
        self._not_repeated.append(
            f"Refused now: {one['kind']} after cycle {one['after']}: {error}"
        )


def _difference(recorded: Trajectory, row: int, now: Any) -> Difference | None:  # noqa: ANN401 - Snapshot
    for quantity in ("position", "velocity", "effort"):
        before = getattr(recorded, quantity)[row].tolist()
        after = getattr(now, quantity)
        for joint, old, new in zip(recorded.names, before, after, strict=True):
            both_nan = old != old and new != new
            if old != new and not both_nan:
                return Difference(now.cycle, joint, quantity, old, new)
    return None
