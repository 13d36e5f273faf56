"""A robot's report on itself: limits, transmissions, clamped commands, scene."""

from collections.abc import Mapping
from dataclasses import dataclass

from station.core.hardware.limits.joint_limits import JointLimits, SoftJointLimits
from station.core.hardware.limits.joint_limits_handle import Clamp, JointLimitsHandle


@dataclass(frozen=True, slots=True)
class JointLimitsReport:
    """The limits of one joint, and their sources.

    Attributes:
        joint: Name of the joint.
        limits: Hard limits.
        soft_limits: Soft limits, before which the joint is slowed down; None if the
            joint has none.
        sources: Source of each kind of limit that the joint has, such as "urdf limit"
            or "parameters"; keys are "position", "velocity", "acceleration", "jerk",
            "effort" and "soft".
    """

    joint: str
    limits: JointLimits
    soft_limits: SoftJointLimits | None
    sources: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class ClampReport:
    """The commands of a joint that limits have changed.

    Attributes:
        hardware_interface: The interface that was commanded.
        count: Number of cycles with such a command since the station started, > 0.
        last: The latest such command.
    """

    hardware_interface: str
    count: int
    last: Clamp


@dataclass(frozen=True, slots=True)
class SceneObjectReport:
    """An object in a simulated world, at its present pose.

    Attributes:
        name: Name of the object.
        kind: `box`, `sphere`, `cylinder`, `table` or `mesh`.
        size: Edges of a box or table; radius of a sphere; radius and height of a
            cylinder [m]; empty for a mesh.
        position: Position of its centre in the world [m], shape (3,).
        orientation: Unit quaternion x, y, z, w in the world.
        mass: Mass [kg]; 0 for an object that cannot move.
        file: File of a mesh.
        role: `object`, `keep_out` or `fence`.
        margin: Distance that arms keep from it, unless it is an `object` [m].
        links: Links that the role is for; empty for all.
        colour: Red, green and blue, 0 to 255; empty for the colour of its role.
        solid: Whether a simulated robot can touch it.
        carried_by: Name of the arm that carries it; empty for none.
    """

    name: str
    kind: str
    size: tuple[float, ...]
    position: tuple[float, ...]
    orientation: tuple[float, ...]
    mass: float
    file: str
    role: str = "object"
    margin: float = 0.0
    links: tuple[str, ...] = ()
    colour: tuple[int, ...] = ()
    solid: bool = True
    carried_by: str = ""


@dataclass(frozen=True, slots=True)
class MovingBaseReport:
    """The pose of a simulated robot's root link that is not fixed to the world.

    Attributes:
        link: Name of the root link.
        position: Position of its frame in the world [m], shape (3,).
        orientation: Unit quaternion x, y, z, w in the world.
    """

    link: str
    position: tuple[float, ...]
    orientation: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class ContactReport:
    """A point at which two bodies of a simulated world touch.

    Attributes:
        bodies: Names of the two bodies; "world" for the floor.
        position: The point in the world [m], shape (3,).
        force: Force on the second body in the last step, in the axes of the world [N],
            shape (3,); the first body feels the opposite.
    """

    bodies: tuple[str, str]
    position: tuple[float, ...]
    force: tuple[float, ...]


def limit_values(
    limits: JointLimits, soft_limits: SoftJointLimits | None
) -> dict[str, object]:
    """Return the limits that are set, by kind, so that they can be compared.

    Args:
        limits: Hard limits.
        soft_limits: Soft limits, or None.

    Returns:
        Values by the keys of `JointLimitsReport.sources`.
    """
    has_range = limits.has_position_limits
    values: dict[str, object] = {
        "position": (limits.min_position, limits.max_position) if has_range else None,
        "velocity": limits.max_velocity,
        "acceleration": limits.max_acceleration,
        "jerk": limits.max_jerk,
        "effort": limits.max_effort,
        "soft": soft_limits,
    }
    return {kind: value for kind, value in values.items() if value is not None}


def report_clamps(
    handles: Mapping[tuple[str, str], JointLimitsHandle],
) -> list[ClampReport]:
    """Return the commands that limits have changed. Any thread.

    Args:
        handles: The limits by joint and hardware interface; the mapping is final.

    Returns:
        One entry per handle that has changed a command.
    """
    reports = []
    for (_, hardware_interface), handle in handles.items():
        last = handle.last_clamp
        if last is not None:
            # The count grows after the clamp is stored, so it may be one behind.
            count = max(1, handle.clamp_count)
            reports.append(ClampReport(hardware_interface, count, last))
    return reports
