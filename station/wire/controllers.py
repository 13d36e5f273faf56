"""Wire models of controllers, their types, parameters, set-points and goals."""

from typing import Annotated, Literal, Self

from pydantic import (
    AfterValidator,
    AliasChoices,
    BeforeValidator,
    Field,
    JsonValue,
    model_validator,
)

from station.reports import AsyncStatistics, GainDifference, GainsChange, Percentiles
from station.wire.base import (
    ControllerName,
    FromEnum,
    Items,
    Measured,
    Measurements,
    ParameterValues,
    Reason,
    RequestModel,
    ResponseModel,
    check_depth,
)

LOAD_TIMEOUT = 60.0
"""Default of the wall time in which a controller must be loaded [s]."""
SWITCH_BOUND = 5.0
"""Default of the wall time that a switch without a timeout may take [s]."""

ControllerStateName = Annotated[
    Literal[
        "unknown", "initialized", "running", "stopped", "waiting", "aborted", "loading"
    ],
    FromEnum,
]


SwitchStrictness = Literal["strict", "best_effort", "auto", "force_auto"]
"""Treatment of a switch that is only partly possible."""


class ClaimedResources(ResponseModel):
    """Claims of a controller on one interface (ROS: HardwareInterfaceResources).

    Attributes:
        hardware_interface: Name of the interface.
        resources: Names of the resources, usually joints.
    """

    hardware_interface: str
    resources: Items[str]


class ControllerState(ResponseModel):
    """A controller as `controller_manager_msgs/ControllerState` has it, and more.

    Attributes:
        name: Its name.
        type: Its plugin type.
        state: State of its life cycle.
        claimed_resources: Claims, per interface.
        fault: Reason why the station stopped it; null if it did not.
        traceback: Traceback that belongs to `fault`; null if there is none.
        fallback: Names of the controllers that take over when it fails.
        time: Duration of its updates [s].
        notes: Sentences about surprises for its user, such as a parameter without
            effect.
        update_rate: Rate of its updates while it runs [Hz].
        async_update: Its updates in a thread of its own; null if the control thread
            updates it.
    """

    name: str
    type: str
    state: ControllerStateName
    claimed_resources: Items[ClaimedResources]
    fault: str | None
    traceback: str | None
    fallback: Items[str]
    time: Percentiles
    notes: Items[str] = Field(default_factory=list)
    update_rate: float = 0.0
    async_update: AsyncStatistics | None = None


class Controllers(ResponseModel):
    """All loaded controllers.

    Attributes:
        controllers: The controllers, in the order in which they are updated.
    """

    controllers: Items[ControllerState]


class LoadRequest(RequestModel):
    """Load a controller.

    Attributes:
        name: Its name.
        type: Its plugin type; may be left out when the configuration has it.
        params: Its parameters as in a ros_control YAML; may be left out when the
            configuration has them.
        timeout: How long its import, constructor and init may take [s of wall time].
        unknown_params: Treatment of a parameter in `params` that its type does not
            know: `refuse`, or `tell` in the notes of the controller, for parameters
            written for ROS.

    Example:
        {"name": "arm", "type": "effort_controllers/JointGroupPositionController",
         "params": {"joints": ["panda_joint1"], "panda_joint1": {"pid": {"p": 600, "i":
         0, "d": 30}}}}
    """

    name: ControllerName
    type: str | None = Field(default=None, min_length=1, max_length=256)
    params: ParameterValues | None = None
    timeout: float = Field(default=LOAD_TIMEOUT, gt=0.0, le=3600.0)
    unknown_params: Literal["refuse", "tell"] = "refuse"


class SwitchRequest(RequestModel):
    """Start and stop controllers in one cycle.

    Attributes:
        start: Names to start.
        stop: Names to stop.
        strictness: `strict`: all or nothing; `best_effort`: the possible part; `auto`:
            like strict, and the other controllers of a chain start or stop with it;
            `force_auto`: like auto, and running controllers that claim a resource of a
            starting one are stopped.
        start_asap: Start each as soon as its joints are ready.
        timeout: How long the hardware may take [s]; 0 means as long as it takes, up to
            `bound`.
        bound: How long a switch without a timeout may take [s of wall time]; null
            means as long as the hardware takes, as in ros_control.
        dry_run: Only return the plan.

    Example:
        {"start": ["arm"], "stop": [], "strictness": "strict"}
    """

    start: list[str] = Field(default_factory=list, max_length=64)
    stop: list[str] = Field(default_factory=list, max_length=64)
    strictness: SwitchStrictness = "strict"
    start_asap: bool = False
    timeout: float = Field(default=0.0, ge=0.0, le=60.0)
    bound: float | None = Field(default=SWITCH_BOUND, gt=0.0, le=3600.0)
    dry_run: bool = False

    @model_validator(mode="after")
    def _names_something(self) -> Self:
        if not self.start and not self.stop:
            raise ValueError("name at least one controller in 'start' or 'stop'")
        return self


class SwitchResult(ResponseModel):
    """Result of a switch, or of a dry run.

    Attributes:
        ok: Whether every controller runs or stopped as planned.
        started: Names that were started.
        stopped: Names that were stopped.
        outcome: End of the switch. `committed`: all possible parts were carried out;
            `rolled_back`: what ran before runs again; `halted`: controllers of the
            switch were stopped, because the hardware carried out neither the switch
            nor its reversal.
        failed: Why a controller of the request does not run, by name.
        ignored: Why parts of a best-effort request were left out.
        order: Names of the controllers that run after the switch as planned, in the
            order of their updates.
        chained: Names of the controllers in `order` that are in chained mode.
        jump: Step from the last command before the switch to the first one after it, by
            joint, in the unit of the command; 0 for a command that slows the joint
            down.
        cycle: Cycle in which it was finished; 0 for a dry run.
        dry_run: Whether nothing was done and this is only the plan.

    Example:
        {"ok": true, "started": ["arm"], "stopped": [], "outcome": "committed",
         "failed": {}, "ignored": [], "order": ["arm"], "chained": [],
         "jump": {"panda_joint1": 0.0}, "cycle": 1234, "dry_run": false}
    """

    ok: bool
    started: Items[str]
    stopped: Items[str]
    outcome: Annotated[Literal["committed", "rolled_back", "halted"], FromEnum]
    failed: dict[str, str]
    ignored: Items[str]
    order: Items[str] = Field(default_factory=list)
    chained: Items[str] = Field(default_factory=list)
    jump: dict[str, Measured]
    cycle: int
    dry_run: bool


class Tunable(ResponseModel):
    """Unit and range of a run-time parameter.

    Attributes:
        type: Always a number.
        unit: Its unit; empty for a plain number.
        minimum: Smallest value allowed; null where unlimited.
        maximum: Largest value allowed; null where unlimited.
        description: One sentence.
    """

    type: Literal["number"] = "number"
    unit: str = ""
    minimum: Measured = None
    maximum: Measured = None
    description: Reason = ""


class Gains(ResponseModel):
    """A controller's run-time parameters.

    Attributes:
        values: Present values by name.
        tunables: Unit and range of each; called `schema` on the wire.
        revision: Counts the changes; the ETag follows it.
        etag: Value for If-Match; the same as the ETag header.
    """

    values: dict[str, float]
    tunables: dict[str, Tunable] = Field(alias="schema")
    revision: int
    etag: str


class GainsPatch(RequestModel):
    """Change some gains; all are checked together and take effect in one cycle.

    Attributes:
        values: New values by name, in the units and ranges of the gains' schema; the
            other gains stay.

    Example:
        {"values": {"panda_joint1/p": 500.0}}
    """

    values: dict[str, float] = Field(min_length=1, max_length=1024)


class CommandElement(ResponseModel):
    """One number of a set-point: its name, unit and range.

    Attributes:
        name: The commanded quantity, usually named after a joint.
        unit: Unit of the number.
        minimum: Smallest allowed value, in the unit; null where unlimited.
        maximum: Largest allowed value, in the unit; null where unlimited.
    """

    name: str
    unit: str
    minimum: Measured = None
    maximum: Measured = None


class CommandInfo(ResponseModel):
    """The elements of a controller's set-point, and the last set-point.

    Attributes:
        elements: Name, unit and range of each number, in order.
        last: The last set-point, shape (n,); null before the first.
    """

    elements: Items[CommandElement]
    last: Measurements | None = None


class CommandRequest(RequestModel):
    """A set-point.

    Attributes:
        command: One number per element, in the controller's order, in its units; null
            leaves an element at its last command.
        epoch: Epoch it was made for; refused when a stop or reset came since.
        timeout: How long it is valid [s wall time], 0 for ever; the controller's own
            when null. A parameter of the controller decides what happens then.
        rates: How fast the set-point changes, one number per element [rad/s or m/s];
            position controllers with a PID feed it forward, others refuse it.

    Example:
        {"command": [0.3, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]}
    """

    command: list[float | None] = Field(max_length=1024)
    epoch: int | None = Field(default=None, ge=0)
    timeout: float | None = Field(default=None, ge=0.0, le=3600.0)
    rates: list[float] | None = Field(default=None, max_length=1024)


class CommandAccepted(ResponseModel):
    """A set-point or a trajectory was accepted.

    Attributes:
        epoch: The epoch it counts for; a stop or reset makes it void.
        cycle: Number of the first cycle that took it into account; the samples of
            streams have the same numbers. Null when no cycle has done so yet: the
            simulation is paused, or a newer set-point came before.
    """

    epoch: int
    cycle: int | None = None


class ControllerSample(ResponseModel):
    """Values of a controller in one cycle; each array has the shape (n,).

    Attributes:
        stamp: Station time [s].
        name: Names of the elements, usually of joints.
        desired: Set-point.
        actual: Measured value, same unit.
        error: Their difference as the control law sees it.
        output: Commands written, in the unit of the hardware interface.
        published: The latest messages of the controller by topic, e.g. `state` of a
            trajectory controller, or a sensor's name; absent in streams.
    """

    stamp: float
    name: Items[str]
    desired: Measurements
    actual: Measurements
    error: Measurements
    output: Measurements
    published: dict[str, dict[str, JsonValue]] = Field(default_factory=dict)


class ReloadRequest(RequestModel):
    """Forget the imported code of controllers, so that the next load imports it anew.

    Attributes:
        force_kill: Stop and unload all controllers first; without it, the request is
            refused while controllers are loaded.

    Example:
        {"force_kill": true}
    """

    force_kill: bool = False


class Reloaded(ResponseModel):
    """Result of a reload.

    Attributes:
        unloaded: Names of the controllers that were unloaded.
    """

    unloaded: Items[str]


def list_of_tuple(value: object) -> object:
    """Return `value`, or the list of the items of a tuple."""
    return list(value) if isinstance(value, tuple) else value


class DeclaredParameter(ResponseModel):
    """A parameter of a controller, as its type declares it.

    Attributes:
        name: Path below the controller's namespace, which is also its place in `params`
            of the load request; `/` separates namespaces, and `<joint>` stands for the
            name of each joint.
        type: Type of the value: `number`, `boolean`, `string`, `numbers` and `strings`
            (lists), `number_or_numbers` (one for all, or a list with one for each),
            `mappings` (a list of objects).
        description: Purpose.
        unit: Unit of the numbers, for a quantity of joints the unit of revolute joints;
            empty without a unit.
        required: Whether loading is refused when it is absent.
        default: Value when it is absent; null when there is no fixed one.
        default_text: How the default follows from the robot or other parameters; empty
            when the default is fixed or the parameter is required.
        minimum: Smallest number allowed; null for no bound.
        excludes_minimum: Whether the number must be larger than `minimum`.
        maximum: Largest number allowed; null for no bound.
        choices: The allowed strings; empty when every string is allowed.
        size: Length that a list must have; null when any length is allowed.
        names: Kind of thing that the strings name: `joint`, `arm`, `controller`; empty
            for other strings.
    """

    name: str
    type: Annotated[
        Literal[
            "number",
            "boolean",
            "string",
            "numbers",
            "strings",
            "number_or_numbers",
            "mappings",
        ],
        FromEnum,
    ]
    description: str
    unit: str
    required: bool = Field(validation_alias=AliasChoices("required", "is_required"))
    default: Annotated[JsonValue, BeforeValidator(list_of_tuple)] = None
    default_text: str
    minimum: Measured
    excludes_minimum: bool
    maximum: Measured
    choices: Items[str]
    size: int | None
    names: Annotated[Literal["", "joint", "arm", "controller"], FromEnum]


class ControllerType(ResponseModel):
    """A plugin that can be loaded.

    Attributes:
        type: Its type, `package/Class`.
        base_class: Class of plugins that it belongs to.
        description: Purpose; empty where the type has no text.
        parameters: The parameters that it declares, after those that every controller
            has; a type of another package may read more parameters than it declares.
        error: Why its code cannot be imported; empty when it can.
    """

    type: str
    base_class: str
    description: Reason = ""
    parameters: Items[DeclaredParameter] = Field(default_factory=list)
    error: Reason = ""


class ControllerTypes(ResponseModel):
    """All plugins that can be loaded.

    Attributes:
        controller_types: The types, in the order in which they are declared.
    """

    controller_types: Items[ControllerType]


def _check_depth(value: JsonValue) -> JsonValue:
    check_depth({"value": value})
    return value


class Parameter(ResponseModel):
    """A parameter, or a namespace with all that is below it.

    Attributes:
        path: Names separated by `/`; empty for the whole tree.
        value: Its value; a namespace is an object.

    Example:
        {"path": "arm/panda_joint1/p", "value": 600.0}
    """

    path: str
    value: JsonValue


class ParameterRequest(RequestModel):
    """A new value of a parameter.

    Attributes:
        value: Any JSON, nested 32 levels deep at most; an object replaces the whole
            namespace.

    Example:
        {"value": 600.0}
    """

    value: Annotated[JsonValue, AfterValidator(_check_depth)]


GoalStatusName = Annotated[
    Literal["pending", "active", "preempted", "succeeded", "aborted"], FromEnum
]


class GoalRequest(RequestModel):
    """Give a controller a goal; it replaces the one before.

    Attributes:
        goal: The goal message of the controller's action: control_msgs/
            FollowJointTrajectoryGoal with times in seconds,
            ExecuteMotionPrimitiveSequenceGoal, or GripperCommandGoal.
        epoch: Epoch it was made for; refused when a stop or reset came since.

    Example:
        {"goal": {"trajectory": {"joint_names": ["panda_joint1", "panda_joint2"],
         "points": [{"positions": [0.3, -0.5], "time_from_start": 2.0}]},
         "goal_time_tolerance": 0.5}}
        {"goal": {"command": {"position": 0.02, "max_effort": 10.0}}}
    """

    goal: ParameterValues
    epoch: int | None = Field(default=None, ge=0)


class GoalResult(ResponseModel):
    """End of a goal.

    Attributes:
        code: Result code of the action; 0 for success, and when the goal was ended from
            outside of its controller.
        message: Why, one sentence; empty on success.
        details: The facts of the message: joint, quantity, error, tolerance, time …
    """

    code: int
    message: Reason
    details: dict[str, JsonValue]


class Goal(ResponseModel):
    """A goal and its progress.

    Attributes:
        id: Its name within the controller.
        status: Its status; the last three are final.
        progress: Part of its time that has passed, 0 to 1.
        cancel_requested: The goal is to be cancelled.
        feedback: The action's feedback while the goal is active: desired and actual
            states and errors of joints, or position and effort of a gripper.
        result: How it ended; null until then.
    """

    id: str
    status: GoalStatusName
    progress: float
    cancel_requested: bool
    feedback: dict[str, JsonValue] | None = None
    result: GoalResult | None


class Goals(ResponseModel):
    """The latest goals of a controller.

    Attributes:
        goals: The goals, oldest first.
    """

    goals: Items[Goal]


class TrajectoryRequest(RequestModel):
    """Let a controller follow a trajectory without a goal.

    Attributes:
        trajectory: trajectory_msgs/JointTrajectory with times in seconds; without
            points the joints stop and hold.
        epoch: Epoch it was made for; refused when a stop or reset came since.

    Example:
        {"trajectory": {"joint_names": ["panda_joint1", "panda_joint2"], "points":
         [{"positions": [0.3, -0.5], "time_from_start": 2.0}]}}
    """

    trajectory: ParameterValues
    epoch: int | None = Field(default=None, ge=0)


class DesiredState(ResponseModel):
    """Desired state of joints at a time, shape (n,) each.

    Attributes:
        name: The joints.
        position: [rad or m].
        velocity: [rad/s or m/s].
        acceleration: [rad/s^2 or m/s^2].
    """

    name: Items[str]
    position: Measurements
    velocity: Measurements
    acceleration: Measurements


class GainSet(ResponseModel):
    """A saved set of gains, and where it differs from the gains in force.

    Attributes:
        name: Name of the set.
        saved_at: When it was saved, ISO 8601.
        gains: Saved values by controller and gain, each in the unit of the gain.
        differences: The gains that differ; empty when the set is in force.

    Example:
        {"name": "stiff", "saved_at": "2026-11-22T09:15:00+00:00", "gains": {"arm":
         {"panda_joint1/p": 600.0}}, "differences": [{"controller": "arm", "name":
         "panda_joint1/p", "saved": 600.0, "present": 500.0}]}
    """

    name: str
    saved_at: str
    gains: dict[str, dict[str, float]]
    differences: Items[GainDifference]


class GainSets(ResponseModel):
    """The saved sets.

    Attributes:
        gain_sets: Names of the sets, sorted.
        undoable_changes: How many changes of gains can be taken back.
    """

    gain_sets: Items[str]
    undoable_changes: int = 0


class GainSetRequest(RequestModel):
    """Controllers whose gains are saved or applied.

    Attributes:
        controllers: Names of controllers; null or left out for all: all loaded ones
            when saving, all of the set when applying.

    Example:
        {"controllers": ["arm"]}
    """

    controllers: list[str] | None = Field(default=None, min_length=1, max_length=64)


class GainsOfControllersPatch(RequestModel):
    """Change gains of several controllers in one cycle, all of them or none.

    Attributes:
        changes: New values by controller and name, in the units and ranges of the
            gains' schema; the other gains stay.
        revisions: Revisions of the gains that the caller has read, by controller; the
            change is refused when a present revision differs. Null skips this check.

    Example:
        {"changes": {"arm": {"panda_joint1/p": 500.0}}, "revisions": {"arm": 4}}
    """

    changes: dict[
        str, Annotated[dict[str, float], Field(min_length=1, max_length=1024)]
    ] = Field(min_length=1, max_length=64)
    revisions: dict[str, int] | None = Field(default=None, max_length=64)


class GainsChanges(ResponseModel):
    """Changes of gains in one cycle.

    Attributes:
        changes: The change of each controller, by its name.
    """

    changes: dict[str, GainsChange]
