"""What a configuration may hold.

Defaults are in `default.yaml`, and there alone. Types are strict: `"600"` is no number
and `true` is no 1.
"""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
"""What ROS allows as a name without namespaces."""
Port = Annotated[int, Field(ge=0, le=65535)]
"""A TCP port; 0 for any free one."""
FRANKA_HW = "franka_hw/FrankaHW"


class _Section(BaseModel):
    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, allow_inf_nan=False
    )


class LoopSection(_Section):
    """The control loop.

    Attributes:
        rate: Cycles per second of station time [Hz].
        real_time_factor: Station time over wall time.
    """

    rate: float = Field(ge=1.0, le=10_000.0)
    real_time_factor: float = Field(gt=0.0, le=100.0)


class FrankaRobot(_Section):
    """FrankaHW, by upstream's parameter names.

    Attributes:
        type: `franka_hw/FrankaHW`.
        arm_id: Prefix of the joint names.
        robot_description: `example-robot-data:<name>` or the path to a URDF.
        joint_names: The seven joints; `<arm_id>_joint1…7` when left out.
    """

    type: Literal["franka_hw/FrankaHW"]
    arm_id: Name
    robot_description: str = Field(min_length=1)
    joint_names: list[str] | None = Field(default=None, min_length=7, max_length=7)


class OtherRobot(_Section):
    """A robot whose parameters its own class checks.

    Attributes:
        type: `package/Class` or `module:Class`.
    """

    model_config = ConfigDict(extra="allow")

    type: str = Field(pattern=r"^[A-Za-z_][\w.]*[/:][A-Za-z_]\w*$")


def _robot_kind(value: object) -> str:
    # Given what was read when validating, a model when serialising.
    kind = value.get("type") if isinstance(value, dict) else getattr(value, "type", 0)
    return "other" if isinstance(kind, str) and kind != FRANKA_HW else "franka"


Robot = Annotated[
    Annotated[FrankaRobot, Tag("franka")] | Annotated[OtherRobot, Tag("other")],
    Discriminator(_robot_kind),
]


class Controller(_Section):
    """A controller's parameters; all but the type are for its class to check.

    Attributes:
        type: `package/Class` or `module:Class`.
    """

    model_config = ConfigDict(extra="allow")

    type: str = Field(pattern=r"^[A-Za-z_][\w.]*[/:][A-Za-z_]\w*$")


class ApiSection(_Section):
    """The REST and WebSocket server.

    Attributes:
        host: Address to listen at.
        port: TCP port.
        token: The operator's token; a random one when None.
    """

    host: str = Field(min_length=1, pattern=r"^[A-Za-z0-9.:_-]+$")
    port: Port
    token: str | None = Field(min_length=8, pattern=r"^[A-Za-z0-9._~+/=-]+$")


class UiSection(_Section):
    """The dashboard.

    Attributes:
        enabled: Whether to start it.
        port: TCP port, at the API's host.
    """

    enabled: bool
    port: Port


class StationConfig(_Section):
    """Everything a station is built from.

    Attributes:
        station: The control loop.
        robot: The robot.
        controllers: Controllers to load, by name.
        start: Names of those to start, in order.
        parameters: Other parameters of the controller files (`joint_limits` …), which
            controllers and robots may read.
        api: The server.
        ui: The dashboard.
    """

    station: LoopSection
    robot: Robot
    controllers: dict[Name, Controller]
    start: list[str]
    api: ApiSection
    ui: UiSection
    parameters: dict[str, Any] = Field(default_factory=dict, exclude=True)

    def robot_parameters(self) -> dict[str, object]:
        """Return the robot's parameters, `type` among them."""
        return self.robot.model_dump(exclude_none=True)

    def controller_parameters(self) -> dict[str, dict[str, object]]:
        """Return each controller's parameters, `type` among them."""
        return {name: c.model_dump() for name, c in self.controllers.items()}
