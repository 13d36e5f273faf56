"""Wire models of the robot: interfaces, claims, limits, transmissions, clamps."""

from typing import Annotated, Literal

from pydantic import Field

from station.reports import (
    HardwareComponentReport,
    HardwareInterface,
    HardwareTransmission,
)
from station.wire.base import FromEnum, Items, Measured, RequestModel, ResponseModel

ClampReasonName = Annotated[
    Literal["position", "velocity", "acceleration", "jerk", "effort", "soft_position"],
    FromEnum,
]


RepairKindName = Literal[
    "inertia",
    "mass",
    "range",
    "mimic",
    "motor",
    "friction",
    "transmission",
    "self_collision",
    "start_pose",
    "base",
    "name",
    "armature",
    "gravity",
    "ros2_control",
]


ComponentStateName = Literal["unconfigured", "inactive", "active", "finalized"]
"""A state of a hardware component, in ros2_control's words."""


class HardwareComponentStateRequest(RequestModel):
    """Bring a hardware component into a state.

    Attributes:
        state: The state.
        stop_controllers: Whether to stop the controllers that command it first; without
            this, the request is refused while a controller commands it.

    Example:
        {"state": "inactive", "stop_controllers": true}
    """

    state: ComponentStateName
    stop_controllers: bool = False


class HardwareComponents(ResponseModel):
    """The hardware components.

    Attributes:
        components: One per part of the robot with a life cycle of its own.

    Example:
        {"components": [{"name": "left", "type": "system", "plugin":
         "franka_hw/FrankaHW", "state": "active", "problem": "", "command_interfaces":
         [{"hardware_interface": "hardware_interface::EffortJointInterface", "resource":
         "left_joint1", "is_available": true, "claimed_by": ["left_arm"]}],
         "state_interfaces": []}]}
    """

    components: Items[HardwareComponentReport]


class SoftLimits(ResponseModel):
    """Soft limits, which slow a joint down before its hard limits.

    Attributes:
        min_position: Lower bound [rad or m].
        max_position: Upper bound [rad or m].
        k_position: Velocity bound per distance to the soft bound [1/s].
        k_velocity: Effort bound per excess of velocity [Nm s/rad or N s/m].
    """

    min_position: Measured
    max_position: Measured
    k_position: float
    k_velocity: float


class HardwareLimits(ResponseModel):
    """Limits of a joint; null where it has none.

    Attributes:
        joint: Its name.
        min_position: Lower bound [rad or m].
        max_position: Upper bound [rad or m].
        max_velocity: In both directions [rad/s or m/s].
        max_acceleration: In both directions [rad/s^2 or m/s^2].
        max_jerk: In both directions [rad/s^3 or m/s^3].
        max_effort: In both directions [Nm or N].
        soft_limits: Soft limits; null without.
        sources: Source of each kind of limit; keys `position`, `velocity`,
            `acceleration`, `jerk`, `effort`, `soft`.
    """

    joint: str
    min_position: Measured
    max_position: Measured
    max_velocity: Measured
    max_acceleration: Measured
    max_jerk: Measured
    max_effort: Measured
    soft_limits: SoftLimits | None
    sources: Annotated[dict[str, str], Field(strict=False)]


class Clamp(ResponseModel):
    """Commands of a joint that limits have cut off: their number and the last one.

    Attributes:
        joint: Its name.
        hardware_interface: The interface that was commanded; `simulated brakes` when
            the brakes of a simulated joint have held its velocity.
        count: Number of cycles with such a command since the station started.
        asked: The last command that was cut off, in the unit of the interface.
        given: Command that the joint got instead.
        reason: The limit that was active.
    """

    joint: str
    hardware_interface: str
    count: int
    asked: Measured
    given: Measured
    reason: ClampReasonName


class HardwareRepair(ResponseModel):
    """A difference of the simulated robot from its description.

    Attributes:
        kind: Kind of the changed element.
        element: The element of the description.
        problem: Fault of the element.
        old: The value in the description; empty if there is none.
        new: Value that is used instead.
    """

    kind: RepairKindName
    element: str
    problem: str
    old: str
    new: str


class Hardware(ResponseModel):
    """The robot: the resources that controllers can claim, and their limits.

    Attributes:
        interfaces: Hardware interfaces with their resources.
        limits: Limits of the joints.
        transmissions: Transmissions; empty for a robot that has none.
        clamps: Commands that were cut off; empty if none ever was.
        repairs: Differences of a simulated robot from its description.

    Example:
        {"interfaces": [{"name": "hardware_interface::EffortJointInterface",
         "resources": [{"name": "elbow_joint", "claimed_by": ["arm"]}]}], "limits":
         [{"joint": "elbow_joint", "min_position": -3.14, "max_position": 3.14,
         "max_velocity": 3.15, "max_acceleration": null, "max_jerk": null, "max_effort":
         150.0, "soft_limits": null, "sources": {"position": "urdf limit", "velocity":
         "urdf limit", "effort": "parameters"}}], "transmissions": [{"name":
         "elbow_trans", "type": "transmission_interface/SimpleTransmission", "joints":
         ["elbow_joint"], "actuators": ["elbow_motor"]}], "clamps": [{"joint":
         "elbow_joint", "hardware_interface":
         "hardware_interface::EffortJointInterface", "count": 12, "asked": 400.0,
         "given": 150.0, "reason": "effort"}], "repairs": [{"kind": "range", "element":
         "joint 'wheel_joint'", "problem": "its range is empty", "old": "0 to 0", "new":
         "locked (zero_range: free lets it move)"}]}
    """

    interfaces: Items[HardwareInterface]
    limits: Items[HardwareLimits]
    transmissions: Items[HardwareTransmission]
    clamps: Items[Clamp]
    repairs: Items[HardwareRepair]
