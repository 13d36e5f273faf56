"""Reports of a station on itself, described once for core, API and client.

The core fills these dataclasses, the API sends them as they are, and the client reads
them back. The module needs the standard library only, so that the core stays free of
pydantic and the client free of NumPy; pydantic finds its settings and the descriptions
of the JSON schema in `Report`.
"""

import inspect
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any, ClassVar

_ATTRIBUTE = re.compile(r" {4}(\w+(?:, \w+)*): (.*)")
_EXAMPLE = "\n\nExample:\n"


def described(docstring: str | None) -> tuple[str, dict[str, str]]:
    """Return the text of a docstring, and the description of each attribute in it.

    Args:
        docstring: Docstring in Google's style; an entry `a, b: Text` describes `a` and
            `b`.
    """
    text = inspect.cleandoc(docstring or "").partition(_EXAMPLE)[0]
    text, _, section = text.partition("\n\nAttributes:\n")
    attributes: dict[str, str] = {}
    names: list[str] = []
    for line in section.partition("\n\n")[0].splitlines():
        begin = _ATTRIBUTE.fullmatch(line)
        if begin is not None:
            names = [name.strip() for name in begin[1].split(",")]
            attributes |= dict.fromkeys(names, begin[2])
        else:
            for name in names:
                attributes[name] += f" {line.strip()}"
    return " ".join(text.split()), attributes


def examples_of(docstring: str | None) -> list[dict[str, Any]]:
    """Return the JSON objects that the section `Example` of a docstring holds.

    Args:
        docstring: Docstring in Google's style. The section holds one object after the
            other, and an object may be broken into lines anywhere.
    """
    section = inspect.cleandoc(docstring or "").partition(_EXAMPLE)[2]
    rest = " ".join(section.partition("\n\n")[0].split())
    found = []
    while rest:
        values, end = json.JSONDecoder().raw_decode(rest)
        found.append(values)
        rest = rest[end:].lstrip()
    return found


class Described:
    """The base of classes whose docstring describes their fields in the JSON schema.

    The section `Attributes` becomes the descriptions of the fields, and `Example` the
    examples of the schema. Pydantic calls the method of this class, so that this module
    need not import pydantic.
    """

    __slots__ = ()

    @classmethod
    def __get_pydantic_json_schema__(
        cls,
        core_schema: Any,  # noqa: ANN401 - pydantic's, as is the handler
        handler: Any,  # noqa: ANN401
    ) -> dict[str, Any]:
        schema: dict[str, Any] = handler(core_schema)
        found = handler.resolve_ref_schema(schema)
        found["description"] = described(cls.__doc__)[0]
        examples = examples_of(cls.__doc__)
        if examples:
            found["examples"] = examples
        properties = found.get("properties", {})
        fields: dict[str, Any] = getattr(cls, "model_fields", {})
        names = {(one.alias or name): name for name, one in fields.items()}
        for kind in reversed(cls.__mro__):
            attributes = described(kind.__doc__)[1]
            for key, values in properties.items():
                if names.get(key, key) in attributes:
                    values["description"] = attributes[names.get(key, key)]
        return schema


class Report(Described):
    """The base of all reports.

    A client refuses a value that does not have the type of its field. It ignores
    unknown keys, because a newer station may add some. A number without a finite value
    is null in JSON.
    """

    __slots__ = ()
    __pydantic_config__: ClassVar = {
        "strict": True,
        "extra": "ignore",
        "allow_inf_nan": False,
    }

    @classmethod
    def __get_pydantic_core_schema__(
        cls,
        source: Any,  # noqa: ANN401 - pydantic's, as is the handler
        handler: Any,  # noqa: ANN401
    ) -> dict[str, Any]:
        # Pydantic's strict mode accepts an instance of the class only, and refuses a
        # mapping. The fields of the report stay strict.
        schema: dict[str, Any] = handler(source)
        handler.resolve_ref_schema(schema)["strict"] = False
        return schema


class TextEnum(StrEnum):
    """The base of closed sets of words in reports; each member equals its text."""

    @classmethod
    def __get_pydantic_core_schema__(
        cls,
        source: Any,  # noqa: ANN401 - pydantic's, as is the handler
        handler: Any,  # noqa: ANN401
    ) -> dict[str, Any]:
        schema: dict[str, Any] = handler(source)
        # Pydantic's strict mode accepts a member only, and refuses its text.
        handler.resolve_ref_schema(schema)["strict"] = False
        return schema


@dataclass(frozen=True, slots=True)
class Percentiles(Report):
    """Percentiles of durations since the last reset of the statistics [s].

    Without durations every number is 0.

    Attributes:
        p50: Median.
        p99: 99 of 100 are at most this.
        p999: 999 of 1000 are at most this.
        max: Longest, even if the percentiles do not include it.
        count: Number of the durations.
    """

    p50: float
    p99: float
    p999: float
    max: float
    count: int


class LoopState(TextEnum):
    """State of the control thread."""

    RUNNING = "running"
    STOPPED = "stopped"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class LoopReport(Report):
    """State of the control loop, and statistics since their last reset.

    Attributes:
        state: State of the control thread.
        failure: Traceback of the error that ended it; empty without an error.
        rate: Rate asked for [Hz].
        achieved_rate: Rate measured [Hz].
        period: Nominal period in station time [s].
        cycles: Number of cycles.
        skipped: Deadlines that had passed before their cycle could begin.
        real_time_factor: Station time over wall time, as asked for.
        achieved_real_time_factor: The real-time factor that was measured.
        lateness: How long after its deadline a cycle began [s].
        read: Time in the robot's `read` [s].
        update: Time in the controllers' `update` [s].
        write: Time in the robot's `write` [s].
        total: Time of a whole cycle [s].
        scheduler: Scheduling class that the operating system granted.
    """

    state: LoopState
    failure: str
    rate: float
    achieved_rate: float
    period: float
    cycles: int
    skipped: int
    real_time_factor: float
    achieved_real_time_factor: float
    lateness: Percentiles
    read: Percentiles
    update: Percentiles
    write: Percentiles
    total: Percentiles
    scheduler: str


@dataclass(frozen=True, slots=True)
class LoopStatistics(LoopReport):
    """The report of the control loop, and the share of each controller.

    Attributes:
        controllers: Time in the updates of each loaded controller, by name [s].
    """

    controllers: Mapping[str, Percentiles]


@dataclass(frozen=True, slots=True)
class Simulation(Report):
    """The time of a simulated robot.

    Attributes:
        paused: Station time stands still.
        real_time_factor: Station time over wall time, as asked for.
        time: Time of the simulated world [s]; a reset sets it to zero.
        steps_due: Cycles that are still to be run while paused.
        keyframes: Names of the poses that a reset can put the robot to.
    """

    paused: bool
    real_time_factor: float
    time: float
    steps_due: int
    keyframes: Sequence[str] = field(default_factory=tuple)


@dataclass(frozen=True, slots=True)
class Clearance(Report):
    """The link of an arm and the object with the least gap: distance less margin.

    Attributes:
        arm: Name of the arm.
        link: Name of the link.
        object: Name of the object, or of the other arm and its link.
        distance: Distance of their surfaces [m]; negative when they overlap.
        margin: Distance that is kept [m].
        is_slowing: Whether commands of the arm are slowed now.
        interventions: Cycles in which a command was changed, since the last change of
            the scene.
    """

    arm: str
    link: str
    object: str
    distance: float
    margin: float
    is_slowing: bool
    interventions: int


@dataclass(frozen=True, slots=True)
class SavedScene(Report):
    """A scene that is kept on disk: its objects with a role.

    Attributes:
        name: Name of the scene.
        saved_at: Wall time of the save, ISO 8601.
        objects: The objects, as `scene/objects` of the configuration has them.
    """

    name: str
    saved_at: str
    objects: Sequence[Mapping[str, object]]


@dataclass(frozen=True, slots=True)
class CameraReport(Report):
    """A camera that looks at the robots.

    Attributes:
        name: Its name.
        frame: Link that carries it; empty when it is fixed in the world.
        width: Width of its picture [px].
        height: Height of its picture [px].
        rate: Pictures per second, at most [Hz].
        fault: Reason why it has no pictures; empty when none is known.
    """

    name: str
    frame: str
    width: int
    height: int
    rate: float
    fault: str


@dataclass(frozen=True, slots=True)
class HardwareResource(Report):
    """A resource of a hardware interface.

    Attributes:
        name: Its name, e.g. that of a joint.
        claimed_by: Names of the running controllers that claim it.
    """

    name: str
    claimed_by: Sequence[str]


@dataclass(frozen=True, slots=True)
class HardwareInterface(Report):
    """A hardware interface.

    Attributes:
        name: Type, e.g. `hardware_interface::EffortJointInterface`.
        resources: Resources of the interface, by name.
    """

    name: str
    resources: Sequence[HardwareResource]


@dataclass(frozen=True, slots=True)
class ComponentInterface(Report):
    """A resource of a hardware component.

    Attributes:
        hardware_interface: Type of its interface.
        resource: Its name, e.g. that of a joint.
        is_available: Whether controllers can use it in the present state.
        claimed_by: Names of the running controllers that claim it.
    """

    hardware_interface: str
    resource: str
    is_available: bool
    claimed_by: Sequence[str] = field(default_factory=tuple)


@dataclass(frozen=True, slots=True)
class AsyncStatistics(Report):
    """Statistics of a controller or of hardware that runs in a thread of its own.

    Attributes:
        policy: `synchronized` or `detached`.
        age: For a controller, how many cycles old the states are from which its
            commands were computed; for hardware, how many cycles ago the read of its
            states began.
        missed: Updates that were left out because the update before had not ended.
        duration: How long an update takes [s].
        period: Station time from one update to the next [s].
    """

    policy: str
    age: int
    missed: int
    duration: Percentiles
    period: Percentiles


@dataclass(frozen=True, slots=True)
class HardwareComponentReport(Report):
    """A part of the robot that has a life cycle of its own.

    Attributes:
        name: Its name.
        type: `system`, `actuator` or `sensor`.
        plugin: Class of its robot, `package/Class` or `module:Class`.
        state: `unconfigured`, `inactive`, `active` or `finalized`.
        problem: The last error of a hook of its life cycle; empty without an error.
        command_interfaces: Resources that controllers can command while it is active.
        state_interfaces: Resources that controllers can read, unless unconfigured or
            finalized.
        async_update: Its reads and writes in a thread of its own; None if the control
            thread reads and writes it.
    """

    name: str
    type: str
    plugin: str
    state: str
    problem: str = ""
    command_interfaces: Sequence[ComponentInterface] = field(default_factory=tuple)
    state_interfaces: Sequence[ComponentInterface] = field(default_factory=tuple)
    async_update: AsyncStatistics | None = None


@dataclass(frozen=True, slots=True)
class HardwareTransmission(Report):
    """A transmission between actuators and joints.

    Attributes:
        name: Its name.
        type: Its type, e.g. `transmission_interface/SimpleTransmission`.
        joints: Names of its joints.
        actuators: Names of its actuators.
    """

    name: str
    type: str
    joints: Sequence[str]
    actuators: Sequence[str]


@dataclass(frozen=True, slots=True)
class ExportedValue(Report):
    """A reference or a state that a controller exports.

    Attributes:
        name: Full name, e.g. `pid_controller/joint1/position`.
        users: Names of the loaded controllers that claim the reference or read the
            state.
    """

    name: str
    users: Sequence[str]


@dataclass(frozen=True, slots=True)
class ChainedController(Report):
    """A controller with its exports, and with its place in chains.

    Attributes:
        name: Its name.
        state: State of its life cycle.
        is_in_chained_mode: Whether a running controller commands its references.
        following: Names of the controllers whose references it commands.
        references: References that it exports.
        states: States that it exports.
    """

    name: str
    state: str
    is_in_chained_mode: bool
    following: Sequence[str]
    references: Sequence[ExportedValue]
    states: Sequence[ExportedValue]


@dataclass(frozen=True, slots=True)
class ControllerChains(Report):
    """The loaded controllers, and which of them command others.

    Attributes:
        controllers: The controllers, in the order in which they are updated.
    """

    controllers: Sequence[ChainedController]


@dataclass(frozen=True, slots=True)
class GainsChange(Report):
    """A change of gains that took effect.

    Attributes:
        values: All values after the change.
        previous: All values before the change.
        revision: Revision of the new values.
        cycle: Number of the first cycle with the new values.
        notes: A sentence about each value that has no effect.
    """

    values: dict[str, float]
    previous: dict[str, float]
    revision: int
    cycle: int
    notes: Sequence[str] = field(default_factory=tuple)


@dataclass(frozen=True, slots=True)
class GainDifference(Report):
    """A gain whose saved value is not the present one.

    Attributes:
        controller: Name of the controller.
        name: Name of the gain.
        saved: Value in the set, in the unit of the gain; null when the set does not
            have this gain.
        present: Value in force, in the same unit; null when the controller is not
            loaded or has no such gain.
    """

    controller: str
    name: str
    saved: float | None
    present: float | None


@dataclass(frozen=True, slots=True)
class Waypoint(Report):
    """Joint positions that a path passes.

    Attributes:
        name: Its name, for people.
        duration: Time to it from the waypoint before, at the speed 1 [s], above 0 and
            at most 600.
        positions: Positions [rad or m] by joint; joints without one keep theirs.
    """

    name: str
    duration: float
    positions: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class WaypointPath(Report):
    """A waypoint path.

    Attributes:
        name: Its name.
        saved_at: When it was saved, ISO 8601.
        waypoints: Its waypoints, in the order in which they are passed.
    """

    name: str
    saved_at: str
    waypoints: Sequence[Waypoint]


@dataclass(frozen=True, slots=True)
class PlotSettings(Report):
    """One plot of a layout.

    Attributes:
        keys: Its channels, as the page names them, in their order.
        xy: Whether the horizontal axis is the first channel instead of time.
        span: How much time is shown [s], above 0.
        transform: Transform of the shown channels: `smooth`, `difference`, `norm`,
            `spectrum`; empty for the channels as they are.
    """

    keys: Sequence[str]
    xy: bool = False
    span: float = 10.0
    transform: str = ""


@dataclass(frozen=True, slots=True)
class DockSettings(Report):
    """Folds and sizes of the docks around the plots.

    Attributes:
        folded: The docks that are folded, as the page names them.
        side: Width of a column of docks beside the 3D view [pixels].
        below: Height of the docks below the 3D view [pixels].
        heights: Heights of the docks that a user has resized [pixels].
    """

    folded: Sequence[str]
    side: float
    below: float
    heights: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class PlotLayout(Report):
    """The plots of a page, and perhaps its docks, under a name.

    Attributes:
        name: Its name.
        saved_at: When it was saved, ISO 8601.
        plots: Its plots, from left to right.
        docks: Folds and sizes of the docks; null in a layout of plots only.
    """

    name: str
    saved_at: str
    plots: Sequence[PlotSettings]
    docks: DockSettings | None = None


class PlaybackState(TextEnum):
    """State of a path that plays. The last three are final."""

    PLAYING = "playing"
    """The robot moves."""
    PAUSED = "paused"
    """The robot holds where it was when the pause came."""
    SUCCEEDED = "succeeded"
    """The robot is at the last waypoint."""
    CANCELLED = "cancelled"
    """A caller ended it."""
    ABORTED = "aborted"
    """Its controller could not go on."""


@dataclass(frozen=True, slots=True)
class Playback(Report):
    """A path that plays, or how the last one ended.

    Attributes:
        path: Name of the path.
        controller: The trajectory controller that moves along it.
        state: `playing`, `paused`, or its end: `succeeded`, `cancelled` (by a client),
            `aborted` (it could not go on, see `message`).
        speed: Factor of all speeds, 0.05 to 2; without a unit.
        loop: Whether it begins again at its end.
        rounds: Rounds that are complete, 0 or more.
        waypoint: Number of its present target waypoint, from 0.
        waypoints: How many waypoints a round has.
        progress: Share of the round's waypoints that the robot has passed, 0 to 1.
        remaining: Time to the end of the round at the present speed [s].
        message: Why it was aborted; empty otherwise.
    """

    path: str
    controller: str
    state: PlaybackState
    speed: float
    loop: bool
    rounds: int
    waypoint: int
    waypoints: int
    progress: float
    remaining: float
    message: str


@dataclass(frozen=True, slots=True)
class ArmRecord(Report):
    """One of the last cycles of an arm before an error.

    Attributes:
        time: Time of the arm [s].
        q: Measured positions [rad], shape (7,).
        dq: Measured velocities [rad/s], shape (7,).
        tau_J: Measured torques [Nm], shape (7,).
        q_d: Desired positions [rad], shape (7,).
        tau_J_d: Desired torques [Nm], shape (7,).
        command: The last command that was sent to the arm, in the unit of its kind.
    """

    time: float
    q: Sequence[float | None]
    dq: Sequence[float | None]
    tau_J: Sequence[float | None]  # noqa: N815 - libfranka's name
    q_d: Sequence[float | None]
    tau_J_d: Sequence[float | None]  # noqa: N815
    command: Sequence[float | None]


class RehearsalOutcome(TextEnum):
    """End of a rehearsal."""

    COMPLETED = "completed"
    """Everything was carried out, and every goal was reached."""
    REFUSED = "refused"
    """The station would refuse a step."""
    FAILED = "failed"
    """The motion would end with an error."""
    UNFINISHED = "unfinished"
    """The time limit passed before the motion ended."""


class RehearsalCause(TextEnum):
    """Kind of the first error of a rehearsal."""

    REFUSED = "refused"
    """The station refuses a step."""
    REFLEX = "reflex"
    """The robot feels a contact and ends the motion."""
    LIMIT = "limit"
    """The robot ends the motion because of one of its limits."""
    TOLERANCE = "tolerance"
    """A goal is aborted, as a rule outside of its tolerances."""
    FAULT = "fault"
    """A controller fails."""
    STOP = "stop"
    """The station is stopped."""
    ENVELOPE = "envelope"
    """The motion leaves the envelope of agents, which does not bind persons."""


@dataclass(frozen=True, slots=True)
class RehearsalFault(Report):
    """The first error of a rehearsal.

    Attributes:
        cause: Kind of the error.
        cycle: Number of the cycle in which it comes.
        time: Time since the beginning [s].
        where: Joint, arm or controller concerned; empty when no part is.
        touching: Pairs of bodies that touch in that cycle and did not touch at the
            beginning.
        code: Name of the error, for programs.
        text: One sentence or more for people.
        step: Number of the step that was carried out last, from 0.
    """

    cause: RehearsalCause
    cycle: int
    time: float
    where: str
    touching: Sequence[Sequence[str]]
    code: str
    text: str
    step: int


@dataclass(frozen=True, slots=True)
class JointForecast(Report):
    """The extremes of one joint in a rehearsal.

    A margin is null where the joint has no such limit, and negative beyond it.

    Attributes:
        joint: Name of the joint.
        position: Position at the end [rad or m].
        position_margin: Least distance to the ends of its range [rad or m].
        velocity: Largest speed [rad/s or m/s].
        velocity_margin: Part of the velocity limit that is left, 0 to 1.
        effort: Largest measured effort [Nm or N].
        effort_margin: Part of the effort limit that is left.
        cut_off: Number of commands that limits have cut off.
        cut_off_cycle: Number of the first cycle with such a command; null without one.
    """

    joint: str
    position: float | None
    position_margin: float | None
    velocity: float | None
    velocity_margin: float | None
    effort: float | None
    effort_margin: float | None
    cut_off: int
    cut_off_cycle: int | None


@dataclass(frozen=True, slots=True)
class ContactForecast(Report):
    """Two bodies that touch in a rehearsal.

    Attributes:
        bodies: Their names; "world" for the floor.
        cycle: Number of the first cycle in which they touch.
        force: Largest force between them at one point [N].
    """

    bodies: Sequence[str]
    cycle: int
    force: float


@dataclass(frozen=True, slots=True)
class ClearanceForecast(Report):
    """The least distance of two bodies in a rehearsal.

    Attributes:
        bodies: Names of a link, and of an object or another robot's link.
        cycle: Number of the cycle with this distance.
        distance: Distance of their surfaces [m]; negative when they overlap.
        margin: Distance that the arm keeps from the object [m]; null for a solid body
            without a role.
    """

    bodies: Sequence[str]
    cycle: int
    distance: float
    margin: float | None


@dataclass(frozen=True, slots=True)
class Certificate(Report):
    """A guarantee: a command is carried out as it was rehearsed, or is stopped.

    Attributes:
        name: Its name, to be given with the command.
        valid_for: How long it is valid [s].
        tube: How far a joint may be from the rehearsed position [rad or m].
    """

    name: str
    valid_for: float
    tube: float


@dataclass(frozen=True, slots=True)
class Plan(Report):
    """A path without collisions, for a trajectory controller.

    Attributes:
        controller: Name of the trajectory controller.
        goal: Goal with which the controller follows the path.
        duration: How long the motion takes [s].
        direct: Whether the path is the straight line in joint space.
        planning_time: How long the planning took [s].
        joints: Names of the joints, shape (n,).
        positions: Positions along the path [rad or m], shape (k, n), the start first.
        twin: Source of the path: a `copy` of this simulated station, or a
            `model` of a real robot, which knows no more than the station.
    """

    controller: str
    goal: Mapping[str, object]
    duration: float
    direct: bool
    planning_time: float
    joints: Sequence[str]
    positions: Sequence[Sequence[float]]
    twin: str = "copy"


@dataclass(frozen=True, slots=True)
class Rehearsal(Report):
    """The result of some steps that a copy of the station has carried out.

    Attributes:
        outcome: How it ended.
        error: The first error; null without one.
        is_at_rest: Whether the joints stood still at the end.
        begin_cycle: Number of the first cycle.
        cycles: Number of cycles.
        duration: Station time of these cycles [s].
        wall_time: How long the rehearsal took [s].
        joints: Forecast for every joint.
        contacts: Pairs of bodies that touched.
        clearances: The nearest pair of a simulated robot and a solid body; and, for
            each arm that keeps clear of objects, the pair that had the least distance
            less margin.
        times: Time of each row of `positions` since the beginning [s], shape (k,).
        positions: Positions of the joints [rad or m], shape (k, n), 200 rows at most.
        digest: SHA-256 of positions, velocities and efforts of all joints in every
            cycle as doubles; the same motion has the same digest.
        certificate: Certificate with which the command is carried out as it was
            rehearsed; null when the caller did not ask for one, or the station cannot
            give one.
        twin: The robot that moved: `copy` of this simulated station, or `model` of a
            real robot, which is as good as its parameters.
    """

    outcome: RehearsalOutcome
    error: RehearsalFault | None
    is_at_rest: bool
    begin_cycle: int
    cycles: int
    duration: float
    wall_time: float
    joints: Sequence[JointForecast]
    contacts: Sequence[ContactForecast]
    clearances: Sequence[ClearanceForecast]
    times: Sequence[float]
    positions: Sequence[Sequence[float]]
    digest: str
    certificate: Certificate | None = None
    twin: str = "copy"


class Severity(TextEnum):
    """Severity of an event."""

    INFO = "info"
    """An event of ordinary operation."""
    WARNING = "warning"
    """A request was refused, a motion was stopped, or a cycle came too late."""
    ERROR = "error"
    """A part of the station or of the robot failed."""

    @property
    def rank(self) -> int:
        """Order among the severities: 0 for `INFO`."""
        return list(Severity).index(self)


class EventKind(TextEnum):
    """Subject of an event."""

    STATION = "station"
    """The station starts, ends, or could not do part of its start."""
    REQUEST = "request"
    """A change was requested, and carried out or refused."""
    LOGIN = "login"
    """A browser has logged in or out."""
    LOGIN_FAILED = "login_failed"
    """A caller showed a token that the station does not know."""
    TOKEN = "token"
    """A named token was made, revoked, or has expired."""
    CONTROL = "control"
    """The control of the station changed hands."""
    COMMAND_STREAM = "command_stream"
    """A stream of set-points began, ended or fell silent."""
    STOP = "stop"
    """The latched stop was engaged, released or armed."""
    SWITCH = "switch"
    """A switch of controllers came to its end."""
    CONTROLLER = "controller"
    """A controller was loaded or unloaded, started or stopped."""
    FAULT = "fault"
    """A controller was stopped because of a fault."""
    ROBOT_MODE = "robot_mode"
    """The robot's mode changed, e.g. to reflex."""
    OVERRUN = "overrun"
    """Several cycles in a row came too late."""
    LOOP = "loop"
    """The control loop started, ended or died."""
    WATCHDOG = "watchdog"
    """The watchdog ended, stopped watching the loop, or watches it again."""
    RECORDING = "recording"
    """A recording began or ended."""
    INCIDENT = "incident"
    """The cycles around an incident were kept."""
    EXPERIMENT = "experiment"
    """An experiment began, progressed or ended."""
    ALARM = "alarm"
    """A person has acknowledged an alarm."""
    AGENT = "agent"
    """An agent has asked for something, or a person has answered it."""
    EVENTS = "events"
    """The event log itself: events could not be written, or can be again."""


@dataclass(frozen=True, slots=True)
class Event(Report):
    """An event at the station.

    Attributes:
        id: Number of the event, from 1; goes on growing when the station restarts.
        time: Wall time [s since 1970, UTC].
        stamp: Station time [s], 0 or more; 0 before the first cycle.
        cycle: Number of the last cycle before the event; 0 before the first one.
        kind: Subject of the event, e.g. `request` (a requested change) or `fault` (of a
            controller).
        severity: `info`; `warning`: refused, stopped or too late; `error`: failed.
        who: Name of the token or person; empty for the station itself.
        where: Address that the request came from; empty for the station itself.
        what: Method and route, or the subject, such as a controller's name.
        result: Status and code of the answer, or the new state.
        text: A sentence for people.
        details: More facts as JSON, by kind.
        request_id: Name of the request, as in the header `X-Request-ID` of its answer;
            empty without a request.
        boot_id: Random name of the run of the station.

    Example:
        {"id": 17, "time": 1767225600.25, "stamp": 12.345, "cycle": 12345,
         "kind": "request", "severity": "warning", "who": "operator",
         "where": "127.0.0.1", "what": "POST /controllers/switch",
         "result": "409 resource_conflict",
         "text": "operator could not switch controllers (409 resource_conflict).",
         "details": {}, "request_id": "0f4c", "boot_id": "5b1e"}
    """

    id: int
    time: float
    stamp: float
    cycle: int
    kind: EventKind
    severity: Severity
    who: str = ""
    where: str = ""
    what: str = ""
    result: str = ""
    text: str = ""
    details: Mapping[str, object] = field(default_factory=dict)
    request_id: str = ""
    boot_id: str = ""


class Verdict(TextEnum):
    """Answer to a request of an agent."""

    ALLOWED = "allowed"
    """A person has allowed this request."""
    ALLOWED_FOR_A_TIME = "allowed_for_a_time"
    """A person has allowed it, and all that the agent asks for in the next 10 min."""
    REFUSED = "refused"
    """A person has refused it."""
    EXPIRED = "expired"
    """Nobody answered in time, or the agent has hung up."""


@dataclass(frozen=True, slots=True)
class AgentRequest(Report):
    """A request of an agent that a person allows or refuses.

    Attributes:
        number: Name of the request, for the answer.
        agent: Name of the agent.
        operation: Operation of the API that it asks for.
        target: Name of the controller or other thing to change; may be empty.
        request: Body of the request; null without one.
        asked_at: Wall time when it came [s since 1970].
        expires_at: Wall time when it is refused without an answer [s since 1970].
        verdict: The answer; null while it waits.
        decided_by: Name of the person who answered; empty without one.

    Example:
        {"number": "5f0c81e09ab3", "agent": "tuner", "operation": "submit_goal",
         "target": "position_joint_trajectory_controller", "request": {"goal": {}},
         "asked_at": 1767225600.25, "expires_at": 1767225660.25, "verdict": null,
         "decided_by": ""}
    """

    number: str
    agent: str
    operation: str
    target: str
    request: Any
    asked_at: float
    expires_at: float
    verdict: Verdict | None = None
    decided_by: str = ""
