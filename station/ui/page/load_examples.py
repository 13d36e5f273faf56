"""Example parameters for each type of controller that can be loaded."""

from collections.abc import Iterable

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
