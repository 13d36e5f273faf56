"""Topics that can be streamed, and their payloads."""

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Sequence

import anyio.to_thread
from typing_extensions import override

from station.api import answers
from station.api.streams.cycle_samples import (
    CycleSamples,
    Data,
    Payload,
    RingSamples,
    TapSamples,
)
from station.core.control.controller import ControllerSample
from station.core.errors import ArmNotFoundError, ControllerNotFoundError, StationError
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.hardware.robot_report import (
    ContactReport,
    MovingBaseReport,
    SceneObjectReport,
)
from station.core.loop.snapshot import Snapshot
from station.events import EventLog
from station.reports import Clearance, Event
from station.wire import FrankaState, Scene

CONTROLLER_STATE = "controller_state/"
ROBOT_STATE = "robot_state"
_ARM_BATCH = 25
"""Most cycles of an arm's whole state in one batch; each has 6 KB of JSON."""


class Topic(ABC):
    """A topic that can be streamed. Use it in the event loop only.

    Attributes:
        name: Name in the URL.
        fields: Keys of the payload.
        sample_fields: Keys of a cycle's sample with `rate=full`, besides `cycle`. A
            batch has `name` only once.
        default_rate: Frames per second if the request has no rate [Hz].
    """

    name: str
    fields: tuple[str, ...]
    sample_fields: tuple[str, ...]
    default_rate: float

    @abstractmethod
    async def latest(self) -> Payload | None:
        """Return the newest payload; None if there is none at the moment."""

    @abstractmethod
    def every_cycle(self) -> CycleSamples:
        """Return the samples of every cycle from now on."""


class CycleTopic(Topic):
    """A topic whose samples are in the ring of snapshots.

    Args:
        station: The station.
    """

    def __init__(self, station: Station) -> None:
        self._station = station

    @abstractmethod
    def sample(self, snapshot: Snapshot) -> Data | None:
        """Return the fields that change with the cycle; None if the cycle has none."""

    @abstractmethod
    def names(self) -> list[str]:
        """Return the names of the elements."""

    @override
    async def latest(self) -> Payload | None:
        snapshot = self._station.snapshots.latest()
        if snapshot is None:
            return None
        data = self.sample(snapshot)
        if data is None:
            return None
        data = {**self._head(), **data}
        return Payload(snapshot.cycle, snapshot.epoch, snapshot.stamp, data)

    @override
    def every_cycle(self) -> CycleSamples:
        return RingSamples(self._station, self.sample, self._head)

    def _head(self) -> Data:
        return {"name": self.names()}


class JointStatesTopic(CycleTopic):
    """All joints, as `sensor_msgs/JointState`."""

    name = "joint_states"
    fields = sample_fields = ("stamp", "name", "position", "velocity", "effort")
    default_rate = 30.0

    @override
    def names(self) -> list[str]:
        return self._station.joint_names

    @override
    def sample(self, snapshot: Snapshot) -> Data | None:
        return {
            "stamp": snapshot.stamp,
            "position": snapshot.position,
            "velocity": snapshot.velocity,
            "effort": snapshot.effort,
        }


class ControllerStateTopic(CycleTopic):
    """The values of one controller: desired, actual, error and output.

    Args:
        station: The station.
        controller: Name of the controller, which must be loaded.

    Raises:
        ControllerNotFoundError: The controller is not loaded.
    """

    fields = sample_fields = ("stamp", "name", *ControllerSample._fields[1:])
    default_rate = 30.0

    def __init__(self, station: Station, controller: str) -> None:
        super().__init__(station)
        self._controller = controller
        self.name = CONTROLLER_STATE + controller
        self._names = self._loaded_names()

    def _loaded_names(self) -> list[str]:
        return list(self._station.manager.get_controller(self._controller).joint_names)

    @override
    def names(self) -> list[str]:
        try:
            self._names = self._loaded_names()
        except ControllerNotFoundError:
            return self._names  # unloaded meanwhile; these are the last samples
        return self._names

    @override
    def sample(self, snapshot: Snapshot) -> Data | None:
        sample = snapshot.samples.get(self._controller)
        return None if sample is None else sample._asdict()


class ReportTopic(Topic):
    """A topic whose payload is read from the station in a worker thread.

    Args:
        station: The station.
    """

    def __init__(self, station: Station) -> None:
        self._station = station

    @abstractmethod
    def report(self) -> Data:
        """Return the payload's fields; this may block."""

    @override
    async def latest(self) -> Payload | None:
        try:
            data = await anyio.to_thread.run_sync(self.report)
        except StationError:
            return None  # the loop does not run; the topic `loop` has the reason
        loop = self._station.loop
        return Payload(loop.cycle, self._station.epoch, loop.time, data)


class RobotStateTopic(ReportTopic):
    """The whole state of one arm.

    Args:
        station: The station.
        arm_id: The arm.

    Raises:
        ArmNotFoundError: The arm is unknown.
    """

    fields = ("arm_id", *FrankaState.model_fields)
    sample_fields = ("stamp", "arm_id", *FrankaState.model_fields)
    default_rate = 30.0

    def __init__(self, station: Station, arm_id: str) -> None:
        super().__init__(station)
        self._arms = Arms(station.robots)
        self._arms.report(arm_id)  # refuses an unknown arm
        self._arm_id = arm_id
        self.name = f"{ROBOT_STATE}/{arm_id}"

    @override
    def report(self) -> Data:
        state, arm_id = self._arms.state(self._arm_id), self._arm_id
        values = answers.franka_state(
            state, self._station.surroundings.clearance(arm_id)
        )
        return {"arm_id": arm_id, **FrankaState.model_validate(values).model_dump()}

    @override
    def every_cycle(self) -> CycleSamples:
        state, arm_id = self._arms.reader(self._arm_id), self._arm_id
        nearest = self._station.surroundings.clearance
        return TapSamples(
            self._station,
            lambda: (state(), nearest(arm_id)),
            lambda taken: answers.franka_state(*taken),
            lambda: {"arm_id": arm_id},
            _ARM_BATCH,
        )


class ControllersTopic(ReportTopic):
    """The list of controllers."""

    name = "controllers"
    fields = ("controllers",)
    sample_fields = ("stamp", "running")
    default_rate = 5.0

    @override
    def report(self) -> Data:
        return answers.controllers(self._station).model_dump()

    @override
    def every_cycle(self) -> CycleSamples:
        names = self._station.manager.running_names
        return TapSamples(self._station, names, lambda names: {"running": names})


class LoopTopic(ReportTopic):
    """State of the loop and of the stop."""

    name = "loop"
    default_rate = 2.0
    fields = ("loop", "stop", "robot_mode")
    sample_fields = ("stamp", "period", "robot_mode")

    @override
    def report(self) -> Data:
        return {
            "loop": self._station.loop.report(),
            "stop": answers.stop_state(self._station).model_dump(),
            "robot_mode": self._station.status().robot_mode,
        }

    @override
    def every_cycle(self) -> CycleSamples:
        return RingSamples(self._station, _loop_sample)


class SceneTopic(ReportTopic):
    """The objects around a simulated robot, contacts and moving bases."""

    name = "scene"
    default_rate = 10.0
    fields = ("objects", "contacts", "bases", "clearances")
    sample_fields = ("stamp", *fields)

    @override
    def report(self) -> Data:
        station = self._station
        return _scene_sample((
            station.scene(),
            station.contacts(),
            station.bases(),
            station.surroundings.clearances(),
        ))

    @override
    def every_cycle(self) -> CycleSamples:
        world = self._station.loop.hw.simulated_world()
        clearances = self._station.surroundings.clearances

        def read() -> _SceneReport:
            if world is None:
                return ((), (), (), clearances())
            return (world.scene(), world.contacts(), world.bases(), clearances())

        return TapSamples(self._station, read, _scene_sample)


class EventsTopic(Topic):
    """Events, one per frame; none is left out.

    Args:
        station: The station.
        log: Its event log.

    Attributes:
        log: As given.
    """

    name = "events"
    fields = tuple(field.name for field in dataclasses.fields(Event))
    sample_fields = ()
    default_rate = 20.0

    def __init__(self, station: Station, log: EventLog) -> None:
        self._station = station
        self.log = log

    @override
    async def latest(self) -> Payload | None:
        found = self.log.recent(self.log.newest_id - 1)
        return self.payload(found[-1]) if found else None

    def payload(self, event: Event) -> Payload:
        """Return an event as the payload of a frame."""
        data: Data = {name: getattr(event, name) for name in self.fields}
        return Payload(event.cycle, self._station.epoch, event.stamp, data)

    @override
    def every_cycle(self) -> CycleSamples:
        """Raise an error: events do not belong to cycles; requests refuse this before.

        Raises:
            LookupError: Always.
        """
        raise LookupError("The topic 'events' has no samples of cycles.")


_SceneReport = tuple[
    Sequence[SceneObjectReport],
    Sequence[ContactReport],
    Sequence[MovingBaseReport],
    Sequence[Clearance],
]


def _scene_sample(report: _SceneReport) -> Data:
    objects, contacts, bases, clearances = report
    found = {
        "objects": objects,
        "contacts": contacts,
        "bases": bases,
        "clearances": clearances,
    }
    return Scene.model_validate(found).model_dump()


def _loop_sample(snapshot: Snapshot) -> Data:
    return {
        "stamp": snapshot.stamp,
        "period": snapshot.period,
        "robot_mode": snapshot.mode,
    }


_FIXED: tuple[
    type[JointStatesTopic | ControllersTopic | LoopTopic | SceneTopic], ...
] = (
    JointStatesTopic,
    ControllersTopic,
    LoopTopic,
    SceneTopic,
)


def find_topic(
    station: Station, name: str, log: EventLog | None = None
) -> Topic | None:
    """Return the topic of that name, or None.

    The name `robot_state` without an arm is the topic of the only arm.

    Args:
        station: The station.
        name: Name of the topic.
        log: The station's event log; without one there is no topic `events`.
    """
    if name == EventsTopic.name and log is not None:
        return EventsTopic(station, log)
    for kind in _FIXED:
        if kind.name == name:
            return kind(station)
    family, _, member = name.partition("/")
    arms = Arms(station.robots).names()
    if name == ROBOT_STATE and len(arms) == 1:
        member = arms[0]
    try:
        if name.startswith(CONTROLLER_STATE):
            return ControllerStateTopic(station, name.removeprefix(CONTROLLER_STATE))
        if family == ROBOT_STATE:
            return RobotStateTopic(station, member)
    except (ControllerNotFoundError, ArmNotFoundError):
        # The caller's refusal lists all topics, including those of arms and
        # controllers, which helps more than an error about this one.
        return None
    return None


def topic_names(station: Station) -> list[str]:
    """Return the names of all present topics."""
    fixed = [*(kind.name for kind in _FIXED), EventsTopic.name]
    arms = [f"{ROBOT_STATE}/{arm_id}" for arm_id in Arms(station.robots).names()]
    loaded = [CONTROLLER_STATE + status.name for status in station.controllers()]
    return fixed + arms + loaded
