"""Draw a root link that floats or drives: a chain of joints carries it.

With that it is drawn, also as a ghost or in a layer, as every other joint is.
"""

import math
from xml.etree import ElementTree

from station.wire import MovingBase

BASE_LINK = "station_base"
"""Name of the link to which the root link of a robot is joined; it never moves."""
_STEPS = (
    ("x", "prismatic", "1 0 0"),
    ("y", "prismatic", "0 1 0"),
    ("z", "prismatic", "0 0 1"),
    ("yaw", "continuous", "0 0 1"),
    ("pitch", "continuous", "0 1 0"),
    ("roll", "continuous", "1 0 0"),
)


def carry(robot: ElementTree.Element, root: str) -> None:
    """Let a chain of joints carry the root link of a robot.

    Args:
        robot: The robot's URDF; changed.
        root: Its root link.
    """
    parent = BASE_LINK
    ElementTree.SubElement(robot, "link", name=parent)
    for i, (step, kind, axis) in enumerate(_STEPS, start=1):
        name = _joint(step)
        child = f"{name}_link" if i < len(_STEPS) else root
        joint = ElementTree.SubElement(robot, "joint", name=name, type=kind)
        ElementTree.SubElement(joint, "parent", link=parent)
        ElementTree.SubElement(joint, "child", link=child)
        ElementTree.SubElement(joint, "axis", xyz=axis)
        if kind == "prismatic":
            bounds = {"lower": "-1e6", "upper": "1e6", "effort": "0", "velocity": "0"}
            ElementTree.SubElement(joint, "limit", bounds)
        if child != root:
            ElementTree.SubElement(robot, "link", name=child)
        parent = child


def base_positions(base: MovingBase) -> dict[str, float]:
    """Return the positions of the joints that `carry` adds.

    Args:
        base: Where the root link is.

    Returns:
        By name [m] or [rad]; empty while a reading is not finite. The angles are yaw,
        pitch and roll of the rotation Rz(yaw) Ry(pitch) Rx(roll).
    """
    values = [v for v in (*base.position, *base.orientation) if v is not None]
    if len(values) < 7:
        return {}
    *place, x, y, z, w = values
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    names = (_joint(step) for step, _, _ in _STEPS)
    return dict(zip(names, (*place, yaw, pitch, roll), strict=True))


def _joint(step: str) -> str:
    return f"{BASE_LINK}_{step}"
