"""The URDF of an arm, which libfranka 0.14 and newer ask for in place of a library.

These versions compute the dynamics from the URDF and, from 0.18 on, the velocity limits
that depend on the positions of the joints. Links and joints have no prefix: those
clients look for `link8`, and add the end effector and the load of the state themselves.
The URDF therefore has no hand, and no shapes, which the clients do not read.

Source: libfranka@0.20.4 src/joint_velocity_limits.cpp,
JointVelocityLimitsConfig::parseFromURDF; src/robot_model.cpp; test/fr3.urdf.
"""

from collections.abc import Sequence
from math import atan2
from xml.etree import ElementTree

from station.core.description.robot_files import RobotFiles
from station.core.description.urdf import Inertial
from station.hw.franka.arm.arm_description import find_prefix
from station.hw.franka.arm.arm_limits import ArmLimits
from station.hw.franka.arm.franka_kinematics import CHAIN, DOF
from station.hw.franka.simulated.franka_dynamics import read_bodies
from station.hw.urdf_loader import load_urdf

# Deceleration for an arm whose limits do not depend on the position [rad/s^2]: so large
# that it matters only in the last 4 microradians before a position limit.
_NO_DECELERATION_LIMIT = 1e6


def write_robot_model(description: RobotFiles, limits: ArmLimits, name: str) -> str:
    """Return the URDF of an arm as an FCI client reads it.

    Args:
        description: The URDF of a Franka arm, with or without a hand.
        limits: Limits of this kind of arm.
        name: Name of the robot, e.g. `fr3`; one that begins with `tmr` would be taken
            for a mobile robot.

    Raises:
        RobotDescriptionError: The URDF does not describe a Franka arm.
    """
    # Refuses any other arm: the kinematics that are written are a Franka's.
    read_bodies(description)
    prefix, links = find_prefix(description), load_urdf(description).links
    robot = ElementTree.Element("robot", name=name)
    for number in range(DOF + 2):
        link = ElementTree.SubElement(robot, "link", name=f"link{number}")
        found = links.get(f"{prefix}link{number}")
        # Bodies that a URDF fixes to the flange belong to the end effector of the
        # state.
        if found is not None and found.inertial is not None and number <= DOF:
            _add_inertial(link, found.inertial)
    for number in range(1, DOF + 2):
        _add_joint(robot, number, limits)
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode")


def _add_inertial(link: ElementTree.Element, inertial: Inertial) -> None:
    element = ElementTree.SubElement(link, "inertial")
    origin = inertial.origin
    _add(element, "origin", xyz=_row(origin.xyz), rpy=_row(origin.rpy()))
    _add(element, "mass", value=inertial.mass)
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    _add(element, "inertia", **dict(zip(names, inertial.inertia, strict=True)))


def _add_joint(robot: ElementTree.Element, number: int, limits: ArmLimits) -> None:
    """Add a joint that turns about z, or the fixed one behind the seventh."""
    kind = "revolute" if number <= DOF else "fixed"
    joint = ElementTree.SubElement(robot, "joint", name=f"joint{number}", type=kind)
    index = number - 1
    a, d, cosine, sine = CHAIN[4 * index : 4 * index + 4]
    # A turn about x, then the way along the turned x and z.
    place = (a, -d * sine, d * cosine)
    _add(joint, "origin", xyz=_row(place), rpy=_row((atan2(sine, cosine), 0.0, 0.0)))
    _add(joint, "parent", link=f"link{index}")
    _add(joint, "child", link=f"link{number}")
    if number > DOF:
        return
    _add(joint, "axis", xyz="0 0 1")
    offset, slope = 0.0, 2.0 * _NO_DECELERATION_LIMIT
    upper, lower = limits.upper[index], limits.lower[index]
    if limits.curves:
        offset, slope, upper, lower = limits.curves[index]
    effort, velocity = limits.torque[index], limits.velocity[index]
    _add(joint, "limit", lower=lower, upper=upper, velocity=velocity, effort=effort)
    _add(
        joint,
        "position_based_velocity_limits",
        velocity_offset=offset,
        deceleration_limit=slope / 2.0,
    )


def _add(parent: ElementTree.Element, tag: str, **values: str | float) -> None:
    ElementTree.SubElement(parent, tag, {k: str(value) for k, value in values.items()})


def _row(values: Sequence[float]) -> str:
    return " ".join(str(value) for value in values)
