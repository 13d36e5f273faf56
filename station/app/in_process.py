"""A station inside a program: the same robot, controllers and loop without sockets."""

import atexit
import logging
import math
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Self

from pydantic import ValidationError

from station.app.composition import compose
from station.app.panda_fetch import fetch_what_is_missing
from station.app.recording_start import describe
from station.app.twin import run_model
from station.client.errors import MotionError
from station.client.motion import in_the_way
from station.client.poses import Target, joint_positions, trajectory_goal
from station.client.samples import Samples
from station.config import StationConfig, load_config
from station.core.clock import ManualClock
from station.core.control.controller import ControllerState
from station.core.control.controller_manager import ControllerStatus
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    InvalidCommandError,
    RecordingFileError,
    is_number,
    show,
)
from station.core.loop.snapshot import Snapshot
from station.core.loop.stop_latch import StopState
from station.core.scheduling import realtime_interpreter
from station.hw.robot_loader import find_robot
from station.rehearsal.rehearsals import Rehearsals
from station.reports import Rehearsal
from station.wire import StreamFrame
from station.wire.rehearsal import RehearsalRequest
from station.wire.validation_words import explain

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pydantic import JsonValue

    from station.core.errors import StationError
    from station.core.facade.station import Station
    from station.records.recorder import Recorder

_LOGGER = logging.getLogger(__name__)
_TRAJECTORY = "/JointTrajectoryController"
_FINAL = {"succeeded", "aborted", "preempted"}
_DRAIN = 500
"""Cycles between two reads of a recorder; samples of arms are kept for 512 cycles."""
_BATCH = 1000
"""Cycles between two reads of the ring of snapshots, which keeps 4096."""


class InProcessStation:
    """A station without server and dashboard; `station.open` makes one.

    In a stepped station, time passes only in `step`, `run`, `move_to` and `collect`, as
    fast as the processor can. Every run is the same, bit for bit, because timeouts and
    watchdogs of controllers follow a virtual clock. In a threaded station, the control
    thread runs at its rate on the wall clock, and these methods wait.

    Methods raise errors of `station.core.errors`; a refused call changes nothing.

    Args:
        config: The station's YAML file, or the content of such a file; None takes the
            default, a simulated Panda. A configuration from `load_config` is used as it
            is: `controllers` and `settings` are ignored.
        controllers: Parameter files written for ROS, added to the controllers.
        settings: Single settings by dotted key, e.g. `{"station.rate": 500}`.
        threaded: Whether to run the control thread.

    Attributes:
        facade: The facade, for all other operations: loading, goals, services, the
            simulation, reports, the latched stop.
        not_loaded: Errors that kept controllers of the configuration from loading, by
            controller.
    """

    def __init__(
        self,
        config: Path | str | Mapping[str, object] | StationConfig | None = None,
        *,
        controllers: Sequence[Path | str] = (),
        settings: Mapping[str, object] | None = None,
        threaded: bool = False,
    ) -> None:
        if isinstance(config, StationConfig):
            loaded = config
        else:
            loaded = load_config(
                Path(config) if isinstance(config, str) else config,
                controller_files=[Path(file) for file in controllers],
                flags=settings,
            )
        self._config = loaded
        self._recorder: Recorder | None = None
        find_robot(loaded.robot.type)  # fail before a useless download
        fetch_what_is_missing(loaded.robot_parameters(), _LOGGER.warning)
        self._clock = None if threaded else ManualClock()
        composition = compose(loaded, self._clock)
        self.facade: Station = composition.station
        self.not_loaded: Mapping[str, StationError] = composition.not_loaded
        start, left_out = composition.sort_starts(loaded.start)
        for warning in (*composition.warnings(), *left_out):
            _LOGGER.warning("%s", warning)
        self._stack = ExitStack()
        if threaded:
            self._stack.enter_context(realtime_interpreter())
            # The stack closes in reverse order, so the loop stops before its robot
            # closes.
            self._stack.callback(self.facade.loop.hw.close)
            self._stack.callback(self.facade.loop.stop)
            self.facade.loop.start()
            atexit.register(self.close)  # for a program that leaves it open
        else:
            # Switches and recoveries that need cycles run them in virtual time.
            self.facade.manager.pump = self.step
            self.step()
        self.switch(start=start)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop all controllers and end the control thread."""
        atexit.unregister(self.close)
        # A station that is already stopped keeps the reason of its stop.
        if self.facade.loop.stop_latch.state is not StopState.STOPPED:
            self.facade.stop("the program ends")
        self._stack.close()

    @property
    def is_threaded(self) -> bool:
        """Return whether the control thread runs."""
        return self._clock is None

    @property
    def time(self) -> float:
        """Station time [s]."""
        return self.facade.loop.time

    @property
    def joint_names(self) -> list[str]:
        """The joints, in the order of all arrays."""
        return self.facade.joint_names

    def latest(self) -> Snapshot:
        """Return the state after the last cycle."""
        return self.facade.latest()

    def positions(self) -> dict[str, float]:
        """Return the positions of all joints by name [rad or m]."""
        return dict(zip(self.joint_names, self.latest().position, strict=True))

    def step(self, cycles: int = 1) -> None:
        """Run some cycles now.

        Args:
            cycles: Number of cycles, >= 0.

        Raises:
            LoopError: The control thread runs.
        """
        loop = self.facade.loop
        tick = loop.period / loop.speed.real_time_factor
        if self._recorder is None:
            loop.step(cycles, tick)
            return
        while cycles > 0:
            # Drain at the same cycles whatever the sizes of the steps, so that
            # recordings are equal.
            ahead = min(cycles, _DRAIN - loop.cycle % _DRAIN)
            loop.step(ahead, tick)
            cycles -= ahead
            if loop.cycle % _DRAIN == 0:
                self._recorder.drain()

    @contextmanager
    def record(
        self, folder: Path | str, name: str = "", note: str = ""
    ) -> "Iterator[Path]":
        """Record every cycle while the `with` block runs; yield the path of the file.

        The file is complete after the block. `station record rerun FILE` and the pytest
        fixture `rerun` can step it again if it is the station's first recording and
        begins within the first 4000 cycles.

        Args:
            folder: Folder of the recording.
            name: Name of the file: letters, digits, `_`, `.` and `-`.
            note: Note to store in the recording.

        Raises:
            RecordingRefusedError: A recording runs already, or its name is not allowed.
            RecordingFileError: The file could not be written to its end.
        """
        from station.records.record_store import FAILED, RecordStore
        from station.records.recorder import Recorder

        store = RecordStore(Path(folder))
        if self._recorder is None:
            texts = describe(self.facade, self._config)
            self._recorder = Recorder(self.facade, store, texts=texts)
            self._stack.callback(self._recorder.close)
            if self.is_threaded:
                self._recorder.start_thread()
        self._recorder.store = store
        begun = self._recorder.start(name, note)
        try:
            yield store.file(begun.identifier)
        finally:
            last = self._recorder.end()
        if last.state == FAILED:
            raise RecordingFileError(
                f"The recording {last.identifier} failed: {last.error}",
                remedy="Make room, and record again.",
            )

    def run(self, seconds: float) -> None:
        """Let station time pass: run its cycles, or wait for the control thread.

        Args:
            seconds: Station time to pass [s], >= 0; rounded to whole cycles.

        Raises:
            InvalidCommandError: `seconds` is no finite number, or below 0.
            LoopError: The control thread died.
        """
        _check_time(seconds)
        loop = self.facade.loop
        if not self.is_threaded:
            self.step(round(seconds / loop.period))
            return
        # Subtract half a period, because station time is a sum of periods, and rounding
        # must not add a cycle.
        end = loop.time + seconds - 0.5 * loop.period
        while loop.time < end:
            loop.check_alive()
            left = (end - loop.time) / loop.speed.real_time_factor
            # Sleep briefly, because the simulation may be paused, slowed down, or end
            # meanwhile.
            loop.clock.sleep_until(loop.clock.now() + min(left, 0.1))

    def switch(self, start: Sequence[str] = (), stop: Sequence[str] = ()) -> None:
        """Start and stop controllers in one cycle.

        Raises:
            SwitchRefusedError: The switch is not possible; nothing changed.
        """
        self.facade.switch_controllers(SwitchRequest(start=start, stop=stop))

    def command(
        self, name: str, values: Sequence[float], timeout: float | None = None
    ) -> None:
        """Give a running controller a set-point.

        Args:
            name: The controller.
            values: One number per element of its set-points.
            timeout: How long it is valid [s], 0 for ever; None for the controller's own
                timeout.
        """
        self.facade.motion.set_command(name, values, timeout=timeout)

    def gains(self, name: str) -> Mapping[str, float]:
        """Return the gains of a controller by name."""
        return self.facade.tuning.gains(name).values

    def set_gains(self, name: str, values: Mapping[str, float]) -> None:
        """Change gains of a controller between two cycles; the others stay."""
        self.facade.tuning.set_gains(name, values)

    def rehearse(
        self, steps: Sequence[Mapping[str, object]], seconds: float | None = None
    ) -> Rehearsal:
        """Forecast the effect of commands in a copy of this process; nothing moves.

        Args:
            steps: The commands, as `POST /rehearse` takes them.
            seconds: How long the rehearsal lasts [s], above 0 and at most 60; None ends
                it when all goals have ended and the joints stand still, after 30 s at
                the latest.

        Raises:
            InvalidCommandError: A step or `seconds` is not what `POST /rehearse` takes.
            RehearsalError: The robot is real and moves or has no model, or this machine
                cannot copy the process.
        """
        asked = {"steps": list(steps), "seconds": seconds}
        try:
            request = RehearsalRequest.model_validate(asked, strict=False)
        except ValidationError as error:
            first = error.errors()[0]
            field = "/".join(str(part) for part in first["loc"])
            raise InvalidCommandError(
                f"{field}: {explain(first['type'], first.get('ctx', {}))}.",
                remedy="Give the steps as `POST /rehearse` takes them.",
            ) from error
        run = partial(run_model, self._config)
        return Rehearsals(self.facade, run_model=run).rehearse(
            [step.as_input() for step in request.steps], request.seconds
        )

    def reset(self, positions: Mapping[str, float] | None = None) -> None:
        """Put the simulated world back to its start; see `SimulationControl.reset`.

        A stepped station then runs one cycle, as when it opens, to read the joints.
        """
        self.facade.simulation.reset(positions)
        if not self.is_threaded:
            self.step()

    def move_to(self, target: Target, *, duration: float | None = None) -> None:
        """Move joints by a trajectory controller and return when they have arrived.

        If no trajectory controller runs, one is started, and controllers that claim its
        joints are stopped in the same cycle.

        Args:
            target: Name of a pose (`ready`, `stretched`), one position per joint, or
                positions by joint [rad or m]; other joints stay.
            duration: Duration of the motion [s]; None for a slow motion.

        Raises:
            MotionError: The joints did not arrive; the message has the reason.
        """
        name = self._trajectory_controller()
        motion = self.facade.motion
        names = self.facade.manager.get_controller(name).joint_names
        here = list(motion.query_state(name).position)
        values = joint_positions(target, names, here)
        goal: Mapping[str, JsonValue] = trajectory_goal(names, here, values, duration)
        goal_id = motion.submit_goal(name, goal).identifier
        while motion.goal(name, goal_id).status.value not in _FINAL:
            self.run(0.01)
        ended = motion.goal(name, goal_id)
        if ended.status.value != "succeeded":
            why = ended.result.message if ended.result else ""
            raise MotionError(f"The goal of '{name}' was {ended.status.value}. {why}")

    def collect(self, seconds: float, controller: str | None = None) -> Samples:
        """Let time pass, and return every cycle of this time as NumPy arrays.

        Args:
            seconds: Station time to pass [s], > 0.
            controller: Controller whose samples to return: `desired`, `actual`, `error`
                and `output`. None returns `position`, `velocity` and `effort` of the
                joints.

        Raises:
            InvalidCommandError: `seconds` is no finite number, or below 0.
        """
        _check_time(seconds)
        samples = Samples(controller or "joint_states")
        cycle, left = self.facade.loop.cycle, seconds
        while left > 0.0:
            part = min(left, _BATCH * self.facade.loop.period)
            self.run(part)
            left -= part
            snapshots, lost = self.facade.snapshots.read_since(cycle)
            cycle = snapshots[-1].cycle if snapshots else cycle
            samples.add(self._batch(snapshots, lost, controller))
        return samples

    def _batch(
        self, snapshots: Sequence[Snapshot], lost: int, controller: str | None
    ) -> StreamFrame:
        names, samples = self.joint_names, []
        for one in snapshots:
            if controller is None:
                samples.append({
                    "stamp": one.stamp,
                    "position": _numbers(one.position),
                    "velocity": _numbers(one.velocity),
                    "effort": _numbers(one.effort),
                })
            elif controller in one.samples:
                sample = one.samples[controller]._asdict()
                samples.append({k: _numbers(v) for k, v in sample.items()})
        if controller is not None:
            names = list(self.facade.manager.get_controller(controller).joint_names)
        return StreamFrame.model_construct(
            topic=controller or "joint_states",
            stamp=self.time,
            data={"name": names, "samples": samples, "lost": lost},
        )

    def _trajectory_controller(self) -> str:
        """Return a running trajectory controller; start one if none runs.

        Raises:
            MotionError: No trajectory controller is loaded.
        """
        found = [c for c in self.facade.controllers() if c.type.endswith(_TRAJECTORY)]
        if not found:
            why = " ".join(str(error) for error in self.not_loaded.values())
            raise MotionError(f"No JointTrajectoryController is loaded. {why}".rstrip())
        found.sort(
            key=lambda c: (
                # Prefer a running controller, which needs no switch.
                c.state is not ControllerState.RUNNING,
                not c.type.startswith("position_"),
            )
        )
        chosen = found[0]
        running = {
            c.name: _claims(c)
            for c in self.facade.controllers()
            if c.state is ControllerState.RUNNING and c.name != chosen.name
        }
        is_running = chosen.state is ControllerState.RUNNING
        holders = in_the_way(_claims(chosen), running)
        if holders or not is_running:
            self.switch(start=[] if is_running else [chosen.name], stop=holders)
        return chosen.name


def _check_time(seconds: float) -> None:
    """Refuse a time that cannot pass.

    Raises:
        InvalidCommandError: It is no finite number, or below 0.
    """
    if not is_number(seconds) or not 0.0 <= seconds < math.inf:
        raise InvalidCommandError(
            f"{show(seconds)} s cannot pass; it must be a finite number from 0.",
            remedy="Give the station time to pass in seconds.",
        )


def _claims(controller: ControllerStatus) -> list[str]:
    return [name for claim in controller.claimed_resources for name in claim.resources]


def open_station(
    config: Path | str | Mapping[str, object] | None = None,
    *,
    controllers: Sequence[Path | str] = (),
    settings: Mapping[str, object] | None = None,
    threaded: bool = False,
) -> InProcessStation:
    """Open a station inside this program; see `InProcessStation`."""
    return InProcessStation(
        config, controllers=controllers, settings=settings, threaded=threaded
    )


def _numbers(values: object) -> object:
    """Return numbers as a list, None if not finite; return other values unchanged."""
    if isinstance(values, list | tuple):
        # Like the API, which sends null because JSON has no NaN.
        return [v if math.isfinite(v) else None for v in values]
    return values
