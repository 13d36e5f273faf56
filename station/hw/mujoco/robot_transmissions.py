"""Read the transmissions of a URDF, and add the missing ones.

Source: gazebo_ros_control@2.9.2 default_robot_hw_sim.cpp, DefaultRobotHWSim::initSim,
for names of interfaces without package; differs: a transmission that cannot be loaded
is refused and not skipped, every type of transmission works, and a joint has the
command interfaces of all three kinds, whatever its transmission names.
"""

import logging
from dataclasses import replace
from typing import NoReturn
from xml.etree import ElementTree

from station.core.description.robot_files import RobotFiles
from station.core.description.urdf import JointType, Urdf
from station.core.errors import RobotDescriptionError
from station.core.hardware.transmissions import (
    ActuatorInfo,
    JointInfo,
    TransmissionInfo,
    TransmissionParser,
)

_logger = logging.getLogger(__name__)
DEFAULT_TYPE = "transmission_interface/SimpleTransmission"
_PACKAGE = "hardware_interface/"
_COMMAND_INTERFACES = tuple(
    f"{_PACKAGE}{kind}JointInterface" for kind in ("Position", "Velocity", "Effort")
)


def driven_joints(urdf: Urdf) -> list[str]:
    """Return the joints that have a motor in the simulation, in the file's order."""
    return [
        joint.name
        for joint in urdf.joints.values()
        if joint.type is not JointType.FIXED
        and joint.mimic is None
        and (joint.limit is None or joint.limit.effort > 0.0)
    ]


def read_transmissions(description: RobotFiles, urdf: Urdf) -> list[TransmissionInfo]:
    """Return a transmission for every driven joint, in the joints' order.

    A joint without a transmission gets a simple transmission with reduction 1. A
    transmission is left out if each of its joints is missing, fixed, a mimic joint or a
    joint with an effort limit of 0.

    Args:
        description: The robot description.
        urdf: The robot description, parsed.

    Raises:
        RobotDescriptionError: A `<transmission>` is incomplete, has a joint with a
            motor and a joint without a motor, or shares a joint or actuator with
            another transmission.
    """
    parser = TransmissionParser()
    infos = parser.parse(description.xml)
    if parser.problems:
        _refuse(description, "<transmission>", parser.problems[0])
    driven = driven_joints(urdf)
    kept = [
        _with_all_interfaces(info)
        for info in infos
        if _is_driven(info, driven, urdf, description)
    ]
    _check_distinct(description, kept)
    named = {joint.name for info in kept for joint in info.joints}
    kept += [_default(joint) for joint in driven if joint not in named]
    order = {name: number for number, name in enumerate(driven)}
    return sorted(kept, key=lambda info: min(order[j.name] for j in info.joints))


def _is_driven(
    info: TransmissionInfo,
    driven: list[str],
    urdf: Urdf,
    description: RobotFiles,
) -> bool:
    known = [joint.name in driven for joint in info.joints]
    others = [j.name for j in info.joints if j.name not in driven]
    if any(known) and others:
        where = f'<transmission name="{info.name}">'
        what = "cannot move" if others[0] in urdf.joints else "is missing"
        _refuse(description, where, f"its joint {others[0]!r} {what}")
    if others:
        _logger.warning(
            "transmission %s is left out: no motor can move %s", info.name, others
        )
    return not others


def _check_distinct(description: RobotFiles, infos: list[TransmissionInfo]) -> None:
    seen: set[tuple[str, str]] = set()
    for info in infos:
        members = [("transmission", info.name)]
        members += [("joint", joint.name) for joint in info.joints]
        members += [("actuator", actuator.name) for actuator in info.actuators]
        for member in members:
            if member in seen:
                _refuse(
                    description,
                    f'<transmission name="{info.name}">',
                    f"the {member[0]} {member[1]!r} is in use already",
                )
            seen.add(member)


def with_package(interface: str) -> str:
    """Return the name of a hardware interface with its package."""
    return interface if "/" in interface else f"{_PACKAGE}{interface}"


def _with_all_interfaces(info: TransmissionInfo) -> TransmissionInfo:
    joints = []
    for joint in info.joints:
        named = [with_package(name) for name in joint.hardware_interfaces]
        interfaces = tuple(dict.fromkeys([*named, *_COMMAND_INTERFACES]))
        joints.append(replace(joint, hardware_interfaces=interfaces))
    return replace(info, joints=tuple(joints))


def _default(joint: str) -> TransmissionInfo:
    actuator = ElementTree.Element("actuator")
    ElementTree.SubElement(actuator, "mechanicalReduction").text = "1"
    element = ElementTree.Element("joint")
    return TransmissionInfo(
        f"{joint}_transmission",
        DEFAULT_TYPE,
        (JointInfo(joint, "", _COMMAND_INTERFACES, element),),
        (ActuatorInfo(f"{joint}_motor", (), actuator),),
    )


def _refuse(description: RobotFiles, element: str, reason: str) -> NoReturn:
    raise RobotDescriptionError(
        f"{description.urdf_path}: {element}: {reason.removesuffix('.')}.",
        remedy="Correct that element of the URDF.",
    )
