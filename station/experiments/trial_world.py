"""A simulated station that runs one trial after the other.

A world is built once and reset between trials: model, gains, noise and time get their
initial values. So a trial gives the same numbers, bit for bit, in a world that has run
other trials before.
"""

import os
import platform
import time
from collections.abc import Mapping, Sequence
from typing import Self

import mujoco

from station.app.in_process import InProcessStation
from station.core.control.controller import ControllerState
from station.core.errors import StationError
from station.core.franka.arms import Arms
from station.experiments.disturbances import (
    CommandDelay,
    MeasurementNoise,
    Mechanics,
    world_of,
)
from station.hw.mujoco.world import Push as WorldPush
from station.trials.errors import ExperimentError
from station.trials.metrics import Counts, measure
from station.trials.parameters import Overrides, gains_under, sort_out
from station.trials.reference import Reference, make_reference
from station.trials.trace import Trace, TraceRecorder
from station.trials.trial import Script, Setup, Trial, TrialResult, digest_of
from station.wire.excitations import Push, Waypoints

_LOOK = 100
"""Cycles between two checks of the trial's progress. The ring of snapshots keeps 4096.
"""


class TrialWorld:
    """Runs the trials of one setup. Only one thread may use it.

    Args:
        setup: The configuration.

    Attributes:
        setup: As given.
        station: The station in which the trials run.
        begin_positions: Positions of the joints at the beginning, by name [rad or m].
        robot_digest: Digest of the robot's bodies and joints, which come from files
            outside of the setup; worlds with the same digest move alike.

    Raises:
        ExperimentError: The robot is not simulated with MuJoCo.
        StationError: The configuration cannot be used.
    """

    def __init__(self, setup: Setup) -> None:
        self.setup = setup
        self.station = InProcessStation(setup.config())
        facade = self.station.facade
        self._world = world_of(facade.loop.hw)
        model = self._world.model
        bodies = (model.body_mass, model.body_inertia, model.body_pos, model.jnt_range)
        self.robot_digest = digest_of("".join(v.tobytes().hex() for v in bodies))
        joints = self.station.joint_names
        self._mechanics = Mechanics(self._world, joints)
        self._delay = CommandDelay(facade.loop)
        self._noise = MeasurementNoise(facade.loop)
        self._gains = facade.tuning.all_gains()
        self.begin_positions = self.station.positions()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stop the robot."""
        self.station.close()

    def gains(self, controller: str) -> dict[str, float]:
        """Return the gains of a controller in the configuration.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
        """
        self._check_loaded(controller)
        return dict(self._gains.get(controller, {}))

    def gain_ranges(self, controller: str) -> dict[str, tuple[float, float]]:
        """Return the smallest and the largest allowed value of a controller's gains.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
        """
        schema = self.station.facade.tuning.gains(controller).schema
        return {name: (each.minimum, each.maximum) for name, each in schema.items()}

    def all_gains(self) -> dict[str, dict[str, float]]:
        """Return the gains of the configuration, by controller and name."""
        return {name: dict(values) for name, values in self._gains.items()}

    def model(self) -> mujoco.MjModel:
        """Return MuJoCo's model of the robot; changing it changes the world."""
        return self._world.model

    def data(self) -> mujoco.MjData:
        """Return MuJoCo's state of the robot, for reading only."""
        return self._world.data

    def joint_inertia(self, joint: str) -> float:
        """Return the inertia of a joint in the present pose [kg m^2 or kg]."""
        return self._world.joints([joint]).read_inertia()[0]

    def run(self, trial: Trial) -> TrialResult:
        """Run a trial and return its result; a refused trial counts as failed."""
        return self.record(trial)[0]

    def record(self, trial: Trial) -> tuple[TrialResult, Trace | None]:
        """Run a trial; return its result and every cycle of it.

        The trace is None when the trial was refused before it began.
        """
        began = time.perf_counter()
        trace, counts, reason = None, Counts(), None
        try:
            reference = self._begin(trial)
            trace, counts, reason = self._play(trial.script, reference)
        except StationError as error:
            reason = f"{error.message} {error.remedy}".strip()
        limits = self.station.facade.loop.hw.joint_limits()
        metrics = {} if trace is None else measure(trace, trial.script, limits, counts)
        result = TrialResult(
            trial.hash,
            "done" if reason is None else "failed",
            reason,
            metrics,
            time.perf_counter() - began,
            f"{platform.node()}:{os.getpid()}",
        )
        return result, trace

    def _begin(self, trial: Trial) -> Reference:
        """Reset the world, apply the trial's parameters, and start its controller.

        Raises:
            StationError: A name or value of the trial is not allowed.
        """
        station, facade, script = self.station, self.station.facade, trial.script
        wanted = sort_out(trial.parameters)
        self._check_loaded(script.controller)
        gains = self._wanted_gains(wanted)
        self.put_back()
        facade.tuning.set_many(gains)
        joints = station.joint_names
        self._mechanics.change(
            wanted.load,
            _by_joint(wanted.friction, joints),
            _by_joint(wanted.damping, joints),
        )
        self._delay.begin(wanted.delay)
        station.reset(script.begin)
        station.switch(start=[script.controller])
        # Compute the reference before noise begins, so that it starts at exact
        # positions.
        reference = make_reference(facade, script)
        self._noise.begin(wanted.position_noise, wanted.velocity_noise, trial.seed)
        return reference

    def put_back(self) -> None:
        """Bring the station into the initial state of every trial."""
        station, facade = self.station, self.station.facade
        self._noise.begin(0.0, 0.0, 0)
        self._delay.begin(0)
        running = [
            found.name
            for found in facade.manager.conditions()
            if found.state is ControllerState.RUNNING
        ]
        if running:
            station.switch(stop=running)
        self._mechanics.restore()
        station.reset()
        facade.robots.recover_all()
        # Controllers compute differences of station time, whose rounding depends on the
        # value of the time. No controller runs now that could see time go back.
        facade.loop.control_cycle.time = 0.0

    def gains_of(self, trial: Trial) -> dict[str, dict[str, float]]:
        """Return the gains that a trial changes, by controller and name.

        Raises:
            StationError: A name or value of the trial is not allowed.
        """
        wanted = self._wanted_gains(sort_out(trial.parameters))
        changed = {
            controller: {
                gain: value
                for gain, value in gains.items()
                if value != self._gains[controller][gain]
            }
            for controller, gains in wanted.items()
        }
        return {controller: gains for controller, gains in changed.items() if gains}

    def check(self, parameters: Mapping[str, float]) -> None:
        """Refuse parameters of joints, gains or controllers that the station lacks.

        Raises:
            StationError: A name or value is not allowed.
        """
        wanted = sort_out(parameters)
        self._wanted_gains(wanted)
        for joint in (*wanted.friction, *wanted.damping):
            if joint:
                self._mechanics.check_joint(joint)

    def _wanted_gains(self, wanted: Overrides) -> dict[str, dict[str, float]]:
        """Return the gains of all controllers under a trial's parameters.

        Raises:
            ControllerNotFoundError: A controller is not loaded.
            UnknownParameterError: No gain has that name or suffix.
        """
        for controller in (*wanted.scales, *wanted.gains):
            self._check_loaded(controller)
        return gains_under(wanted, self._gains)

    def _check_loaded(self, controller: str) -> None:
        """Refuse a controller that is not loaded; the error has the reason.

        Raises:
            StationError: The controller is not loaded; if its loading failed, that
                error.
        """
        not_loaded = self.station.not_loaded.get(controller)
        if not_loaded is not None:
            raise not_loaded
        self.station.facade.controller(controller)

    def _play(
        self, script: Script, reference: Reference
    ) -> tuple[Trace, Counts, str | None]:
        """Run the script; return its trace, counts, and the reason of an early end.

        Raises:
            StationError: The controller refuses a command although it runs.
        """
        station, facade = self.station, self.station.facade
        recorder = TraceRecorder(facade, script.controller)
        violations = facade.manager.command_violations[0]
        cycles = max(1, round(script.duration / facade.loop.period))
        pushes = _at_cycles(script, facade.loop.period, cycles)
        cycle, look, reason = 0, 0, None
        while cycle < cycles and reason is None:
            for push in pushes.get(cycle, ()):
                self._push(push)
            try:
                reference.command(cycle)
            except StationError:
                # A controller that has stopped since the last check refuses commands.
                reason = self._why_ended(script.controller)
                if reason is None:
                    raise
                recorder.take()
                break
            ahead = min(reference.quiet_from(cycle), cycles) - cycle
            later = [c - cycle for c in pushes if c > cycle]
            ahead = max(1, min([ahead, _LOOK, *later]))
            station.step(ahead)
            cycle += ahead
            if cycle >= min(look, cycles):
                look = cycle + _LOOK
                recorder.take()
                reason = self._why_ended(script.controller)
        refused = facade.manager.command_violations[0] - violations
        return recorder.trace(), Counts(recorder.reflexes, refused), reason

    def _push(self, push: Push) -> None:
        steps = max(1, round(push.lasts / self._world.timestep))
        self._world.push(WorldPush(push.link, push.force), steps)

    def _why_ended(self, controller: str) -> str | None:
        """Return the reason why the controller has stopped; None while it runs."""
        facade = self.station.facade
        if self._world.diverged_because is not None:
            return self._world.diverged_because
        conditions = {found.name: found for found in facade.manager.conditions()}
        status = conditions[controller]
        if status.state is ControllerState.RUNNING:
            return None
        errors = [
            error.description
            for report in Arms(facade.robots).reports()
            for error in report.errors
        ]
        found = status.fault or "; ".join(errors)
        return found or f"Controller '{controller}' is {status.state.value}."


def _by_joint(values: Mapping[str, float], joints: Sequence[str]) -> dict[str, float]:
    """Return the value of each joint; the value of "" is for all other joints."""
    common = {} if "" not in values else dict.fromkeys(joints, values[""])
    return common | {joint: value for joint, value in values.items() if joint}


def _at_cycles(script: Script, period: float, cycles: int) -> dict[int, list[Push]]:
    """Return the pushes of a script by the cycle in which they begin."""
    found: dict[int, list[Push]] = {}
    for push in script.pushes:
        cycle = round(push.at / period)
        if cycle < cycles:
            found.setdefault(cycle, []).append(push)
    return found


_WAY = 0.1
"""Largest step of a joint [rad or m]; a tenth of its range if that is less."""
_TIMES = (0.4, 0.8, 1.2, 1.5)
_SHARES = (2.0, 0.0, 1.0, 0.0)
_DURATION = 2.0


def default_script(world: TrialWorld, controller: str) -> Script:
    """Return a script of 2 s in which all joints move back and forth, and rest.

    Raises:
        ExperimentError: The controller commands no positions of joints.
        StationError: The controller is not loaded.
    """
    motions = small_motions(world, controller, _TIMES, _SHARES)
    if not motions:
        raise ExperimentError(
            f"Controller '{controller}' commands no positions of joints, so that it is "
            "not known what a motion of it would be.",
            remedy="Give a --script; docs/experiments.md lists its commands.",
        )
    return Script(controller=controller, duration=_DURATION, commands=motions)


def small_motions(
    world: TrialWorld, controller: str, times: Sequence[float], shares: Sequence[float]
) -> tuple[Waypoints, ...]:
    """Return a motion of each joint of a controller, away from the nearest limit.

    Args:
        world: World in which the controller is loaded.
        controller: Its name.
        times: Times at which the waypoints are reached [s], > 0 and increasing, shape
            (k,).
        shares: Waypoints as multiples of a step, shape (k,). The step is 0.1 rad or m,
            or a tenth of the joint's range if that is less.

    Returns:
        One motion per joint; none when the controller commands no positions of joints.

    Raises:
        StationError: The controller is not loaded.
    """
    world.gains(controller)  # refuses a controller that is not loaded
    found = world.station.facade.manager.get_controller(controller)
    joints = list(found.joint_names)
    positions = world.begin_positions
    if found.trajectories is None:
        elements = () if found.set_points is None else found.set_points.elements
        if not elements or any(
            e.unit not in {"rad", "m"} or e.name not in joints for e in elements
        ):
            return ()
    if any(joint not in positions for joint in joints):
        return ()
    limits = {r.joint: r.limits for r in world.station.facade.loop.hw.joint_limits()}
    motions = []
    for joint in joints:
        low = high = None
        if joint in limits:
            low, high = limits[joint].min_position, limits[joint].max_position
        way = _WAY
        if low is not None and high is not None:
            way = min(_WAY, 0.1 * (high - low))
            way = -way if positions[joint] > 0.5 * (low + high) else way
        values = tuple(share * way for share in shares)
        motions.append(Waypoints(joint=joint, times=tuple(times), values=values))
    return tuple(motions)
