"""Contents of the dock Controllers: actions, short texts, and parameters to load with.

The parameters are examples for each type of controller that can be loaded.
"""

from collections.abc import Collection, Iterable
from dataclasses import dataclass

from station.ui.link.station_view import StationView, resources_of
from station.wire import ControllerState

_UNITS = {
    "Position": ("rad", "m"),
    "PosVel": ("rad", "m"),
    "Velocity": ("rad/s", "m/s"),
    "Effort": ("Nm", "N"),
}
"""Units of the commands to an interface, for joints that turn and that slide."""
_PID_BY_NUMBER = {
    "1": (600, 30),
    "2": (600, 30),
    "3": (600, 30),
    "4": (600, 30),
    "5": (250, 10),
    "6": (150, 10),
    "7": (50, 5),
}
_OF_SEVERAL_JOINTS = ("Group", "Trajectory", "Streaming", "Jog")


@dataclass(frozen=True, slots=True)
class Offer:
    """The possible start of a controller.

    Attributes:
        replaces: Running controllers that must stop before it can start.
        reason: Why it cannot be started without stopping others; empty if it can.
    """

    replaces: tuple[str, ...] = ()
    reason: str = ""


def claims_text(controller: ControllerState) -> str:
    """Return the claims of a controller, short enough for a table cell."""
    parts = []
    for claim in controller.claimed_resources:
        interface = claim.hardware_interface.rpartition("::")[2]
        interface = interface.removesuffix("Interface")
        if claim.resources:
            parts.append(f"{interface}: {_joints_text(claim.resources)}")
    return "; ".join(parts) or "nothing"


def offer_for(view: StationView, controller: ControllerState) -> Offer:
    """Return the possible start of a controller."""
    if view.link != "live":
        return Offer(reason=view.blocked())
    if controller.state == "running":
        return Offer(reason="It runs. Stop it before unloading it.")
    holders = _holders(view, controller)
    if holders:
        return Offer(holders, f"Its joints are held by {', '.join(holders)}.")
    return Offer(reason=view.blocked())


def _holders(view: StationView, controller: ControllerState) -> tuple[str, ...]:
    """Return the running controllers that hold a joint of this controller.

    A Franka accepts a motion of its hand beside torques of its joints, but then the
    torques alone decide where the arm goes. So a controller of either kind counts as a
    holder of the joints of the other.
    """
    wanted = _joints_of(view, controller)
    return tuple(
        other.name
        for other in view.controllers
        if other.state == "running" and wanted & _joints_of(view, other)
    )


def _joints_of(view: StationView, controller: ControllerState) -> frozenset[str]:
    """Return the claims of a controller; a whole arm also as the joints of that arm."""
    claimed = resources_of(controller)
    arms = () if view.status is None else view.status.robots
    stems = tuple(
        f"{arm.arm_id}_joint" for arm in arms if f"{arm.arm_id}_robot" in claimed
    )
    return claimed | {name for name in view.positions if name.startswith(stems)}


def command_units(
    controller: ControllerState, sliding: Collection[str]
) -> dict[str, str]:
    """Return the unit of the commands of a controller, by joint.

    Args:
        controller: The controller.
        sliding: The joints whose positions are lengths.
    """
    units: dict[str, str] = {}
    for claim in controller.claimed_resources:
        interface = claim.hardware_interface.rpartition("::")[2]
        for kind, pair in _UNITS.items():
            if interface.startswith(kind):
                units |= {name: pair[name in sliding] for name in claim.resources}
    return units


def _joints_text(resources: list[str]) -> str:
    """Shorten `panda_joint1 … panda_joint7` to its ends when they are numbered."""
    names = sorted(resources)
    if len(names) < 3:
        return ", ".join(names)
    stem = names[0].rstrip("0123456789")
    numbers = [name.removeprefix(stem) for name in names]
    first = numbers[0]
    expected = [str(int(first or 0) + i) for i in range(len(names))]
    if first.isdigit() and numbers == expected:
        return f"{stem}{first}…{numbers[-1]}"
    return f"{names[0]} and {len(names) - 1} more"


def suggested_name(controller_type: str, taken: Iterable[str]) -> str:
    """Return a free controller name for a type, e.g. `effort_position`."""
    family, _, kind = controller_type.rpartition("/")
    base = family.removesuffix("_controllers").removesuffix("_controller") or "arm"
    for word in (
        "Position",
        "Velocity",
        "Effort",
        "Trajectory",
        "Streaming",
        "Jog",
        "Impedance",
    ):
        if word in kind and word.lower() not in base:
            base = f"{base}_{word.lower()}"
    names = set(taken)
    if base not in names:
        return base
    return next(f"{base}_{i}" for i in range(2, 1000) if f"{base}_{i}" not in names)


def example_parameters(
    controller_type: str, joints: Iterable[str], arm_id: str = ""
) -> str:
    """Return parameters in YAML that load on this robot.

    Args:
        controller_type: The type, e.g.
            `effort_controllers/JointGroupPositionController`.
        joints: The robot's joints; fingers are left out.
        arm_id: Arm whose joints a Franka controller gets; empty for those of
            the first arm.
    """
    family, _, kind = controller_type.rpartition("/")
    arm = [name for name in joints if "finger" not in name]
    if "JointState" in kind:
        return "publish_rate: 50\n"
    if not arm:
        return ""
    if family.startswith("franka_"):
        prefix = arm_id or arm[0].rpartition("_joint")[0]
        own = ", ".join(name for name in arm if name.startswith(f"{prefix}_joint"))
        return f"arm_id: {prefix}\njoint_names: [{own}]\n"
    grouped = any(word in kind for word in _OF_SEVERAL_JOINTS)
    pid = family == "effort_controllers" and "Effort" not in kind
    if not grouped:
        head = f"joint: {arm[0]}\n"
        return head + (_pid_line("pid", arm[0]) if pid else "")
    head = f"joints: [{', '.join(arm)}]\n"
    if not pid:
        return head
    return head + "".join(_joint_pid_line(name) for name in arm)


def _joint_pid_line(joint: str) -> str:
    return f"{joint}: {{{_pid_line('pid', joint).strip()}}}\n"


def _pid_line(key: str, joint: str) -> str:
    p, d = _PID_BY_NUMBER.get(joint[-1:], (100, 5))
    return f"{key}: {{p: {p}, i: 0, d: {d}}}\n"
