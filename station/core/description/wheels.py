"""The wheels of a base with two driven sides, read from its URDF.

Source: ros_controllers@678b92a diff_drive_controller.cpp, setOdomParamsFromUrdf and
getWheelRadius.
"""

from math import dist

from station.core.description.urdf import Joint, Shape, Urdf
from station.core.errors import RobotDescriptionError


def wheel_separation(urdf: Urdf, left: str, right: str) -> float:
    """Return the distance between the origins of two wheel joints [m].

    Args:
        urdf: The robot.
        left: Name of the left wheel's joint.
        right: Name of the right wheel's joint; both hang on the same link.

    Raises:
        RobotDescriptionError: There is no such joint, or the distance is 0.
    """
    first, second = _joint(urdf, left), _joint(urdf, right)
    distance = dist(first.origin.xyz, second.origin.xyz)
    if distance == 0.0:
        raise RobotDescriptionError(
            f"The wheel joints '{left}' and '{right}' have the same origin.",
            remedy="Give the parameter wheel_separation.",
        )
    return distance


def wheel_radius(urdf: Urdf, joint: str) -> float:
    """Return the radius of a wheel, the link that a joint turns [m].

    Args:
        urdf: The robot.
        joint: Name of the wheel's joint.

    Raises:
        RobotDescriptionError: There is no such joint, or the first collision shape of
            its link is neither a cylinder nor a sphere.
    """
    link = urdf.links[_joint(urdf, joint).child]
    shape: Shape | None = link.collisions[0] if link.collisions else None
    if shape is None or shape.kind not in ("cylinder", "sphere"):
        found = "none" if shape is None else shape.kind
        raise RobotDescriptionError(
            f"The wheel '{link.name}' has as first collision shape {found}; a radius "
            "can be read from a cylinder or a sphere.",
            remedy="Give the parameter wheel_radius.",
            details={"link": link.name},
        )
    return shape.size[0]


def _joint(urdf: Urdf, name: str) -> Joint:
    joint = urdf.joints.get(name)
    if joint is None:
        raise RobotDescriptionError(
            f"The robot description has no joint '{name}'.",
            remedy=f"It has: {', '.join(urdf.joints) or 'none'}.",
            details={"resource": name},
        )
    return joint
