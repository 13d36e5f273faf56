"""Carry steps out in a copy of the station, cycle after cycle, and judge the motion."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from station.core.clock import Clock, ManualClock
from station.core.control.controller import ControllerState
from station.core.errors import InvalidCommandError, StationError
from station.core.facade.repeated_inputs import carry_out, carry_out_plan
from station.core.franka.franka_services import FrankaServices
from station.core.geometry.guard import GUARD_REFLEX
from station.core.ports.goal import Goal, GoalStatus
from station.rehearsal.certificates import Conditions
from station.reports import (
    ClearanceForecast,
    ContactForecast,
    JointForecast,
    Rehearsal,
    RehearsalCause,
    RehearsalFault,
    RehearsalOutcome,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from station.core.facade.station import Station

LONGEST = 30.0
"""Longest rehearsal whose length is not given [s]."""
AT_REST = 5e-4
"""Joints that move by no more than this in `REST_CYCLES` stand still [rad or m].
Measured speeds cannot tell this, because their noise is 0.01 rad/s."""
REST_CYCLES = 100
_CLAMP_CYCLES = 20
"""Cycles between two checks of the commands that limits have cut off; a check takes as
long as a cycle."""
_NEAR_CYCLES = 20
"""Cycles between two searches for near bodies; a search takes as long as a cycle."""
_BATCH = 250
"""Cycles between two reads of the ring of snapshots, and between signs of progress."""
_ROWS = 200

Plans = Mapping[str, Callable[[Mapping[str, Any]], Mapping[str, Any]]]
"""Functions, by kind, that turn a step of a kind unknown to the core into an input."""


@dataclass(frozen=True, slots=True)
class Script:
    """The steps of a rehearsal.

    Attributes:
        steps: Inputs with `kind`, their arguments, and `at`, the time at which they
            are carried out [s since the beginning].
        seconds: How long it lasts [s]; None ends it when the joints stand still.
    """

    steps: Sequence[Mapping[str, Any]]
    seconds: float | None = None


@dataclass(frozen=True, slots=True)
class Forecast:
    """The result of a rehearsal in a copy of the station.

    Attributes:
        rehearsal: The report.
        conditions: State of the station at its beginning.
        positions: Positions of all joints after every cycle [rad or m], shape (k, n).
        is_whole: Whether the motion ended: no goal and no trajectory goes on, and the
            joints stood still in the last `REST_CYCLES` cycles.
    """

    rehearsal: Rehearsal
    conditions: Conditions
    positions: "NDArray[np.float64]"
    is_whole: bool


def run_ahead(
    station: "Station", script: Script, plans: Plans, tell: Callable[[], None]
) -> Forecast | None:
    """Carry out a script in this process, which is a copy of the station's.

    Args:
        station: The station; it cannot be used afterwards.
        script: Commands to carry out.
        plans: Functions that turn steps of further kinds into inputs, by kind.
        tell: Called after each piece of work.

    Returns:
        The forecast; None if the copy was made in the middle of a cycle.
    """
    if not station.loop.go_on_without_thread():
        return None
    return _RunAhead(station, script, plans, tell).run()


@dataclass(slots=True)
class _Seen:
    """Contacts, clamped commands and near pairs that were seen so far."""

    contacts: dict[tuple[str, str], tuple[int, float]] = field(default_factory=dict)
    clamps: dict[str, tuple[int, int]] = field(default_factory=dict)
    """Number of commands that were cut off, and cycle of the first one, by joint."""
    near: dict[str, ClearanceForecast] = field(default_factory=dict)
    """The pair that came nearest, by arm; solid bodies have an empty name for the arm.
    """


class _RunAhead:
    def __init__(
        self,
        station: "Station",
        script: Script,
        plans: Plans,
        tell: Callable[[], None],
    ) -> None:
        self._station = station
        self._loop = station.loop
        self._plans = plans
        self._tell = tell
        self._clock = _stand_still(station.loop.clock)
        self._tick = self._loop.period / self._loop.speed.real_time_factor
        self._conditions = Conditions.of(station)
        self._steps = sorted(script.steps, key=lambda step: float(step["at"]))
        self._done = 0
        self._seconds = script.seconds
        self._begin = self._loop.cycle
        self._time = self._loop.time
        self._world = self._loop.hw.simulated_world()
        self._touching = self._pairs()
        world = self._world
        self._nearest = (lambda: None) if world is None else world.distances()
        self._clamped = self._clamp_counts()
        self._seen = _Seen()
        self._goals: list[Goal] = []
        self._until = 0.0
        self._gate = station.manager.controller_update.gate
        self._running = self._gate.running
        self._rows: list[NDArray[np.float64]] = []
        self._taken = self._begin
        self._error: RehearsalFault | None = None
        # A switch runs cycles while it waits, and these must be checked, too.
        station.manager.pump = self._advance

    def run(self) -> Forecast:
        """Run cycles until the end, or until the first error."""
        while self._error is None and not self._is_over():
            self._carry_out_due()
            if self._error is None:
                self._advance()
        self._take_rows()
        self._note_clamps()
        states = (
            np.concatenate(self._rows)
            if self._rows
            else np.zeros((0, 3, len(self._station.joint_names)))
        )
        has_rested = len(states) >= REST_CYCLES and _rest(states[-REST_CYCLES:])
        return Forecast(
            self._report(states),
            self._conditions,
            states[:, 0].copy(),
            has_rested and self._has_ended(),
        )

    @property
    def _elapsed(self) -> float:
        return self._loop.time - self._time

    def _is_over(self) -> bool:
        left = (self._seconds or LONGEST) - self._elapsed
        if left < 0.5 * self._loop.period:
            return True
        cycles = self._loop.cycle - self._begin
        if self._seconds is not None or cycles % REST_CYCLES or not cycles:
            return False
        return self._done == len(self._steps) and self._has_ended() and self._rests()

    def _has_ended(self) -> bool:
        # A trajectory may wait before it moves: joints that rest do not tell its end.
        return self._loop.time >= self._until and all(
            goal.is_final() for goal in self._goals
        )

    def _rests(self) -> bool:
        rows = self._station.snapshots.rows_since(self._loop.cycle - REST_CYCLES)
        return _rest(rows.states_of_joints())

    def _carry_out_due(self) -> None:
        while self._done < len(self._steps) and self._error is None:
            step = self._steps[self._done]
            if float(step["at"]) > self._elapsed + 0.5 * self._loop.period:
                return
            try:
                self._carry_out(step)
            except StationError as error:
                text = f"{error} {error.remedy}".rstrip()
                self._note(RehearsalCause.REFUSED, "", error.code, text)
            self._done += 1

    def _carry_out(self, step: Mapping[str, Any]) -> None:
        kind = str(step["kind"])
        if kind in self._plans:
            step = self._plans[kind](step)
            kind = str(step["kind"])
        if carry_out_plan(self._station, kind, step):
            if kind == "goal":
                self._goals.append(self._station.motion.goals(step["name"])[-1])
            else:
                end = _end_of_trajectory(step["request"], self._loop.time)
                self._until = max(self._until, end)
        elif not carry_out(self._station, kind, step):
            raise InvalidCommandError(
                f"A step of the kind '{kind}' cannot be rehearsed.",
                remedy="Rehearse set-points, goals, trajectories, switches and gains.",
            )

    def _advance(self) -> None:
        if isinstance(self._loop.clock, ManualClock):
            self._loop.step(1, self._tick)
        else:
            self._clock.advance(self._tick)
            self._loop.step()
        self._look()
        if (self._loop.cycle - self._begin) % _BATCH == 0:
            self._take_rows()
            self._tell()

    def _look(self) -> None:
        """Note contacts, margins and the first error of this cycle."""
        if self._world is not None:
            self._note_contacts()
        self._note_clearances()
        if (self._loop.cycle - self._begin) % _CLAMP_CYCLES == 0:
            self._note_clamps()
        if self._error is not None:
            return
        latch = self._loop.stop_latch
        if latch.cycle == self._loop.cycle and latch.cycle > self._begin:
            self._note(RehearsalCause.STOP, "", "stopped", latch.reason)
            return
        for one in self._running:
            has_stopped = one.controller.state is not ControllerState.RUNNING
            if has_stopped and one.fault is not None and self._error is None:
                self._note_fault(one.info.name, str(one.fault))
        self._running = self._gate.running
        # Check goals after faults: a robot that ends a motion also ends the goal.
        for goal in self._goals:
            if goal.status is GoalStatus.ABORTED and self._error is None:
                result = goal.result
                text = "" if result is None else result.message
                where = "" if result is None else str(result.details.get("joint", ""))
                self._note(RehearsalCause.TOLERANCE, where, "goal_aborted", text)

    def _note_fault(self, controller: str, fault: str) -> None:
        """Note the end of a controller, by an error of the robot or its own fault."""
        robots = self._station.robots
        for arm_id in robots.names(FrankaServices):
            kind: type[FrankaServices] = FrankaServices  # type: ignore[type-abstract]
            arm = robots.get(arm_id, kind)
            # The scene guard has ended the motion in place of the arm, which has no
            # error then.
            if GUARD_REFLEX in fault and f"'{arm_id}'" in fault:
                self._note(RehearsalCause.REFLEX, arm_id, GUARD_REFLEX, fault)
                return
            for error in () if arm is None else arm.errors():
                is_felt = error.name.endswith("_reflex")
                cause = RehearsalCause.REFLEX if is_felt else RehearsalCause.LIMIT
                where = f"{arm_id}_{error.where}" if error.where else arm_id
                self._note(cause, where, error.name, error.description)
                return
        self._note(RehearsalCause.FAULT, controller, "controller_fault", fault)

    def _note(self, cause: RehearsalCause, where: str, code: str, text: str) -> None:
        touching = sorted(self._pairs() - self._touching)
        self._error = RehearsalFault(
            cause,
            self._loop.cycle,
            self._elapsed,
            where,
            touching,
            code,
            text,
            max(0, min(self._done, len(self._steps) - 1)),
        )

    def _pairs(self) -> set[tuple[str, str]]:
        world = self._world
        return set() if world is None else {one.bodies for one in world.contacts()}

    def _note_contacts(self) -> None:
        if self._world is None:
            return
        for contact in self._world.contacts():
            force = float(np.linalg.norm(contact.force))
            cycle, most = self._seen.contacts.get(
                contact.bodies, (self._loop.cycle, 0.0)
            )
            self._seen.contacts[contact.bodies] = (cycle, max(most, force))

    def _note_clearances(self) -> None:
        cycle, near = self._loop.cycle, self._seen.near
        for pair in self._station.surroundings.clearances():
            before = near.get(pair.arm)
            gap = pair.distance - pair.margin
            if before is None or gap < before.distance - (before.margin or 0.0):
                near[pair.arm] = ClearanceForecast(
                    (pair.link, pair.object), cycle, pair.distance, pair.margin
                )
        if (cycle - self._begin) % _NEAR_CYCLES:
            return
        found = self._nearest()
        if found is not None and ("" not in near or found[2] < near[""].distance):
            near[""] = ClearanceForecast(found[:2], cycle, found[2], None)

    def _clamp_counts(self) -> dict[tuple[str, str], int]:
        return {
            (one.last.joint, one.hardware_interface): one.count
            for one in self._loop.hw.clamps()
        }

    def _note_clamps(self) -> None:
        for one in self._loop.hw.clamps():
            key = (one.last.joint, one.hardware_interface)
            new = one.count - self._clamped.get(key, 0)
            if new > 0:
                count, first = self._seen.clamps.get(key[0], (0, self._loop.cycle))
                self._seen.clamps[key[0]] = (count + new, first)
                self._clamped[key] = one.count

    def _take_rows(self) -> None:
        if self._loop.cycle > self._taken:
            rows = self._station.snapshots.rows_since(self._taken)
            self._rows.append(rows.states_of_joints())
            self._taken = self._loop.cycle

    def _outcome(self) -> RehearsalOutcome:
        if self._error is not None:
            is_refused = self._error.cause is RehearsalCause.REFUSED
            return RehearsalOutcome.REFUSED if is_refused else RehearsalOutcome.FAILED
        if self._done < len(self._steps) or not self._has_ended():
            return RehearsalOutcome.UNFINISHED
        return RehearsalOutcome.COMPLETED

    def _report(self, states: "NDArray[np.float64]") -> Rehearsal:
        count = len(states)
        chosen = (
            np.linspace(0, max(count - 1, 0), min(_ROWS, count)).round().astype(int)
        )
        return Rehearsal(
            outcome=self._outcome(),
            error=self._error,
            is_at_rest=_rest(states[-REST_CYCLES:]),
            begin_cycle=self._begin + 1,
            cycles=count,
            duration=self._elapsed,
            wall_time=0.0,
            joints=self._joints(states),
            contacts=[
                ContactForecast(bodies, *found)
                for bodies, found in self._seen.contacts.items()
            ],
            clearances=[one for _, one in sorted(self._seen.near.items())],
            times=((chosen + 1) * self._loop.period).tolist(),
            positions=states[chosen, 0].tolist(),
            digest=digest_of(states),
        )

    def _joints(self, states: "NDArray[np.float64]") -> list[JointForecast]:
        reports = {one.joint: one.limits for one in self._loop.hw.joint_limits()}
        found = []
        for i, joint in enumerate(self._station.joint_names):
            q, dq, effort = (states[:, k, i] for k in range(3))
            limits = reports.get(joint)
            low = None if limits is None else limits.min_position
            high = None if limits is None else limits.max_position
            margins = [] if low is None else [q - low]
            margins += [] if high is None else [high - q]
            speed, torque = np.abs(dq).max(initial=0.0), np.abs(effort).max(initial=0.0)
            count, first = self._seen.clamps.get(joint, (0, None))
            found.append(
                JointForecast(
                    joint,
                    _finite(q[-1]) if len(q) else None,
                    _finite(np.min(margins)) if margins and len(q) else None,
                    _finite(speed),
                    _left(speed, None if limits is None else limits.max_velocity),
                    _finite(torque),
                    _left(torque, None if limits is None else limits.max_effort),
                    count,
                    first,
                )
            )
        return found


def _end_of_trajectory(message: Mapping[str, Any], now: float) -> float:
    """Return the station time at which a trajectory that was accepted now ends [s]."""
    stamps = message.get("stamp"), message.get("header", {}).get("stamp")
    points = message.get("points") or [{}]
    begin = max(now, *(stamp or 0.0 for stamp in stamps))
    return begin + float(points[-1].get("time_from_start", 0.0))


def digest_of(states: "NDArray[np.float64]") -> str:
    """Return the SHA-256 of positions, velocities and efforts.

    Args:
        states: Joint states of every cycle, as `Rows.states_of_joints` returns them,
            shape (k, 3, n).
    """
    return hashlib.sha256(
        np.ascontiguousarray(states, dtype="<f8").tobytes()
    ).hexdigest()


def _stand_still(clock: Clock) -> ManualClock:
    """Let a clock stand still between cycles; return the clock that advances it."""
    if isinstance(clock, ManualClock):
        return clock
    manual = ManualClock(clock.now())
    # Controllers, ports and switches hold this clock object, so change its methods.
    for name in ("now", "sleep_until", "wait_for"):
        setattr(clock, name, getattr(manual, name))
    return manual


def _rest(states: "NDArray[np.float64]") -> bool:
    """Return whether the joints stand still in these cycles, shape (k, 3, n)."""
    if not len(states):
        return True
    return float(np.max(np.ptp(states[:, 0], axis=0), initial=0.0)) < AT_REST


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _left(value: float, limit: float | None) -> float | None:
    return None if not limit else _finite(1.0 - float(value) / limit)
