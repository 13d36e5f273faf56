"""The topics of a station: published ones, and those for commands of clients."""

import asyncio
import re
import time
from collections.abc import Awaitable, Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial, reduce
from operator import getitem
from typing import Any, NamedTuple

from station.api.rosbridge.ros_types import filled, time_of
from station.api.services import Services
from station.api.streams.topics import (
    ControllerStateTopic,
    CycleTopic,
    JointStatesTopic,
)
from station.api.tool_port import ToolClient
from station.core.control.controller import ControllerBase
from station.core.description.urdf import JointType, Urdf
from station.core.errors import ControllerNotFoundError, StationError
from station.core.facade.station import Station
from station.core.franka import (
    FrankaServices,
    GripperServices,
    GripperState,
    RobotMode,
)
from station.core.franka.gripper_services import Grippers
from station.core.loop.snapshot import Snapshot
from station.core.ports.set_point import SetPointPort
from station.events import Severity
from station.records.cdr import Values
from station.records.messages import transforms

LATCHED = -1.0
"""Period of a topic whose message a client gets once, when it subscribes."""
STATE_PERIOD = 0.02
"""Time between two states of a controller [s]; joint_trajectory_controller's default
is 50 Hz."""
CLOCK_PERIOD = 0.1
"""Time between two messages of the clock while station time stands still [s]."""
FINGER_PERIOD = 1.0 / 30.0
"""Time between two messages of a gripper's fingers [s]; franka_gripper's 30 Hz."""
_PUBLISHED = {
    "franka_states": "franka_msgs/FrankaState",
    "joint_states": "sensor_msgs/JointState",
    "joint_states_desired": "sensor_msgs/JointState",
    "F_ext": "geometry_msgs/WrenchStamped",
    "odom": "nav_msgs/Odometry",
    "cmd_vel_out": "geometry_msgs/TwistStamped",
    "range": "sensor_msgs/Range",
    "magnetic_field": "sensor_msgs/MagneticField",
    "gps/fix": "sensor_msgs/NavSatFix",
    "battery_state": "sensor_msgs/BatteryState",
}
# Topics of pose controllers that belong to franka_ros's examples.
_POSE_TOPICS = {
    "CartesianImpedanceExampleController": "equilibrium_pose",
    "DualArmCartesianImpedanceExampleController": "centering_frame_target_pose",
}
_LEVELS = {Severity.INFO: 2, Severity.WARNING: 4, Severity.ERROR: 8}
_MOST_EVENTS = 20
_POSE = "geometry_msgs/PoseStamped"
_TWIST = "geometry_msgs/Twist"
_JOINT_STATE = "sensor_msgs/JointState"
# Path of each element of a set-point in its message.
_PLACES = {
    **{axis: ("pose", "position", axis) for axis in "xyz"},
    **{f"q{part}": ("pose", "orientation", part) for part in "xyzw"},
    **{f"v{axis}": ("linear", axis) for axis in "xyz"},
    **{f"w{axis}": ("angular", axis) for axis in "xyz"},
    "linear_x": ("linear", "x"),
    "angular_z": ("angular", "z"),
}


def loaded_controllers(station: Station) -> Iterator[tuple[str, str, ControllerBase]]:
    """Yield name, type and object of every loaded controller."""
    for status in station.manager.conditions():
        try:
            controller = station.manager.get_controller(status.name)
        except StationError:
            continue  # unloaded meanwhile
        yield status.name, status.type, controller


class CycleFrame(NamedTuple):
    """The newest cycle.

    Attributes:
        snapshot: Snapshot of the cycle.
        stamp: Wall time of the cycle [ns since 1970].
    """

    snapshot: Snapshot
    stamp: int


Read = Callable[[CycleFrame], Values | None]
Write = Callable[[ToolClient, Values], Awaitable[None] | None]


@dataclass(slots=True)
class Topic:
    """A topic.

    Attributes:
        name: Its name.
        type: Type of its messages.
        read: Function that returns the message of a cycle, or None. None for a topic
            that other code or clients publish.
        write: Function that accepts a client's message; None for a topic to which
            clients may not publish.
        period: Time between two messages [s]; 0 for every tick, or `LATCHED`.
        in_pause: Whether it is published while station time stands still.
        blocks: Whether `write` may block, so that it needs a thread; otherwise it may
            return an awaitable.
        changes: Whether a message of a client changes the station.
        due: When the next message is due [s, clock of the event loop].
    """

    name: str
    type: str
    read: Read | None = None
    write: Write | None = None
    period: float = 0.0
    in_pause: bool = False
    blocks: bool = False
    changes: bool = True
    due: float = field(default=0.0, compare=False)


class StationTopics:
    """Provides the topics of a station. Use it in one event loop only.

    Args:
        services: The services of the API.
        urdf: The robot, for transforms; None sends no transforms.
        texts: Text by topic, such as `/robot_description`.

    Attributes:
        origin: Wall time of station time zero [ns since 1970].
    """

    def __init__(
        self,
        services: Services,
        urdf: Urdf | None,
        texts: Mapping[str, str],
    ) -> None:
        self._station = services.station
        self._cameras = services.cameras
        self._log = services.event_recorder.log
        self._logged = self._log.newest_id
        self._urdf = urdf
        self._texts = dict(texts)
        self.origin = time.time_ns() - round(self._station.loop.time * 1e9)

    def frame(self) -> CycleFrame | None:
        """Return the newest cycle; None before the first one."""
        snapshot = self._station.snapshots.latest()
        if snapshot is None:
            return None
        return CycleFrame(snapshot, self._stamp(snapshot.stamp))

    def now(self) -> int:
        """Return the present time of the station [ns since 1970]."""
        return self._stamp(self._station.loop.time)

    def _stamp(self, seconds: float) -> int:
        return self.origin + round(seconds * 1e9)

    def all(self) -> Iterator[Topic]:
        """Yield the present topics, besides those of actions."""
        states = JointStatesTopic(self._station)
        read: Read = partial(self._streamed, states, _JOINT_STATE)
        yield Topic("/joint_states", _JOINT_STATE, read)
        for name, text in self._texts.items():
            yield Topic(name, "std_msgs/String", partial(_text, text), period=LATCHED)
        if self._urdf is not None:
            joints = self._urdf.joints.items()
            fixed = {n: one for n, one in joints if one.type is JointType.FIXED}
            moving = {n: one for n, one in joints if n not in fixed}
            for name, some, period in (
                ("/tf", moving, 0.0), ("/tf_static", fixed, LATCHED)
            ):  # fmt: skip
                read = partial(self._tf, replace(self._urdf, joints=some))
                yield Topic(name, "tf2_msgs/TFMessage", read, period=period)
        yield Topic("/rosout", "rosgraph_msgs/Log", self._log_line, in_pause=True)
        if self._station.simulation.find() is not None:
            yield Topic(
                "/clock",
                "rosgraph_msgs/Clock",
                self._clock,
                period=CLOCK_PERIOD,
                in_pause=True,
            )
        for camera in self._cameras.reports():
            yield Topic(
                f"/{camera.name}/image_raw/compressed",
                "sensor_msgs/CompressedImage",
                partial(self._picture, camera.name, camera.frame or "world", [0]),
                period=1.0 / camera.rate,
                in_pause=True,
            )
        for arm_id, space in grippers_of(self._station):
            read = _Fingers(self._station, arm_id).read
            yield Topic(
                f"{space}/joint_states", _JOINT_STATE, read, period=FINGER_PERIOD
            )
        for name, type_name, controller in loaded_controllers(self._station):
            with suppress(ControllerNotFoundError):  # unloaded meanwhile
                yield from self._of_controller(name, type_name, controller)

    def _of_controller(
        self, name: str, type_name: str, controller: ControllerBase
    ) -> Iterator[Topic]:
        kind = type_name.rpartition("/")[2]
        if kind == "JointStateController":
            return  # it publishes /joint_states
        if controller.trajectories is not None:
            state = "control_msgs/JointTrajectoryControllerState"
            yield self._published(name, "state", state)
            yield Topic(
                f"/{name}/command",
                "trajectory_msgs/JointTrajectory",
                write=partial(self._follow, name),
                blocks=True,
            )
        elif len(controller.joint_names) == 1 and "p" in {
            key.rpartition("/")[2] for key in controller.tunables.values
        }:
            yield self._published(name, "state", "control_msgs/JointControllerState")
        elif controller.joint_names:
            state = "control_station_msgs/ControllerState"
            values = ControllerStateTopic(self._station, name)
            read = partial(self._streamed, values, state)
            yield Topic(f"/{name}/state", state, read, period=STATE_PERIOD)
        for topic, message in controller.published().items():
            found = _PUBLISHED.get(topic) or _kind_of(message)
            if found is not None:
                yield self._published(name, topic, found)
        if controller.set_points is not None:
            yield self._set_point_topic(name, kind, controller.set_points)

    def _published(self, name: str, topic: str, kind: str) -> Topic:
        """Return a topic with the messages of a controller, each published once."""
        last: list[object] = [None]

        def read(_: CycleFrame) -> Values | None:
            try:
                message: Any = self._station.published(name).get(topic)
            except StationError:
                return None
            if message is None or message.get("stamp") == last[0]:
                return None
            last[0] = message.get("stamp")
            if isinstance(message.get("robot_mode"), str):
                mode = RobotMode[str(message["robot_mode"]).upper()].value
                message = {**message, "robot_mode": mode}
            seconds = message.get("stamp", self._station.loop.time)
            return filled(kind, message, self._stamp(seconds))

        return Topic(f"/{name}/{topic}", kind, read)

    @staticmethod
    def _streamed(stream: CycleTopic, kind: str, frame: CycleFrame) -> Values | None:
        """Return the values that the API streams of a cycle, as a message."""
        sample = stream.sample(frame.snapshot)
        if sample is None:
            return None
        return filled(kind, {**sample, "name": stream.names()}, frame.stamp)

    def positions(self, frame: CycleFrame) -> dict[str, float]:
        """Return the position of every joint in a cycle [rad or m]."""
        names = self._station.joint_names
        return dict(zip(names, frame.snapshot.position, strict=True))

    def _tf(self, urdf: Urdf, frame: CycleFrame) -> Values:
        return transforms(urdf, self.positions(frame), frame.stamp)

    def _clock(self, frame: CycleFrame) -> Values | None:
        """Return station time while it is paused or differs in speed from wall time."""
        found = self._station.simulation.find()
        if found is None or (not found.paused and found.real_time_factor == 1.0):
            return None
        return {"clock": time_of(frame.stamp)}

    def _picture(
        self, name: str, frame_id: str, last: list[int], _: CycleFrame
    ) -> Values | None:
        """Return the newest picture of a camera, once."""
        found = self._cameras.glance(name)
        if found is None or found.number == last[0]:
            return None
        last[0] = found.number
        content = {"frame_id": frame_id, "format": "jpeg", "data": found.jpeg}
        return filled("sensor_msgs/CompressedImage", content, self._stamp(found.stamp))

    def _log_line(self, _: CycleFrame) -> Values | None:
        """Return the next event; events that had no reader are skipped."""
        if self._log.newest_id == self._logged:
            return None
        event = self._log.recent(self._logged)[-_MOST_EVENTS:][0]
        self._logged = event.id
        facts = {"msg": event.text, "function": event.what, "name": "/station"}
        return filled(
            "rosgraph_msgs/Log",
            {**facts, "level": _LEVELS[event.severity]},
            round(event.time * 1e9),
        )

    def _set_point_topic(self, name: str, kind: str, port: SetPointPort) -> Topic:
        places = [_PLACES.get(element.name, ()) for element in port.elements]
        topic, found = "command", "std_msgs/Float64MultiArray"
        if all(places):
            found = _POSE if len(places) == 7 else _TWIST
            topic = _POSE_TOPICS.get(kind, "command")
            topic = "cmd_vel" if len(places) == 2 else topic
        elif re.fullmatch(r"Joint(Position|Velocity|Effort)Controller", kind):
            found, places = "std_msgs/Float64", [("data",)]
        write = partial(self._command, name, places if all(places) else None)
        return Topic(f"/{name}/{topic}", found, write=write)

    def _command(
        self,
        name: str,
        places: list[tuple[str, ...]] | None,
        client: ToolClient,
        message: Values,
    ) -> None:
        """Send the set-point in a message to a controller.

        Args:
            name: The controller.
            places: Path of each element in the message; None for all of `data`.
            client: The client that sends the message.
            message: The message.

        Raises:
            StationError: The station refuses it.
        """
        if places is None:
            values = message["data"]
        else:
            values = [reduce(getitem, place, message) for place in places]
        with client.services.control.commanding(client.access, client.lease, name):
            self._station.motion.set_command(name, values)

    def _follow(self, name: str, client: ToolClient, message: Values) -> None:
        """Let a controller follow the trajectory in a message.

        Raises:
            StationError: The station refuses it.
        """
        control = client.services.control
        admit = partial(control.admit, client.access, client.lease, name)
        self._station.motion.follow_trajectory(
            name, self.trajectory(message), admit=admit
        )

    def trajectory(self, message: Values) -> Values:
        """Return a `trajectory_msgs/JointTrajectory` in the station's form."""
        begin = seconds_of(message["header"]["stamp"])
        keys = ("positions", "velocities", "accelerations")
        return {
            "joint_names": message["joint_names"],
            "points": [
                {key: point[key] for key in keys if point[key]}
                | {"time_from_start": seconds_of(point["time_from_start"])}
                for point in message["points"]
            ],
            # A trajectory begins at a time on the clients' clock, or at once if it is
            # 0.
            "stamp": begin - self.origin / 1e9 if begin else 0.0,
        }


class _Fingers:
    """Reads the width of a gripper in a thread, so that the event loop does not wait.

    Args:
        station: The station.
        arm_id: The arm of the gripper.
    """

    def __init__(self, station: Station, arm_id: str) -> None:
        self._ask = partial(Grippers(station.robots).state, arm_id)
        self._names = [f"{arm_id}_finger_joint{number}" for number in (1, 2)]
        self._asked: asyncio.Future[GripperState] | None = None

    def read(self, frame: CycleFrame) -> Values | None:
        """Return the last width that was read, half of it for each finger."""
        asked = self._asked
        if asked is not None and not asked.done():
            return None
        self._asked = asyncio.get_running_loop().run_in_executor(None, self._ask)
        if asked is None or asked.exception() is not None:
            return None
        half = asked.result().width / 2.0
        still = {"velocity": [0.0, 0.0], "effort": [0.0, 0.0]}
        found = {"name": self._names, "position": [half, half], **still}
        return filled(_JOINT_STATE, found, frame.stamp)


def _text(text: str, _: CycleFrame) -> Values:
    return {"data": text}


def arms_of(station: Station) -> Iterator[tuple[str, str]]:
    """Yield the arms, and the namespace of each; a single arm has franka_control's."""
    names = station.robots.names(FrankaServices)
    for arm_id in names:
        yield arm_id, "/franka_control" if len(names) == 1 else f"/{arm_id}"


def grippers_of(station: Station) -> Iterator[tuple[str, str]]:
    """Yield the arms with a gripper, and the namespace of each gripper."""
    names = station.robots.names(GripperServices)
    for arm_id in names:
        alone = len(names) == 1
        yield arm_id, "/franka_gripper" if alone else f"/{arm_id}/franka_gripper"


def seconds_of(found: Mapping[str, int]) -> float:
    """Return a time or a duration in seconds."""
    return found["sec"] + found["nanosec"] / 1e9


def _kind_of(message: Mapping[str, object]) -> str | None:
    """Return the type of a sensor's message."""
    if {"force", "torque"} <= message.keys():
        return "geometry_msgs/WrenchStamped"
    return "sensor_msgs/Imu" if "angular_velocity" in message else None
