"""The sections of a configuration, with the types and ranges of their values.

`default.yaml` holds the defaults. Types are strict: `"600"` is not a number and `true`
is not 1.
"""

from collections.abc import Callable
from math import hypot, inf
from typing import Annotated, Any, Literal, Self, cast

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    model_validator,
)
from pydantic_core import PydanticCustomError

from station.core.loop.simulation_speed import FASTEST, SLOWEST

NAME_PATTERN = r"^[A-Za-z0-9_]+$"
PLUGIN_PATTERN = r"^[A-Za-z_][\w.]*[/:][A-Za-z_]\w*$"
MODULE_PATTERN = r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)*$"
ORIGIN_PATTERN = r"^https?://([A-Za-z0-9.-]+|\[[0-9A-Fa-f:.]+\])(:[0-9]{1,5})?$"
Name = Annotated[str, Field(pattern=NAME_PATTERN)]
"""A name without namespaces, as `ControllerManager` takes it."""
Port = Annotated[int, Field(ge=0, le=65535)]
"""A TCP port; 0 for any free one."""
PluginType = Annotated[str, Field(pattern=PLUGIN_PATTERN)]
"""`package/Class` or `module:Class`."""

ModuleName = Annotated[str, Field(pattern=MODULE_PATTERN)]
"""A Python module; the name of a package stands for all modules in it."""


WebOrigin = Annotated[str, Field(pattern=ORIGIN_PATTERN)]
"""Scheme, host and port of a web page, without a path: `https://lab.example:8443`."""

FileName = Annotated[str, Field(min_length=1)]
"""A file; relative to the working directory."""


def _word_of_switch(value: object) -> object:
    """Return `off` for False, to which YAML 1.1 converts the word `off`."""
    return "off" if value is False else value


RehearsalPolicy = Annotated[
    Literal["off", "advise", "required"], BeforeValidator(_word_of_switch)
]
"""Policy of rehearsals: whether a motion must be rehearsed before."""


class _Section(BaseModel):
    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, allow_inf_nan=False
    )


def _within(lower: float, upper: float) -> Callable[[float], float]:
    """Return a check of a number; its error names both ends of the range."""

    def check(value: float) -> float:
        if not lower <= value <= upper:
            raise PydanticCustomError(
                "outside_of_range",
                "Input should be {lower} to {upper}",
                {"lower": f"{lower:g}", "upper": f"{upper:g}"},
            )
        return value

    return check


def _update_budget(value: object) -> object:
    """Return `value` if it is a budget; the error names all that is allowed.

    Without this check there would be one error for each member of the union.

    Raises:
        PydanticCustomError: It is none.
    """
    if value is None or value == "period":
        return value
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if is_number and 0.0 < cast("float", value) < inf:
        return value
    raise PydanticCustomError(
        "no_budget", "Input should be a number greater than 0, 'period' or null"
    )


class LoopSection(_Section):
    """The control loop.

    Attributes:
        rate: Cycles per second of station time [Hz].
        real_time_factor: Station time over wall time, 0.01 to 100.
        update_budget: How long an update of one controller may take [s wall time];
            `period` for the period of the loop, None for no budget.
        controller_modules: Python modules whose controllers may be loaded as
            `module:Class` while the station runs.
        hardware_components_initial_state: Names of the hardware components that do not
            begin in the active state, by their initial states.
    """

    rate: float = Field(ge=1.0, le=10_000.0)
    real_time_factor: Annotated[float, AfterValidator(_within(SLOWEST, FASTEST))]
    update_budget: Annotated[
        float | Literal["period"] | None, BeforeValidator(_update_budget)
    ]
    controller_modules: list[ModuleName]
    hardware_components_initial_state: dict[
        Literal["unconfigured", "inactive"], list[str]
    ] = Field(default_factory=dict)

    def longest_update(self) -> float:
        """Return the longest allowed update [s wall time]; infinite for no budget."""
        if self.update_budget is None:
            return inf
        if self.update_budget == "period":
            return 1.0 / self.rate
        return self.update_budget


class RobotSection(_Section):
    """The robot; its class checks everything except the type.

    Attributes:
        type: `package/Class` or `module:Class`.
    """

    model_config = ConfigDict(extra="allow")

    type: PluginType


class SceneSection(_Section):
    """The objects around the robots, and their roles.

    Attributes:
        objects: Boxes, spheres, cylinders, capsules, half-spaces, tables and meshes;
            `core.geometry.scene` checks them.
        arm_margin: Distance that arms keep from each other [m]; None for none.
    """

    objects: list[dict[str, Any]]
    arm_margin: float | None = None


class Controller(_Section):
    """A controller's parameters; its class checks all of them except the type.

    Attributes:
        type: `package/Class` or `module:Class`.
    """

    model_config = ConfigDict(extra="allow")

    type: PluginType


class TlsSection(_Section):
    """Certificate and key of the server; the configuration has both files or none.

    Attributes:
        certificate: PEM file with the certificate chain; None serves without TLS.
        key: PEM file with the private key, without a password.
    """

    certificate: FileName | None = None
    key: FileName | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> Self:
        if (self.certificate is None) != (self.key is None):
            raise PydanticCustomError(
                "half_of_tls", "Input should be both certificate and key, or neither"
            )
        return self


class ApiSection(_Section):
    """The REST and WebSocket server.

    Attributes:
        host: Address to listen at.
        port: TCP port; 0 for any free one.
        token: The operator's token; with None the station makes a random one.
        tls: Certificate and key; with them the server speaks https and wss only.
        allowed_origins: Origins of web pages from other servers that may use the API.
    """

    host: str = Field(min_length=1, pattern=r"^[A-Za-z0-9.:_-]+$")
    port: Port
    token: str | None = Field(min_length=8, pattern=r"^[A-Za-z0-9._~+/=-]+$")
    tls: TlsSection = Field(default_factory=TlsSection)
    allowed_origins: list[WebOrigin] = Field(default_factory=list)


class UiSection(_Section):
    """The dashboard.

    Attributes:
        enabled: Whether to start it.
        port: TCP port at the API's host; 0 for any free one.
        reconnect_window: Time for which the dashboard keeps its sessions after a crash
            of the station, and waits for the next station [s]; then the dashboard ends.
    """

    enabled: bool
    port: Port
    reconnect_window: float = Field(ge=0.0, le=3600.0)


class WatchdogSection(_Section):
    """The process beside the station that watches whether the control loop runs.

    Attributes:
        enabled: Whether to start it.
        notice_after: Age of the loop's last wake-up that counts as a standstill [s];
            two periods of the loop if that is more.
        end_after: Duration of a standstill after which the watchdog ends the station
            [s]; null never ends it, e.g. for a debugger.
    """

    enabled: bool
    notice_after: float = Field(ge=0.02, le=10.0)
    end_after: float | None = Field(ge=1.0, le=3600.0)


class RecordsSection(_Section):
    """Recordings of every cycle, and incidents.

    Attributes:
        enabled: Whether the station can record, and keeps incidents.
        directory: Folder of the files; null for the folder in the user's home.
        max_bytes: Most bytes of all recordings together.
        max_count: Most recordings.
        incidents: Number of the newest incidents that are kept; 0 keeps none.
    """

    enabled: bool
    directory: str | None
    max_bytes: int = Field(ge=1_000_000)
    max_count: int = Field(ge=1, le=100_000)
    incidents: int = Field(ge=0, le=10_000)


class ToolPortSection(_Section):
    """The server for tools of one protocol: Foxglove, or clients of rosbridge.

    Attributes:
        enabled: Whether to start it.
        host: Address to listen at. From other machines a client needs a token.
        port: TCP port; 0 for any free one.
        allowed_origins: Origins of web pages that may connect, e.g. that of Foxglove.
    """

    enabled: bool
    host: str = Field(min_length=1, pattern=r"^[A-Za-z0-9.:_-]+$")
    port: Port
    allowed_origins: list[str] = Field(default_factory=list)


class RehearsalSection(_Section):
    """Policies of rehearsals, and how closely a motion must follow its rehearsal.

    Attributes:
        operator: Policy for operators.
        agent: Policy for tokens of the role `agent`.
        pose_tolerance: When the command is given, how far a joint may be from its
            position at the begin of the rehearsal [rad or m].
        tube: How far a joint may be from the rehearsed motion [rad or m].
    """

    operator: RehearsalPolicy
    agent: RehearsalPolicy
    pose_tolerance: float = Field(gt=0.0, le=0.5)
    tube: float = Field(gt=0.0, le=0.5)


class FciSection(_Section):
    """The Franka Control Interface beside the loop.

    Attributes:
        enabled: Whether programs of libfranka can connect to the simulated arm.
        host: Address to listen at; the port is libfranka's. There are no tokens.
        version: The only version of the protocol; None accepts the version that a
            client asks for.
        desk: TCP port of Desk, Franka's web interface; None starts no Desk.
    """

    enabled: bool
    host: str = Field(min_length=1, pattern=r"^[A-Za-z0-9.:_-]+$")
    version: int | None = Field(default=None, ge=5, le=10)
    desk: int | None = Field(default=None, ge=1, le=65535)


def _in_order(ends: tuple[float, float]) -> tuple[float, float]:
    low, high = ends
    if not low < high:
        raise PydanticCustomError(
            "range_out_of_order", "Input should be two numbers, the lower one first"
        )
    return ends


# YAML has no tuples, so a range may be a list; its numbers stay strict.
Range = Annotated[tuple[float, float], Field(strict=False), AfterValidator(_in_order)]
"""The lower and the upper end of a range."""


class EnvelopeSection(_Section):
    """Bounds on the motions of agents, in addition to the robot's limits.

    Attributes:
        joints: Range of positions by joint [rad or m]; other joints have only the
            robot's limits.
        workspace: Ranges of x, y and z of end effectors in the base frame of their arm
            [m].
        speed: Highest speed of any joint [rad/s or m/s]; None for the robot's limits
            only.
        force: Highest force of a contact [N]; None for no bound.
    """

    joints: dict[str, Range] = Field(default_factory=dict)
    workspace: dict[Literal["x", "y", "z"], Range] = Field(default_factory=dict)
    speed: float | None = Field(default=None, gt=0.0)
    force: float | None = Field(default=None, ge=0.0)


class AgentsSection(_Section):
    """Programs with a token of the role `agent`.

    Attributes:
        approval: `always`: a person allows each change; `never`: no person is asked,
            which is possible only in a simulation that is paused and stepped.
        wait: How long a request waits for a person [s].
        envelope: Bounds on the motions of agents.
    """

    approval: Literal["always", "never"] = "always"
    wait: float = Field(default=60.0, gt=0.0, le=600.0)
    envelope: EnvelopeSection = Field(default_factory=EnvelopeSection)


Vector = Annotated[list[float], Field(min_length=3, max_length=3)]
"""Three coordinates."""


class CameraSection(_Section):
    """A simulated camera, whose pictures show the robots at their present poses.

    Attributes:
        frame: Link that carries it; empty when it is fixed in the world.
        position: Its position in that frame [m], shape (3,).
        target: Point of that frame in the middle of its picture [m], shape (3,).
        up: Direction in that frame that points up in its picture, shape (3,).
        fov: Angle between the upper and the lower edge of its picture [rad].
        width: Width of its picture [px].
        height: Height of its picture [px].
        rate: Pictures per second, at most, while a client reads them [Hz].
    """

    frame: str = ""
    position: Vector
    target: Vector
    up: Vector = [0.0, 0.0, 1.0]
    fov: float = Field(default=0.8, gt=0.01, lt=3.0)
    width: int = Field(default=320, ge=16, le=1920)
    height: int = Field(default=240, ge=16, le=1080)
    rate: float = Field(default=5.0, gt=0.0, le=30.0)

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        x, y, z = (t - p for t, p in zip(self.target, self.position, strict=True))
        a, b, c = self.up
        area = hypot(y * c - z * b, z * a - x * c, x * b - y * a)
        if area < 1e-9 * max(1.0, hypot(x, y, z) * hypot(a, b, c)):
            raise PydanticCustomError(
                "no_direction",
                "Input should have a target beside the position, and an up that does "
                "not point there",
            )
        return self


class StationConfig(_Section):
    """The whole configuration from which a station is built.

    Attributes:
        station: The control loop.
        robot: The robot.
        scene: The objects around a simulated robot.
        controllers: Controllers to load, by name.
        start: Names of the controllers to start, in order.
        parameters: Other parameters of the controller files (`joint_limits` …), which
            controllers and robots may read.
        ros_controllers: Names of the controllers from files written for ROS, which may
            have parameters that no controller of the station knows.
        api: The server.
        ui: The dashboard.
        watchdog: The process beside the station.
        records: Recordings and incidents.
        foxglove: The server for Foxglove.
        rosbridge: The server for clients of rosbridge.
        agents: Programs that ask people before they change anything.
        fci: The server for programs of libfranka.
        rehearsal: Policies of rehearsals before motions.
        cameras: Cameras, by name.
        arguments: Values of `$(var NAME)` in parameter files, by name.
    """

    station: LoopSection
    robot: RobotSection
    scene: SceneSection
    controllers: dict[Name, Controller]
    start: list[str]
    api: ApiSection
    ui: UiSection
    watchdog: WatchdogSection
    records: RecordsSection
    foxglove: ToolPortSection
    rosbridge: ToolPortSection
    agents: AgentsSection = Field(default_factory=AgentsSection)
    fci: FciSection
    rehearsal: RehearsalSection
    cameras: dict[Name, CameraSection] = Field(default_factory=dict)
    arguments: dict[str, str] = Field(default_factory=dict)
    parameters: dict[str, Any] = Field(default_factory=dict, exclude=True)
    ros_controllers: frozenset[str] = Field(default=frozenset(), exclude=True)

    def controller_modules(self) -> frozenset[str]:
        """Return the modules whose controllers may be loaded as `module:Class`.

        These are the modules that the configuration lists, and the modules that the
        types of its controllers name.
        """
        types = (controller.type for controller in self.controllers.values())
        named = (kind.partition(":")[0] for kind in types if ":" in kind)
        return frozenset((*self.station.controller_modules, *named))

    def robot_parameters(self) -> dict[str, object]:
        """Return the robot's parameters, `type` among them."""
        return self.robot.model_dump()

    def controller_parameters(self) -> dict[str, dict[str, object]]:
        """Return each controller's parameters, `type` among them."""
        return {name: c.model_dump() for name, c in self.controllers.items()}
