"""Change the description of a robot where simulation needs it, and report each change.

With `strict` a description that needs a correction is refused instead.
"""

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf
from types import MappingProxyType
from xml.etree import ElementTree as ET

from station.core.description.robot_files import RobotFiles
from station.core.description.urdf import Joint, JointLimit, Urdf
from station.core.description.urdf_repair import Repair, ZeroRange, repair_urdf
from station.core.description.urdf_text import parse_robot
from station.core.errors import HardwareInterfaceError, RobotDescriptionError
from station.core.hardware.transmissions import TransmissionInfo, TransmissionParser
from station.core.hardware.transmissions.transmission_interface_loader import (
    HARDWARE_INTERFACES,
)
from station.core.hardware.transmissions.transmission_loader import load_transmission
from station.hw.mujoco.bases import BaseType
from station.hw.mujoco.inertia import repair_inertias
from station.hw.mujoco.robot_transmissions import driven_joints, with_package
from station.hw.urdf_loader import load_urdf

_logger = logging.getLogger(__name__)
# Transmissions of pr2_mechanism_model, the first form of ros_control's.
_OLD_SIMPLE = ("SimpleTransmission",)


@dataclass(frozen=True, slots=True)
class RepairedRobot:
    """A robot that can be simulated.

    Attributes:
        description: The files of the robot, with the text of the repaired URDF.
        urdf: The repaired URDF, parsed, with the inertias that are simulated.
        repairs: The repairs of the description.
    """

    description: RobotFiles
    urdf: Urdf
    repairs: tuple[Repair, ...]


def repair_robot(
    files: RobotFiles,
    *,
    strict: bool = False,
    zero_range: ZeroRange = "lock",
    base: BaseType = "fixed",
    find_effort: Callable[[str], float | None] = lambda joint: None,  # noqa: ARG005 - no joint has another
) -> RepairedRobot:
    """Return the robot with the repairs that its simulation needs.

    Args:
        files: The robot's files.
        strict: Whether to refuse a description that needs a correction.
        zero_range: Treatment of a joint whose range is 0 to 0.
        base: How the root link is held.
        find_effort: Returns an effort limit that replaces the one in the URDF for a
            joint, >= 0 [Nm or N]; None to keep the URDF's.

    Raises:
        RobotDescriptionError: The robot cannot be simulated and no repair is known, or
            `strict` refuses a repair.
    """
    xml, repairs = repair_urdf(files.xml, zero_range, base)
    if strict:
        _refuse_repairs(files, repairs)
    files = replace(files, xml=xml)
    urdf = _with_efforts(load_urdf(files), find_effort)
    if strict:
        return RepairedRobot(files, urdf, repairs)
    xml, transmissions = _repair_transmissions(xml, urdf)
    urdf, inertias = repair_inertias(urdf)
    urdf, frictions = _repair_frictions(urdf)
    motors = tuple(
        Repair("motor", f"joint '{joint.name}'", "its effort limit is 0", "", "passive")
        for joint in urdf.joints.values()
        if joint.type.moves
        and joint.mimic is None
        and joint.limit is not None
        and joint.limit.effort == 0.0
    )
    return RepairedRobot(
        replace(files, xml=xml),
        urdf,
        repairs + inertias + frictions + motors + transmissions,
    )


def _refuse_repairs(files: RobotFiles, repairs: Sequence[Repair]) -> None:
    """Refuse a description that needs repairs, for `strict`.

    Raises:
        RobotDescriptionError: A part would have to be repaired.
    """
    # Repairs of these two kinds are no mistakes: only the simulator needs them.
    wrong = [repair for repair in repairs if repair.kind not in {"base", "name"}]
    if wrong:
        raise RobotDescriptionError(
            f"{files.urdf_path}: {wrong[0].element}: {wrong[0].problem}.",
            remedy=f"Correct the URDF. Without robot.strict, {wrong[0].new} is used.",
        )


def _with_efforts(urdf: Urdf, find_effort: Callable[[str], float | None]) -> Urdf:
    """Return the robot with the effort limits that `find_effort` replaces."""
    joints = dict(urdf.joints)
    for name, joint in urdf.joints.items():
        effort = find_effort(name)
        if effort is not None and joint.type.moves:
            limit = joint.limit or JointLimit(None, None, velocity=0.0, effort=0.0)
            joints[name] = replace(joint, limit=replace(limit, effort=effort))
    return replace(urdf, joints=MappingProxyType(joints))


def log_repairs(files: RobotFiles, repairs: Sequence[Repair]) -> None:
    """Log one line per repair; not for the control thread.

    Args:
        files: The robot's files.
        repairs: Repairs of the description.
    """
    for repair in repairs:
        # Links that never touch are expected; other changes may surprise the user.
        is_minor = repair.is_addition or repair.kind in ("self_collision", "motor")
        level = logging.INFO if is_minor else logging.WARNING
        _logger.log(level, "%s: %s", files.urdf_path, repair.sentence())


def _repair_frictions(urdf: Urdf) -> tuple[Urdf, tuple[Repair, ...]]:
    """Halve the friction of joints that their own motors cannot overcome."""
    changed: dict[str, Joint] = {}
    repairs: list[Repair] = []
    for name in driven_joints(urdf):
        joint = urdf.joints[name]
        most = joint.limit.effort if joint.limit is not None else inf
        if joint.friction < most:
            continue
        changed[name] = replace(joint, friction=most / 2.0)
        repairs.append(
            Repair(
                "friction",
                f"joint '{name}'",
                f"its friction is all that its motor can give, {most:g}",
                f"{joint.friction:g}",
                f"half of that, {most / 2.0:g}",
            )
        )
    if not changed:
        return urdf, ()
    joints = MappingProxyType({**urdf.joints, **changed})
    return replace(urdf, joints=joints), tuple(repairs)


def _repair_transmissions(xml: str, urdf: Urdf) -> tuple[str, tuple[Repair, ...]]:
    """Remove unusable transmissions, whose joints then get direct drives."""
    robot = parse_robot(xml)
    driven = set(driven_joints(urdf))
    used: set[tuple[str, str]] = set()
    repairs: list[Repair] = []
    for element in robot.findall("transmission"):
        name = element.get("name", "")
        where = f"transmission '{name}'"
        if "type" in element.attrib and element.find("type") is None:
            old = element.attrib.pop("type")
            if old.rpartition("/")[2] in _OLD_SIMPLE and _bring_up_to_date(element):
                new = "the same in today's form"
                repairs.append(
                    Repair("transmission", where, "it has the old form", old, new)
                )
            else:
                robot.remove(element)
                new = "a direct drive for each of its joints that moves"
                unknown = "its type is unknown"
                repairs.append(Repair("transmission", where, unknown, old, new))
                continue
        problem = _find_problem(element, driven, used)
        if problem is not None:
            robot.remove(element)
            kind = element.findtext("type", "").strip()
            new = "a direct drive for each of its joints that moves"
            repairs.append(Repair("transmission", where, problem, kind, new))
    if not repairs:
        return xml, ()
    return ET.tostring(robot, encoding="unicode"), tuple(repairs)


def _bring_up_to_date(element: ET.Element) -> bool:
    """Rewrite a simple transmission of the old form; False if parts are missing."""
    joint, actuator = element.find("joint"), element.find("actuator")
    reduction = element.find("mechanicalReduction")
    if joint is None or actuator is None or reduction is None:
        return False
    element.remove(reduction)
    kind = ET.SubElement(element, "type")
    kind.text = "transmission_interface/SimpleTransmission"
    interface = ET.SubElement(joint, "hardwareInterface")
    interface.text = "hardware_interface/EffortJointInterface"
    actuator.append(reduction)
    return True


def _find_problem(
    element: ET.Element, driven: set[str], used: set[tuple[str, str]]
) -> str | None:
    """Return the problem of a transmission; if it has none, add its parts to `used`."""
    robot = ET.Element("robot")
    robot.append(element)
    parser = TransmissionParser()
    infos = parser.parse(ET.tostring(robot, encoding="unicode"))
    if parser.problems or not infos:
        return (parser.problems or ["it is empty"])[0].removesuffix(".")
    info = infos[0]
    names = [joint.name for joint in info.joints]
    if not any(name in driven for name in names):
        return f"no motor can move {', '.join(names)}"
    idle = [name for name in names if name not in driven]
    if idle:
        return f"no motor can move its joint {idle[0]}"
    members = {("transmission", info.name)}
    members |= {("joint", name) for name in names}
    members |= {("actuator", actuator.name) for actuator in info.actuators}
    taken = sorted(members & used)
    if taken:
        return f"the {taken[0][0]} '{taken[0][1]}' is in use already"
    problem = _find_fault(info)
    if problem is None:
        used |= members
    return problem


def _find_fault(info: TransmissionInfo) -> str | None:
    interfaces = {
        with_package(name)
        for joint in info.joints
        for name in joint.hardware_interfaces
    }
    unknown = sorted(interfaces - set(HARDWARE_INTERFACES))
    if unknown:
        return f"its hardware interface {unknown[0]} is unknown"
    try:
        load_transmission(info)
    except HardwareInterfaceError as error:
        return error.message.removesuffix(".")
    return None
