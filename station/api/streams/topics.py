"""What can be streamed, and how each topic's payload is made."""

from abc import ABC, abstractmethod
from typing import NamedTuple

import anyio.to_thread
from typing_extensions import override

from station.api import answers
from station.core.control.controller import ControllerSample
from station.core.errors import (
    ArmNotFoundError,
    ControllerNotFoundError,
    StationError,
)
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.loop.snapshot import Snapshot
from station.wire import FrankaState, LoopReport, Scene

CONTROLLER_STATE = "controller_state/"
ROBOT_STATE = "robot_state"
Data = dict[str, object]


class Payload(NamedTuple):
    """What a frame is about, before it is encoded.

    Attributes:
        cycle: Cycle of the data.
        epoch: Epoch of the data.
        stamp: Station time of the data [s].
        data: The topic's fields.
    """

    cycle: int
    epoch: int
    stamp: float
    data: Data


class Topic(ABC):
    """Something that can be streamed. Used from the event loop only.

    Attributes:
        name: Name in the URL.
        fields: Keys of the payload.
        default_rate: Frames per second when the client does not say [Hz].
    """

    name: str
    fields: tuple[str, ...]
    default_rate: float

    @abstractmethod
    async def latest(self) -> Payload | None:
        """Return the newest payload; None when there is none at the moment."""


class CycleTopic(Topic):
    """A topic that every cycle has a sample of, and so can be streamed in full.

    Args:
        station: The station.
    """

    def __init__(self, station: Station) -> None:
        self._station = station

    @abstractmethod
    def sample(self, snapshot: Snapshot) -> Data | None:
        """Return the fields that change; None when that cycle has none."""

    @abstractmethod
    def names(self) -> list[str]:
        """Return what the numbers belong to."""

    @override
    async def latest(self) -> Payload | None:
        snapshot = self._station.snapshots.latest()
        if snapshot is None:
            return None
        data = self.sample(snapshot)
        if data is None:
            return None
        return _payload(snapshot, {"name": self.names(), **data})

    def newest_cycle(self) -> int:
        """Return the number of the last cycle; 0 before the first."""
        snapshot = self._station.snapshots.latest()
        return 0 if snapshot is None else snapshot.cycle

    def since(self, cycle: int, limit: int) -> Payload | None:
        """Return the samples after `cycle` as one batch; None when there are none.

        Args:
            cycle: Last cycle the client has.
            limit: Most cycles in one batch; the rest is for the next one.
        """
        snapshots, lost = self._station.snapshots.read_since(cycle)
        snapshots = snapshots[:limit]
        if not snapshots:
            return None
        samples = [
            {"cycle": snapshot.cycle, **data}
            for snapshot in snapshots
            if (data := self.sample(snapshot)) is not None
        ]
        batch = {"name": self.names(), "samples": samples, "lost": lost}
        return _payload(snapshots[-1], batch)


class JointStatesTopic(CycleTopic):
    """All joints, as `sensor_msgs/JointState`."""

    name = "joint_states"
    fields = ("stamp", "name", "position", "velocity", "effort")
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
    """What one controller does: desired, actual, error, output.

    Args:
        station: The station.
        controller: Its name; it must be loaded.

    Raises:
        ControllerNotFoundError: It is not loaded.
    """

    fields = ("stamp", "name", *ControllerSample._fields[1:])
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
            return self._names  # unloaded since; these are the last samples
        return self._names

    @override
    def sample(self, snapshot: Snapshot) -> Data | None:
        sample = snapshot.samples.get(self._controller)
        return None if sample is None else sample._asdict()


class ReportTopic(Topic):
    """A topic that is asked of the station in a worker thread.

    Args:
        station: The station.
    """

    def __init__(self, station: Station) -> None:
        self._station = station

    @abstractmethod
    def report(self) -> Data:
        """Return the payload's fields; may block."""

    @override
    async def latest(self) -> Payload | None:
        try:
            data = await anyio.to_thread.run_sync(self.report)
        except StationError:
            return None  # the loop is down; routes and `loop` say why
        loop = self._station.loop
        return Payload(loop.cycle, self._station.epoch, loop.time, data)


class RobotStateTopic(ReportTopic):
    """The whole state of one arm.

    Args:
        station: The station.
        arm_id: The arm.

    Raises:
        ArmNotFoundError: There is no such arm.
    """

    fields = ("arm_id", *FrankaState.model_fields)
    default_rate = 30.0

    def __init__(self, station: Station, arm_id: str) -> None:
        super().__init__(station)
        self._arms = Arms(station.robots)
        self._arms.report(arm_id)  # Refuses an unknown arm.
        self._arm_id = arm_id
        self.name = f"{ROBOT_STATE}/{arm_id}"

    @override
    def report(self) -> Data:
        state = answers.franka_state(self._arms.state(self._arm_id))
        return {"arm_id": self._arm_id, **state.model_dump()}


class ControllersTopic(ReportTopic):
    """The list of controllers."""

    name = "controllers"
    fields = ("controllers",)
    default_rate = 5.0

    @override
    def report(self) -> Data:
        return answers.controllers(self._station).model_dump()


class LoopTopic(ReportTopic):
    """How the loop does, and the stop."""

    name = "loop"
    default_rate = 2.0
    fields = ("loop", "stop", "robot_mode")

    @override
    def report(self) -> Data:
        return {
            "loop": LoopReport.model_validate(self._station.loop_report()).model_dump(),
            "stop": answers.stop_state(self._station).model_dump(),
            "robot_mode": self._station.status().robot_mode,
        }


class SceneTopic(ReportTopic):
    """The things around a simulated robot."""

    name = "scene"
    default_rate = 10.0
    fields = ("objects",)

    @override
    def report(self) -> Data:
        return Scene.model_validate({"objects": self._station.scene()}).model_dump()


def _payload(snapshot: Snapshot, data: Data) -> Payload:
    return Payload(snapshot.cycle, snapshot.epoch, snapshot.stamp, data)


_FIXED: tuple[
    type[JointStatesTopic | ControllersTopic | LoopTopic | SceneTopic], ...
] = (
    JointStatesTopic,
    ControllersTopic,
    LoopTopic,
    SceneTopic,
)


def find_topic(station: Station, name: str) -> Topic | None:
    """Return the topic of that name, or None.

    `robot_state` alone is that of the only arm.
    """
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
        pass
    return None


def topic_names(station: Station) -> list[str]:
    """Return the names of all topics there are now."""
    fixed = [kind.name for kind in _FIXED]
    arms = [f"{ROBOT_STATE}/{arm_id}" for arm_id in Arms(station.robots).names()]
    loaded = [CONTROLLER_STATE + status.name for status in station.controllers()]
    return fixed + arms + loaded
