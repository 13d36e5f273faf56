"""The clients of a station's stores, which are on its disk or in its memory."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Literal

from station import wire
from station.client.connection import ClientPart, NamedThings, Query
from station.wire.controllers import GainsOfControllersPatch
from station.wire.excitations import (
    BenchResponse,
    BenchRun,
    BenchRuns,
    Lesson,
    LessonBeginRequest,
    LessonCheckRequest,
    LessonResult,
    Lessons,
    PartRequest,
)
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

_PLAYBACK = "/playback"
_PERIOD = 0.5
"""Time between two requests for the state of an experiment [s]."""
_CHECKING = 60.0
"""Extra time to start an experiment, or to check an uploaded file [s]."""


class AsyncFilesClient(ClientPart):
    """Common part of the clients of recordings and incidents."""

    async def list(self) -> list[wire.Recording]:
        """Return all recordings or incidents, the oldest first."""
        return (await self._get(self._path, wire.Recordings)).recordings

    async def get(self, identifier: str) -> wire.Recording:
        """Return the description of a recording."""
        return await self._get(self._of(identifier), wire.Recording)

    async def trajectory(self, identifier: str, rate: float = 30.0) -> wire.Trajectory:
        """Return the joint positions of an ended recording.

        Args:
            identifier: Id or name of the recording.
            rate: Cycles per second of station time [Hz].
        """
        path = self._of(identifier, "trajectory")
        return await self._get(path, wire.Trajectory, {"rate": repr(rate)})

    async def download(self, identifier: str, target: Path | str) -> Path:
        """Write the MCAP file of an ended recording to a new file; return its path.

        Args:
            identifier: Id or name of the recording.
            target: The file to write, which must not exist.

        Raises:
            FileExistsError: The file already exists.
        """
        target = Path(target)
        await self._connection.download(self._of(identifier, "file"), target)
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
        """Write an ended recording as CSV to a new file; return its path.

        Args:
            identifier: Id or name of the recording.
            target: The file to write, which must not exist.
            channels: Channels, or channels with a field, e.g. `joint_states/position`;
                all when there is none.
            joints: Joints, or other elements with a name; all when there is none.
            rate: Rows per second of station time [Hz], > 0; every cycle when None.

        Raises:
            FileExistsError: The file already exists.
        """
        target = Path(target)
        query: Query = {"channels": [*channels], "joints": [*joints]}
        if rate is not None:
            query = {**query, "rate": repr(rate)}
        await self._connection.download(self._of(identifier, "table"), target, query)
        return target

    async def events(self, identifier: str) -> Sequence[wire.RecordedEvent]:
        """Return the events of an ended recording, with its notes."""
        path = self._of(identifier, "events")
        return (await self._get(path, wire.RecordedEvents)).events

    async def add_note(
        self, identifier: str, text: str, time: float, until: float | None = None
    ) -> wire.RecordedEvent:
        """Add a note to an ended recording; it becomes an event of the file.

        Args:
            identifier: Id or name of the recording.
            text: The note.
            time: Station time of the moment, or of the begin of the range [s].
            until: Station time of the end of the range [s]; None for a moment.
        """
        request = wire.NoteRequest(text=text, time=time, until=until)
        path = self._of(identifier, "notes")
        return await self._send("POST", path, wire.RecordedEvent, request)

    async def bench(self, identifier: str, part: PartRequest) -> BenchResponse:
        """Read a part of an ended recording as a test of a joint, and keep the run.

        Args:
            identifier: Id or name of the recording.
            part: Controller, joint, kind of the test, begin and end.
        """
        path = self._of(identifier, "bench")
        return await self._send("POST", path, BenchResponse, part)


class AsyncRecordingsClient(AsyncFilesClient):
    """Recordings of every cycle on the station's disk: `client.recordings`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/recordings"

    async def start(self, name: str = "", note: str = "") -> wire.Recording:
        """Begin to record with the next cycle; one recording runs at a time.

        Args:
            name: Up to 80 letters, digits, `_`, `.` and `-`.
            note: Note to store in the recording.
        """
        request = wire.RecordingRequest(name=name, note=note)
        return await self._send("POST", self._path, wire.Recording, request)

    async def stop(self, identifier: str | None = None) -> wire.Recording:
        """End a recording, which completes its file.

        Args:
            identifier: Id or name of the recording; None for the running one.

        Raises:
            LookupError: No recording runs.
        """
        if identifier is None:
            known = await self.list()
            running = [r for r in known if r.state == "recording"]
            if not running:
                text = "Nothing is being recorded."
                if known and known[-1].state == "failed":
                    text += f" {known[-1].identifier} failed: {known[-1].error}"
                raise LookupError(text)
            identifier = running[-1].identifier
        return await self._send("POST", self._of(identifier, "stop"), wire.Recording)

    async def upload(self, file: Path | str, name: str = "") -> wire.Recording:
        """Upload an MCAP file, of this or another station, to the recordings.

        Args:
            file: The file.
            name: Name of the recording: up to 80 letters, digits, `_`, `.` and `-`.

        Raises:
            FileNotFoundError: The file does not exist.
        """
        return await self._connection.send(
            "POST",
            f"{self._path}/upload",
            wire.Recording,
            Path(file),
            query={"name": name},
            patience=_CHECKING,
        )

    async def delete(self, identifier: str) -> wire.Recording:
        """Delete an ended recording; return its description."""
        return await self._send("DELETE", self._of(identifier), wire.Recording)


class AsyncIncidentsClient(AsyncFilesClient):
    """Recordings around stops, reflexes and faults: `client.incidents`."""

    _path = "/incidents"


class AsyncBenchRunsClient(NamedThings[BenchResponse]):
    """Runs of the bench that the station keeps: `client.bench_runs`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/bench-runs"
    _kind = BenchResponse

    async def list(self) -> list[BenchRun]:
        """Return the kept runs with their metrics, the oldest first."""
        return (await self._get(self._path, BenchRuns)).runs


class AsyncLessonsClient(ClientPart):
    """Exercises that the station checks on the student's own run: `client.lessons`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/lessons"

    async def list(self, person: str = "") -> Lessons:
        """Return the lessons in their order, with the progress of a person."""
        return await self._get(self._path, Lessons, {"person": person})

    async def begin(self, name: str, person: str = "") -> Lesson:
        """Begin a lesson; the station watches the robot from now on."""
        request = LessonBeginRequest(person=person)
        return await self._send("POST", self._of(name, "begin"), Lesson, request)

    async def check(
        self, name: str, person: str = "", answers: Mapping[str, float] | None = None
    ) -> LessonResult:
        """Check the robot's motions since the lesson was begun.

        Args:
            name: The lesson.
            person: Name of the student; the name of the token when empty.
            answers: Numbers that the student has worked out, by name, in the units of
                the lesson.
        """
        request = LessonCheckRequest(person=person, answers=dict(answers or {}))
        return await self._send("POST", self._of(name, "check"), LessonResult, request)


class AsyncCamerasClient(ClientPart):
    """Cameras that look at the robots: `client.cameras`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/cameras"

    async def list(self) -> wire.Cameras:
        """Return the cameras; the `fault` of a camera says why it has no pictures."""
        return await self._get(self._path, wire.Cameras)

    async def save(self, name: str, target: Path | str) -> Path:
        """Draw a picture now, and write it to a new file.

        Args:
            name: Name of the camera.
            target: The JPEG file to write, which must not exist.

        Returns:
            The file.

        Raises:
            FileExistsError: The file already exists.
        """
        target = Path(target)
        await self._connection.download(self._of(name), target)
        return target


class AsyncGainSetsClient(NamedThings[wire.GainSet]):
    """Named sets of gains on the station's disk: `client.gain_sets`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/gain-sets"
    _kind = wire.GainSet

    async def names(self) -> list[str]:
        """Return the names of the saved sets."""
        return (await self._get(self._path, wire.GainSets)).gain_sets

    async def save(
        self, name: str, controllers: Sequence[str] | None = None
    ) -> wire.GainSet:
        """Save the gains in force under a name; it replaces a set of the same name.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            controllers: Controllers; None for all loaded controllers.
        """
        request = _chosen(controllers)
        return await self._send("PUT", self._of(name), wire.GainSet, request)

    async def apply(
        self, name: str, controllers: Sequence[str] | None = None
    ) -> Mapping[str, wire.GainsChange]:
        """Put a set into force in one cycle; return the change of each controller.

        Args:
            name: The set.
            controllers: Controllers; None for all controllers of the set.
        """
        path, request = self._of(name, "apply"), _chosen(controllers)
        return (await self._send("POST", path, wire.GainsChanges, request)).changes

    async def set_gains(
        self,
        changes: Mapping[str, Mapping[str, float]],
        revisions: Mapping[str, int] | None = None,
    ) -> Mapping[str, wire.GainsChange]:
        """Change gains of several controllers in one cycle; the others stay.

        Args:
            changes: New values by controller and name.
            revisions: Revisions of the gains by controller; the station refuses the
                change if a present revision differs.
        """
        request = GainsOfControllersPatch(
            changes={name: dict(values) for name, values in changes.items()},
            revisions=None if revisions is None else dict(revisions),
        )
        return (await self._send("PATCH", "/gains", wire.GainsChanges, request)).changes

    async def undo(self) -> Mapping[str, wire.GainsChange]:
        """Undo the last change of gains; return the change of each controller."""
        answer = await self._send("POST", f"{self._path}/undo", wire.GainsChanges)
        return answer.changes


def _chosen(controllers: Sequence[str] | None) -> wire.GainSetRequest:
    if controllers is None:
        return wire.GainSetRequest()
    return wire.GainSetRequest(controllers=list(controllers))


class AsyncPlotLayoutsClient(NamedThings[wire.PlotLayout]):
    """Named layouts of plots on the station's disk: `client.plot_layouts`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/plot-layouts"
    _kind = wire.PlotLayout

    async def names(self) -> list[str]:
        """Return the names of the saved layouts."""
        return (await self._get(self._path, wire.PlotLayouts)).plot_layouts

    async def save(
        self,
        name: str,
        plots: Sequence[wire.PlotSettings | wire.PlotRequest],
        docks: wire.DockSettings | wire.DocksRequest | None = None,
    ) -> wire.PlotLayout:
        """Save a layout of plots; it replaces a layout of the same name.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            plots: The plots, from left to right.
            docks: Folds and sizes of the docks; None keeps those of the layout.
        """
        read = partial(wire.PlotRequest.model_validate, from_attributes=True)
        of_docks = partial(wire.DocksRequest.model_validate, from_attributes=True)
        request = wire.PlotLayoutRequest(
            plots=[read(plot) for plot in plots],
            docks=None if docks is None else of_docks(docks),
        )
        return await self._send("PUT", self._of(name), wire.PlotLayout, request)


class AsyncScenesClient(NamedThings[wire.SavedScene]):
    """Named scenes on the station's disk: `client.scenes`.

    Every method raises the errors of the station client's own methods.

    Args:
        connection: The connection to the station.
    """

    _path = "/scenes"
    _kind = wire.SavedScene

    async def names(self) -> list[str]:
        """Return the names of the saved scenes."""
        return (await self._get(self._path, wire.SavedScenes)).scenes

    async def save(self, name: str) -> wire.SavedScene:
        """Save the present objects with a role; they replace a scene of the same name.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
        """
        return await self._send("PUT", self._of(name), wire.SavedScene)

    async def load(self, name: str) -> list[wire.SceneObject]:
        """Replace the objects with a role by those of a scene; return all objects."""
        return (await self._send("POST", self._of(name, "load"), wire.Scene)).objects


class AsyncWaypointPathsClient(NamedThings[wire.WaypointPath]):
    """Waypoint paths on the station's disk, and their playing: `client.waypoint_paths`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/waypoint-paths"
    _kind = wire.WaypointPath

    async def names(self) -> list[str]:
        """Return the names of the saved paths."""
        return (await self._get(self._path, wire.WaypointPaths)).waypoint_paths

    async def save(
        self, name: str, waypoints: Sequence[wire.Waypoint | wire.WaypointRequest]
    ) -> wire.WaypointPath:
        """Save the waypoints of a path; they replace a path of the same name.

        Args:
            name: Letters, digits, `_`, `.` and `-`.
            waypoints: The waypoints, in the order in which they are passed.
        """
        read = partial(wire.WaypointRequest.model_validate, from_attributes=True)
        found = [read(waypoint) for waypoint in waypoints]
        request = wire.WaypointPathRequest(waypoints=found)
        return await self._send("PUT", self._of(name), wire.WaypointPath, request)

    async def capture(
        self, name: str, waypoint: str | None = None, duration: float = 2.0
    ) -> wire.WaypointPath:
        """Add the present positions to the end of a path, which may be new.

        Args:
            name: The path.
            waypoint: Name of the waypoint; `point N` when None.
            duration: Time to it from the waypoint before [s], above 0.
        """
        request = wire.CaptureRequest(name=waypoint, duration=duration)
        path = self._of(name, "capture")
        return await self._send("POST", path, wire.WaypointPath, request)

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
            controller: The trajectory controller; None for the running one.
            speed: Factor of all speeds, 0.05 to 2.
            loop: Whether to begin again at the end.
        """
        request = wire.PlayRequest(controller=controller, speed=speed, loop=loop)
        return await self._send("POST", self._of(name, "play"), wire.Playback, request)

    async def playback(self) -> wire.Playback | None:
        """Return the path that plays or played last; None before the first."""
        return (await self._get(_PLAYBACK, wire.LastPlayback)).playback

    async def change(
        self,
        *,
        paused: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> wire.Playback:
        """Pause or resume the path that plays; change its speed, or whether it loops.

        Args:
            paused: True pauses, False resumes, None changes nothing.
            speed: Factor of all speeds, 0.05 to 2; None keeps the speed.
            loop: Whether the path begins again at its end; None keeps the setting.
        """
        request = wire.PlaybackPatch(paused=paused, speed=speed, loop=loop)
        return await self._send("PATCH", _PLAYBACK, wire.Playback, request)

    async def cancel(self) -> wire.Playback:
        """End the path that plays; the robot holds where it is."""
        return await self._send("DELETE", _PLAYBACK, wire.Playback)


class AsyncExperimentsClient(NamedThings[Experiment]):
    """Experiments that run beside the station: `client.experiments`.

    Every method raises the errors of the station client's own methods.
    """

    _path = "/experiments"
    _kind = Experiment

    async def start(self, request: wire.ExperimentRequest) -> Experiment:
        """Start an experiment; one runs at a time. The robot does not move.

        Args:
            request: The experiment, such as `ExperimentRequest(kind="tune",
                controller="effort_joint_trajectory_controller")`.
        """
        return await self._send(
            "POST", self._path, Experiment, request, patience=_CHECKING
        )

    async def wait(
        self, name: str, watch: Callable[[Experiment], None] | None = None
    ) -> Experiment:
        """Wait until an experiment has ended; return it.

        Args:
            name: The experiment.
            watch: Function that is called with the experiment twice a second.
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
        """End the running experiment, after its running trials."""
        return await self._send("POST", self._of(name, "cancel"), Experiment)

    async def trials(
        self, name: str, after: int = 0, count: int = 100
    ) -> list[ExperimentTrial]:
        """Return trials that have ended, in the order of ending.

        Args:
            name: The experiment.
            after: Number of the last trial that the caller knows.
            count: Largest number of trials, 1 to 500.
        """
        query = {"after": str(after), "count": str(count)}
        path = self._of(name, "trials")
        return (await self._get(path, ExperimentTrials, query)).trials

    async def best(
        self, name: str, count: int = 5, metric: str | None = None
    ) -> list[ExperimentTrial]:
        """Return the best trials, the best first.

        Args:
            name: The experiment.
            count: Largest number of trials, 1 to 500.
            metric: Metric that ranks the trials; None for the experiment's own goal or
                metric.
        """
        query = {"count": str(count)}
        if metric is not None:
            query["metric"] = metric
        return (await self._get(self._of(name, "best"), ExperimentTrials, query)).trials

    async def responses(self, name: str) -> list[ExperimentResponse]:
        """Return the kept responses of the first and best trial, or of the worst."""
        path = self._of(name, "responses")
        return (await self._get(path, ExperimentResponses)).responses

    async def preview(self, name: str, trial: str | None = None) -> ExperimentPreview:
        """Return the changes that would put the gains of a trial into force.

        Args:
            name: The experiment.
            trial: Hash of the trial, or its first characters; None for the best trial.
        """
        query = {} if trial is None else {"trial": trial}
        return await self._get(self._of(name, "preview"), ExperimentPreview, query)

    async def apply(
        self,
        name: str,
        trial: str | None = None,
        revisions: Mapping[str, int] | None = None,
    ) -> Mapping[str, wire.GainsChange]:
        """Put the gains of a trial into force in one cycle, and save them as a set.

        Args:
            name: The experiment, and the name of the gain set.
            trial: Hash of the trial, or its first characters; None for the best trial.
            revisions: Revisions of the preview; the station refuses the change if gains
                have changed since.
        """
        request = ExperimentApplyRequest(
            trial=trial, revisions=None if revisions is None else dict(revisions)
        )
        path = self._of(name, "apply")
        return (await self._send("POST", path, wire.GainsChanges, request)).changes

    async def list(self) -> list[ExperimentSummary]:
        """Return the experiments, sorted by name."""
        return (await self._get(self._path, Experiments)).experiments


class AsyncAlarmsClient(ClientPart):
    """Alarms, each of which needs a person: `client.alarms`."""

    _path = "/alarms"

    async def list(self) -> list[wire.Alarm]:
        """Return the alarms whose cause is present, or that are not acknowledged."""
        return (await self._get(self._path, wire.Alarms)).alarms

    async def acknowledge(self, number: int) -> wire.Alarm:
        """Acknowledge an alarm; its cause stays.

        Args:
            number: The `id` of the alarm.
        """
        path = self._of(f"{number:d}", "acknowledge")
        return await self._send("POST", path, wire.Alarm)


class AsyncTokensClient(ClientPart):
    """Named tokens that an operator makes, lists and revokes: `client.tokens`."""

    _path = "/tokens"

    async def list(self) -> list[wire.Token]:
        """Return the valid named tokens."""
        return (await self._get(self._path, wire.Tokens)).tokens

    async def create(
        self,
        name: str,
        role: wire.RoleName = "operator",
        *,
        expires: float | None = None,
    ) -> wire.NewToken:
        """Make a token, which only this answer contains.

        Args:
            name: Owner of the token.
            role: `operator`, `viewer` or `agent`.
            expires: How long it is valid [s]; None until it is revoked.
        """
        request = wire.TokenRequest(name=name, role=role, expires=expires)
        return await self._send("POST", self._path, wire.NewToken, request)

    async def revoke(self, name: str) -> wire.Token:
        """Revoke a token; its streams, sessions and its control end, too."""
        return await self._send("DELETE", self._of(name), wire.Token)


class AsyncAgentsClient(ClientPart):
    """Requests of agents, which a person allows or refuses: `client.agents`."""

    _path = "/agents/requests"

    async def requests(self) -> list[wire.AgentRequest]:
        """Return the latest requests, oldest first; a waiting one has no `verdict`."""
        return (await self._get(self._path, wire.AgentRequests)).requests

    async def answer(
        self,
        number: str,
        verdict: Literal["allowed", "allowed_for_a_time", "refused"],
    ) -> wire.AgentRequest:
        """Allow or refuse a request of an agent.

        Args:
            number: `number` of the request.
            verdict: `allowed_for_a_time` also allows the requests of the next 10 min.
        """
        return await self._send(
            "POST",
            self._of(number),
            wire.AgentRequest,
            wire.AgentAnswer(verdict=verdict),
        )
