"""The clients of a station's stores, on its disk or in its memory."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Literal

from station import wire
from station.client.connection import AsyncConnection, Query, segment
from station.wire.controllers import GainsOfControllersPatch
from station.wire.excitations import BenchResponse, BenchRun, BenchRuns, PartRequest
from station.wire.experiments import (
    Experiment,
    ExperimentApplyRequest,
    ExperimentPreview,
    ExperimentResponse,
    ExperimentResponses,
    Experiments,
    ExperimentSummary,
    ExperimentTrial,
    ExperimentTrials,
)
from station.wire.lessons import (
    Lesson,
    LessonBeginRequest,
    LessonCheckRequest,
    LessonResult,
    Lessons,
)

_RECORDINGS, _INCIDENTS = "/recordings", "/incidents"
_BENCH_RUNS, _LESSONS = "/bench-runs", "/lessons"
_GAIN_SETS, _WAYPOINT_PATHS = "/gain-sets", "/waypoint-paths"
_PLOT_LAYOUTS, _SCENES = "/plot-layouts", "/scenes"
_EXPERIMENTS, _PLAYBACK = "/experiments", "/playback"
_PERIOD = 0.5
"""Time between two looks at an experiment that runs [s]."""
_CHECKING = 60.0
"""How much longer than usual the start of an experiment may take [s]."""


class _AsyncFiles:
    """Common part of recordings and incidents.

    Args:
        connection: The connection to the station.
        path: Where they are.
    """

    def __init__(self, connection: AsyncConnection, path: str) -> None:
        self._connection = connection
        self._path = path

    async def list(self) -> list[wire.Recording]:
        """Return all, the oldest first."""
        return (await self._connection.get(self._path, wire.Recordings)).recordings

    async def get(self, identifier: str) -> wire.Recording:
        """Return the description of one."""
        return await self._connection.get(self._of(identifier), wire.Recording)

    async def trajectory(self, identifier: str, rate: float = 30.0) -> wire.Trajectory:
        """Return the joint positions of one that has ended.

        Args:
            identifier: Which one.
            rate: Cycles per second of station time [Hz].
        """
        path = f"{self._of(identifier)}/trajectory"
        return await self._connection.get(path, wire.Trajectory, {"rate": repr(rate)})

    async def download(self, identifier: str, target: Path | str) -> Path:
        """Write the MCAP file of one that has ended to a new file; return its path.

        Args:
            identifier: Which one.
            target: The file to be; it is not there yet.

        Raises:
            FileExistsError: There is such a file.
        """
        target = Path(target)
        await self._connection.download(f"{self._of(identifier)}/file", target)
        return target

    async def download_table(
        self,
        identifier: str,
        target: Path | str,
        *,
        channels: Iterable[str] = (),
        joints: Iterable[str] = (),
        rate: float | None = None,
    ) -> Path:
        """Write one that has ended as CSV to a new file; return its path.

        Args:
            identifier: Which one.
            target: The file to be; it is not there yet.
            channels: Channels, or channels with a field, e.g. `joint_states/position`;
                all when there is none.
            joints: Joints, or other elements with a name; all when there is none.
            rate: Rows per second of station time [Hz], > 0; every cycle when None.

        Raises:
            FileExistsError: There is such a file.
        """
        target = Path(target)
        query: Query = {"channels": [*channels], "joints": [*joints]}
        if rate is not None:
            query = {**query, "rate": repr(rate)}
        await self._connection.download(f"{self._of(identifier)}/table", target, query)
        return target

    async def events(self, identifier: str) -> Sequence[wire.RecordedEvent]:
        """Return the events of one that has ended, with the notes on it."""
        path = f"{self._of(identifier)}/events"
        return (await self._connection.get(path, wire.RecordedEvents)).events

    async def add_note(
        self, identifier: str, text: str, time: float, until: float | None = None
    ) -> wire.RecordedEvent:
        """Write a note into one that has ended; it becomes an event of the file.

        Args:
            identifier: Which one.
            text: The note.
            time: Station time of the moment, or of the begin of the range [s].
            until: Station time of the end of the range [s]; None for a moment.
        """
        request = wire.NoteRequest(text=text, time=time, until=until)
        path = f"{self._of(identifier)}/notes"
        return await self._connection.send("POST", path, wire.RecordedEvent, request)

    async def bench(self, identifier: str, part: PartRequest) -> BenchResponse:
        """Read a part of one that has ended as a test of a joint, and keep the run.

        Args:
            identifier: Which one.
            part: Controller, joint, kind of the test, begin and end.
        """
        path = f"{self._of(identifier)}/bench"
        return await self._connection.send("POST", path, BenchResponse, part)

    def _of(self, identifier: str) -> str:
        return _below(self._path, identifier)


class AsyncRecordingsClient(_AsyncFiles):
    """Recordings of every cycle on the station's disk: `client.recordings`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        super().__init__(connection, _RECORDINGS)

    async def start(self, name: str = "", note: str = "") -> wire.Recording:
        """Begin to record with the next cycle; one recording runs at a time.

        Args:
            name: Up to 80 letters, digits, `_`, `.` and `-`.
            note: For the record.
        """
        request = wire.RecordingRequest(name=name, note=note)
        return await self._connection.send("POST", self._path, wire.Recording, request)

    async def stop(self, identifier: str | None = None) -> wire.Recording:
        """End a recording; its file is whole then.

        Args:
            identifier: Which one; the one that runs when None.

        Raises:
            LookupError: None runs.
        """
        if identifier is None:
            running = [r for r in await self.list() if r.state == "recording"]
            if not running:
                raise LookupError("Nothing is being recorded.")
            identifier = running[-1].identifier
        path = f"{self._of(identifier)}/stop"
        return await self._connection.send("POST", path, wire.Recording)

    async def delete(self, identifier: str) -> wire.Recording:
        """Delete a recording that does not run; return its description."""
        return await self._connection.send(
            "DELETE", self._of(identifier), wire.Recording
        )


class AsyncIncidentsClient(_AsyncFiles):
    """Recordings around stops, reflexes and faults: `client.incidents`.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        super().__init__(connection, _INCIDENTS)


class AsyncBenchRunsClient:
    """Runs of the bench that the station keeps: `client.bench_runs`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def list(self) -> list[BenchRun]:
        """Return the runs with their figures, the oldest first."""
        return (await self._connection.get(_BENCH_RUNS, BenchRuns)).runs

    async def get(self, name: str) -> BenchResponse:
        """Return a run with its curves."""
        return await self._connection.get(_below(_BENCH_RUNS, name), BenchResponse)

    async def delete(self, name: str) -> BenchResponse:
        """Delete a run; return its last content."""
        path = _below(_BENCH_RUNS, name)
        return await self._connection.send("DELETE", path, BenchResponse)


class AsyncLessonsClient:
    """Exercises that the station checks on the student's own run: `client.lessons`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def list(self, person: str = "") -> Lessons:
        """Return the lessons in their order, with the progress of a person."""
        return await self._connection.get(_LESSONS, Lessons, {"person": person})

    async def begin(self, name: str, person: str = "") -> Lesson:
        """Begin a lesson: the station watches what the robot does from now on."""
        path, request = (
            f"{_below(_LESSONS, name)}/begin",
            LessonBeginRequest(person=person),
        )
        return await self._connection.send("POST", path, Lesson, request)

    async def check(
        self, name: str, person: str = "", answers: Mapping[str, float] | None = None
    ) -> LessonResult:
        """Check what was done since the lesson was begun.

        Args:
            name: The lesson.
            person: Whose progress is kept; the bearer of the token when empty.
            answers: Worked-out numbers by name, in the units of the lesson.
        """
        request = LessonCheckRequest(person=person, answers=dict(answers or {}))
        path = f"{_below(_LESSONS, name)}/check"
        return await self._connection.send("POST", path, LessonResult, request)


class AsyncGainSetsClient:
    """Named sets of gains on the station's disk: `client.gain_sets`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def names(self) -> list[str]:
        """Return the names of the saved sets."""
        return (await self._connection.get(_GAIN_SETS, wire.GainSets)).gain_sets

    async def get(self, name: str) -> wire.GainSet:
        """Return a set, and where it differs from the gains in force."""
        return await self._connection.get(_below(_GAIN_SETS, name), wire.GainSet)

    async def save(
        self, name: str, controllers: Sequence[str] | None = None
    ) -> wire.GainSet:
        """Save the gains in force under a name; a set of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            controllers: Controllers; all loaded controllers when None.
        """
        request = _chosen(controllers)
        return await self._connection.send(
            "PUT", _below(_GAIN_SETS, name), wire.GainSet, request
        )

    async def delete(self, name: str) -> wire.GainSet:
        """Delete a set; return its last content."""
        return await self._connection.send(
            "DELETE", _below(_GAIN_SETS, name), wire.GainSet
        )

    async def apply(
        self, name: str, controllers: Sequence[str] | None = None
    ) -> Mapping[str, wire.GainsChange]:
        """Put a set into force in one cycle; return the change of each controller.

        Args:
            name: The set.
            controllers: Controllers; all controllers of the set when None.
        """
        path, request = f"{_below(_GAIN_SETS, name)}/apply", _chosen(controllers)
        answer = await self._connection.send("POST", path, wire.GainsChanges, request)
        return answer.changes

    async def set_gains(
        self,
        changes: Mapping[str, Mapping[str, float]],
        revisions: Mapping[str, int] | None = None,
    ) -> Mapping[str, wire.GainsChange]:
        """Change gains of several controllers in one cycle; the others stay.

        Args:
            changes: New values by controller and name.
            revisions: Refuse when the gains of a controller have another revision.
        """
        request = GainsOfControllersPatch(
            changes={name: dict(values) for name, values in changes.items()},
            revisions=None if revisions is None else dict(revisions),
        )
        answer = await self._connection.send(
            "PATCH", "/gains", wire.GainsChanges, request
        )
        return answer.changes

    async def undo(self) -> Mapping[str, wire.GainsChange]:
        """Take the last change of gains back; return the change of each controller."""
        answer = await self._connection.send(
            "POST", f"{_GAIN_SETS}/undo", wire.GainsChanges
        )
        return answer.changes


def _chosen(controllers: Sequence[str] | None) -> wire.GainSetRequest:
    if controllers is None:
        return wire.GainSetRequest()
    return wire.GainSetRequest(controllers=list(controllers))


class AsyncPlotLayoutsClient:
    """Named layouts of plots on the station's disk: `client.plot_layouts`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def names(self) -> list[str]:
        """Return the names of the saved layouts."""
        found = await self._connection.get(_PLOT_LAYOUTS, wire.PlotLayouts)
        return found.plot_layouts

    async def get(self, name: str) -> wire.PlotLayout:
        """Return a layout with its plots."""
        return await self._connection.get(_below(_PLOT_LAYOUTS, name), wire.PlotLayout)

    async def save(
        self, name: str, plots: Sequence[wire.PlotSettings | wire.PlotRequest]
    ) -> wire.PlotLayout:
        """Save the plots of a layout; a layout of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            plots: The plots, from left to right.
        """
        read = partial(wire.PlotRequest.model_validate, from_attributes=True)
        request = wire.PlotLayoutRequest(plots=[read(plot) for plot in plots])
        return await self._connection.send(
            "PUT", _below(_PLOT_LAYOUTS, name), wire.PlotLayout, request
        )

    async def delete(self, name: str) -> wire.PlotLayout:
        """Delete a layout; return its last content."""
        return await self._connection.send(
            "DELETE", _below(_PLOT_LAYOUTS, name), wire.PlotLayout
        )


class AsyncScenesClient:
    """Named scenes on the station's disk: `client.scenes`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def names(self) -> list[str]:
        """Return the names of the saved scenes."""
        return (await self._connection.get(_SCENES, wire.SavedScenes)).scenes

    async def get(self, name: str) -> wire.SavedScene:
        """Return a scene with its objects."""
        return await self._connection.get(_below(_SCENES, name), wire.SavedScene)

    async def save(self, name: str) -> wire.SavedScene:
        """Save the objects that have a role now; a scene of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
        """
        path = _below(_SCENES, name)
        return await self._connection.send("PUT", path, wire.SavedScene)

    async def load(self, name: str) -> list[wire.SceneObject]:
        """Replace the objects with a role by those of a scene; return all objects."""
        path = f"{_below(_SCENES, name)}/load"
        return (await self._connection.send("POST", path, wire.Scene)).objects

    async def delete(self, name: str) -> wire.SavedScene:
        """Delete a scene; return its last content."""
        path = _below(_SCENES, name)
        return await self._connection.send("DELETE", path, wire.SavedScene)


class AsyncWaypointPathsClient:
    """Waypoint paths on the station's disk, and their playing: `client.waypoint_paths`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def names(self) -> list[str]:
        """Return the names of the saved paths."""
        return (
            await self._connection.get(_WAYPOINT_PATHS, wire.WaypointPaths)
        ).waypoint_paths

    async def get(self, name: str) -> wire.WaypointPath:
        """Return a path with its waypoints."""
        return await self._connection.get(
            _below(_WAYPOINT_PATHS, name), wire.WaypointPath
        )

    async def save(
        self, name: str, waypoints: Sequence[wire.Waypoint | wire.WaypointRequest]
    ) -> wire.WaypointPath:
        """Save the waypoints of a path; a path of that name is replaced.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            waypoints: The waypoints, in the order in which they are passed.
        """
        read = partial(wire.WaypointRequest.model_validate, from_attributes=True)
        found = [read(waypoint) for waypoint in waypoints]
        request = wire.WaypointPathRequest(waypoints=found)
        return await self._connection.send(
            "PUT", _below(_WAYPOINT_PATHS, name), wire.WaypointPath, request
        )

    async def delete(self, name: str) -> wire.WaypointPath:
        """Delete a path; return its last content."""
        return await self._connection.send(
            "DELETE", _below(_WAYPOINT_PATHS, name), wire.WaypointPath
        )

    async def capture(
        self, name: str, waypoint: str | None = None, duration: float = 2.0
    ) -> wire.WaypointPath:
        """Add where the joints are now to the end of a path; the first one makes it.

        Args:
            name: The path.
            waypoint: Name of the waypoint; `point N` when None.
            duration: Time to it from the waypoint before [s], above 0.
        """
        request = wire.CaptureRequest(name=waypoint, duration=duration)
        path = f"{_below(_WAYPOINT_PATHS, name)}/capture"
        return await self._connection.send("POST", path, wire.WaypointPath, request)

    async def play(
        self,
        name: str,
        *,
        controller: str | None = None,
        speed: float = 1.0,
        loop: bool = False,
    ) -> wire.Playback:
        """Move along a path; `playback` returns the progress.

        Args:
            name: The path.
            controller: The trajectory controller; the one that runs when None.
            speed: Factor of all speeds, 0.05 to 2.
            loop: Begin again at the end.
        """
        request = wire.PlayRequest(controller=controller, speed=speed, loop=loop)
        path = f"{_below(_WAYPOINT_PATHS, name)}/play"
        return await self._connection.send("POST", path, wire.Playback, request)

    async def playback(self) -> wire.Playback | None:
        """Return the path that plays or played last; None when none was played."""
        return (await self._connection.get(_PLAYBACK, wire.LastPlayback)).playback

    async def change(
        self,
        *,
        paused: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> wire.Playback:
        """Pause or resume the path that plays; change its speed, or whether it loops.

        Args:
            paused: True holds, false goes on, None leaves it.
            speed: Factor of all speeds, 0.05 to 2; None leaves it.
            loop: Whether it begins again at its end; None leaves it.
        """
        request = wire.PlaybackPatch(paused=paused, speed=speed, loop=loop)
        return await self._connection.send("PATCH", _PLAYBACK, wire.Playback, request)

    async def cancel(self) -> wire.Playback:
        """End the path that plays; the robot holds where it is."""
        return await self._connection.send("DELETE", _PLAYBACK, wire.Playback)


class AsyncExperimentsClient:
    """Experiments that run beside the station: `client.experiments`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def start(self, request: wire.ExperimentRequest) -> Experiment:
        """Start an experiment; one runs at a time. The robot does not move.

        Args:
            request: Description of it, such as `ExperimentRequest(kind="tune",
                controller="effort_joint_trajectory_controller")`.
        """
        return await self._connection.send(
            "POST", _EXPERIMENTS, Experiment, request, patience=_CHECKING
        )

    async def get(self, name: str) -> Experiment:
        """Return an experiment's progress, its first trial and the best so far."""
        return await self._connection.get(_below(_EXPERIMENTS, name), Experiment)

    async def wait(
        self, name: str, watch: Callable[[Experiment], None] | None = None
    ) -> Experiment:
        """Wait until an experiment does not run any more; return it.

        Args:
            name: The experiment.
            watch: Is called with it twice a second.
        """
        found = await self.get(name)
        while found.state == "running":
            if watch is not None:
                watch(found)
            await self._connection.sleep(_PERIOD)
            found = await self.get(name)
        if watch is not None:
            watch(found)
        return found

    async def cancel(self, name: str) -> Experiment:
        """End the experiment that runs; trials that run may end."""
        return await self._connection.send(
            "POST", f"{_below(_EXPERIMENTS, name)}/cancel", Experiment
        )

    async def delete(self, name: str) -> Experiment:
        """Delete an experiment that does not run; return its last state."""
        return await self._connection.send(
            "DELETE", _below(_EXPERIMENTS, name), Experiment
        )

    async def trials(
        self, name: str, after: int = 0, count: int = 100
    ) -> list[ExperimentTrial]:
        """Return trials that have ended, in the order of ending.

        Args:
            name: The experiment.
            after: Number of the last trial that is known.
            count: How many at most, 1 to 500.
        """
        query = {"after": str(after), "count": str(count)}
        path = f"{_below(_EXPERIMENTS, name)}/trials"
        return (await self._connection.get(path, ExperimentTrials, query)).trials

    async def best(
        self, name: str, count: int = 5, metric: str | None = None
    ) -> list[ExperimentTrial]:
        """Return the best trials, the best first.

        Args:
            name: The experiment.
            count: How many at most, 1 to 500.
            metric: Metric that ranks; the experiment's own goal or metric when None.
        """
        query = {"count": str(count)}
        if metric is not None:
            query["metric"] = metric
        path = f"{_below(_EXPERIMENTS, name)}/best"
        return (await self._connection.get(path, ExperimentTrials, query)).trials

    async def responses(self, name: str) -> list[ExperimentResponse]:
        """Return the responses that were kept: first and best trial, or the worst."""
        path = f"{_below(_EXPERIMENTS, name)}/responses"
        return (await self._connection.get(path, ExperimentResponses)).responses

    async def preview(self, name: str, trial: str | None = None) -> ExperimentPreview:
        """Return the gains that a trial's own would change.

        Args:
            name: The experiment.
            trial: Hash of the trial, or the beginning of it; the best when None.
        """
        query = {} if trial is None else {"trial": trial}
        path = f"{_below(_EXPERIMENTS, name)}/preview"
        return await self._connection.get(path, ExperimentPreview, query)

    async def apply(
        self,
        name: str,
        trial: str | None = None,
        revisions: Mapping[str, int] | None = None,
    ) -> Mapping[str, wire.GainsChange]:
        """Put the gains of a trial into force in one cycle, and save them as a set.

        Args:
            name: The experiment, and the name of the gain set.
            trial: Hash of the trial, or the beginning of it; the best when None.
            revisions: Those of the preview; refused when the gains have changed since.
        """
        request = ExperimentApplyRequest(
            trial=trial, revisions=None if revisions is None else dict(revisions)
        )
        path = f"{_below(_EXPERIMENTS, name)}/apply"
        answer = await self._connection.send("POST", path, wire.GainsChanges, request)
        return answer.changes

    async def list(self) -> list[ExperimentSummary]:
        """Return the experiments, sorted by name."""
        return (await self._connection.get(_EXPERIMENTS, Experiments)).experiments


class AsyncAlarmsClient:
    """Alarms, each of which asks for a person: `client.alarms`.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def list(self) -> list[wire.Alarm]:
        """Return the alarms whose cause is there or that nobody has acknowledged."""
        return (await self._connection.get("/alarms", wire.Alarms)).alarms

    async def acknowledge(self, number: int) -> wire.Alarm:
        """Say that an alarm was seen; its cause stays.

        Args:
            number: The `id` of the alarm.
        """
        path = f"/alarms/{number:d}/acknowledge"
        return await self._connection.send("POST", path, wire.Alarm)


class AsyncTokensClient:
    """Named tokens, made, listed and revoked by an operator: `client.tokens`.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def list(self) -> list[wire.Token]:
        """Return the named tokens that are valid."""
        return (await self._connection.get("/tokens", wire.Tokens)).tokens

    async def create(
        self,
        name: str,
        role: wire.RoleName = "operator",
        *,
        expires: float | None = None,
    ) -> wire.NewToken:
        """Make a token; the answer alone has it.

        Args:
            name: Owner of the token.
            role: `operator`, `viewer` or `agent`.
            expires: How long it is valid [s]; None until it is revoked.
        """
        request = wire.TokenRequest(name=name, role=role, expires=expires)
        return await self._connection.send("POST", "/tokens", wire.NewToken, request)

    async def revoke(self, name: str) -> wire.Token:
        """End a token, and the streams, sessions and the control it has."""
        path = _below("/tokens", name)
        return await self._connection.send("DELETE", path, wire.Token)


class AsyncAgentsClient:
    """Requests of agents, which a person allows or refuses: `client.agents`.

    Args:
        connection: The client's connection.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def requests(self) -> list[wire.AgentRequest]:
        """Return the latest requests, oldest first; one that waits has no `verdict`."""
        found = await self._connection.get("/agents/requests", wire.AgentRequests)
        return found.requests

    async def answer(
        self,
        number: str,
        verdict: Literal["allowed", "allowed_for_a_time", "refused"],
    ) -> wire.AgentRequest:
        """Allow or refuse what an agent asks for.

        Args:
            number: `number` of the request.
            verdict: `allowed_for_a_time` also allows what comes in the next 10 min.
        """
        return await self._connection.send(
            "POST",
            _below("/agents/requests", number),
            wire.AgentRequest,
            wire.AgentAnswer(verdict=verdict),
        )


def _below(path: str, name: str) -> str:
    return f"{path}/{segment(name)}"
