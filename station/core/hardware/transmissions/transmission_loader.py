"""Find the `<transmission>` elements of a robot, check them, and build transmissions.

Source: ros_control@633c374 transmission_parser.cpp, TransmissionParser;
transmission_loader.cpp, simple_transmission_loader.cpp,
differential_transmission_loader.cpp, four_bar_linkage_transmission_loader.cpp; differs:
the reasons for skipped transmissions are kept, not only logged, and a document without
a root element is refused instead of crashing the program.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.metadata import entry_points
from typing import TypeVar
from xml.etree import ElementTree as ET

from station.core.description.urdf_text import (
    element_text,
    parse_leading_number,
    parse_robot_description,
)
from station.core.errors import RobotDescriptionError
from station.core.hardware.transmissions.transmission import (
    DifferentialTransmission,
    FourBarLinkageTransmission,
    SimpleTransmission,
    Transmission,
    TransmissionInterfaceError,
)


@dataclass(frozen=True, slots=True)
class JointInfo:
    """A joint of a transmission.

    Attributes:
        name: Name of the joint.
        role: Role of the joint, such as "joint1"; empty if there is none.
        hardware_interfaces: Names of the interfaces through which it is commanded, at
            least one, such as "hardware_interface/EffortJointInterface".
        element: The XML element, which holds the parameters of the type.
    """

    name: str
    role: str
    hardware_interfaces: tuple[str, ...]
    element: ET.Element = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ActuatorInfo:
    """An actuator of a transmission.

    Attributes:
        name: Name of the actuator.
        hardware_interfaces: Names of the interfaces that the document gives for it;
            may be empty.
        element: The XML element, which holds the parameters of the type.
    """

    name: str
    hardware_interfaces: tuple[str, ...]
    element: ET.Element = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TransmissionInfo:
    """The description of a transmission.

    Attributes:
        name: Name of the transmission.
        type: Its type, such as "transmission_interface/SimpleTransmission".
        joints: Its joints in the order of the document, at least one.
        actuators: Its actuators in the order of the document, at least one.
    """

    name: str
    type: str
    joints: tuple[JointInfo, ...]
    actuators: tuple[ActuatorInfo, ...]


class TransmissionParser:
    """Find the transmissions of a robot description.

    As the original does, it skips a transmission that it cannot read, and continues
    with the next one.

    Attributes:
        problems: The reasons for the elements skipped in the last `parse`.
    """

    def __init__(self) -> None:
        self.problems: list[str] = []

    def parse(self, urdf: str) -> list[TransmissionInfo]:
        """Return all transmissions that can be read, in the order of the document.

        Args:
            urdf: The robot description.

        Returns:
            The transmissions; `problems` has the reasons for skipped elements.

        Raises:
            RobotDescriptionError: The description is not XML.
        """
        self.problems = []
        try:
            root = parse_robot_description(urdf)
        except RobotDescriptionError as exc:
            raise RobotDescriptionError(
                f"Can't parse transmissions. Invalid robot description. {exc.message}",
                remedy=exc.remedy,
            ) from exc
        infos = [self._parse_transmission(e) for e in root.findall("transmission")]
        return [info for info in infos if info is not None]

    def _parse_transmission(self, element: ET.Element) -> TransmissionInfo | None:
        name = self._parse_name(element, "transmission")
        if not name:
            return None
        type_element = element.find("type")
        if type_element is None:
            self.problems.append(f"No type element found in transmission '{name}'.")
            return None
        type_name = element_text(type_element)
        if not type_name:
            self.problems.append(
                f"Skipping empty type element in transmission '{name}'."
            )
            return None
        joints = self._parse_joints(element)
        if not joints:
            self.problems.append(f"Failed to load joints for transmission '{name}'.")
            return None
        actuators = self._parse_actuators(element)
        if not actuators:
            self.problems.append(f"Failed to load actuators for transmission '{name}'.")
            return None
        return TransmissionInfo(name, type_name, tuple(joints), tuple(actuators))

    def _parse_joints(self, transmission: ET.Element) -> list[JointInfo]:
        joints = []
        for element in transmission.findall("joint"):
            name = self._parse_name(element, "joint")
            if name is None:
                return []
            interfaces = _parse_hardware_interfaces(element)
            if name and not interfaces:
                self.problems.append(
                    f"No valid hardware interface element found in joint '{name}'."
                )
            if name and interfaces:
                role = element.find("role")
                role_name = "" if role is None else element_text(role)
                joints.append(JointInfo(name, role_name, interfaces, element))
        return joints

    def _parse_actuators(self, transmission: ET.Element) -> list[ActuatorInfo]:
        actuators = []
        for element in transmission.findall("actuator"):
            name = self._parse_name(element, "actuator")
            if name is None:
                return []
            if name:
                interfaces = _parse_hardware_interfaces(element)
                actuators.append(ActuatorInfo(name, interfaces, element))
        return actuators

    def _parse_name(self, element: ET.Element, kind: str) -> str | None:
        name = element.get("name")
        if name is None:
            self.problems.append(f"No name attribute specified for {kind}.")
        elif not name:
            self.problems.append(f"Empty name attribute specified for {kind}.")
        return name


def _parse_hardware_interfaces(element: ET.Element) -> tuple[str, ...]:
    names = [element_text(child) for child in element.findall("hardwareInterface")]
    return tuple(name for name in names if name)


_Member = TypeVar("_Member", JointInfo, ActuatorInfo)
TransmissionFactory = Callable[[TransmissionInfo], Transmission]


def load_simple_transmission(info: TransmissionInfo) -> SimpleTransmission:
    """Build a transmission from one actuator's reduction and one joint's offset.

    Args:
        info: The description of the transmission.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: An element is missing or wrong, or there are too
            many joints or actuators.
    """
    _check_dimension(info, 1)
    reduction = _read_required(info, "Actuator", info.actuators[0])
    offset = _read_number(info, "Joint", info.joints[0], "offset", 0.0)
    with _naming(info):
        return SimpleTransmission(reduction, offset)


def load_differential_transmission(info: TransmissionInfo) -> DifferentialTransmission:
    """Build a differential transmission from reductions and offsets by role.

    Args:
        info: The description of the transmission.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: An element is missing or wrong, or there are too
            many joints or actuators.
    """
    reductions, joint_reductions, offsets = _read_two_by_two(info)
    ignored = [j.element.find("ignoreTransmissionAbsoluteEncoder") for j in info.joints]
    with _naming(info):
        return DifferentialTransmission(
            reductions,
            joint_reductions,
            offsets,
            ignore_transmission_for_absolute_encoders=None not in ignored,
        )


def load_four_bar_linkage_transmission(
    info: TransmissionInfo,
) -> FourBarLinkageTransmission:
    """Build a four-bar linkage transmission from reductions and offsets by role.

    Args:
        info: The description of the transmission.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: An element is missing or wrong, or there are too
            many joints or actuators.
    """
    parameters = _read_two_by_two(info)
    with _naming(info):
        return FourBarLinkageTransmission(*parameters)


TRANSMISSION_TYPES: Mapping[str, TransmissionFactory] = {
    "transmission_interface/SimpleTransmission": load_simple_transmission,
    "transmission_interface/DifferentialTransmission": load_differential_transmission,
    "transmission_interface/FourBarLinkageTransmission": (
        load_four_bar_linkage_transmission
    ),
}
"""The types that every robot knows."""

ENTRY_POINT_GROUP = "station.transmissions"
"""Group of entry points through which installed packages add types. An entry's name is
the type; its object takes a `TransmissionInfo` and returns a `Transmission`."""


def load_transmission(
    info: TransmissionInfo, types: Mapping[str, TransmissionFactory] | None = None
) -> Transmission:
    """Build the transmission of a description.

    Args:
        info: The description of the transmission.
        types: Further types, tried before those of this module and of entry points.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: The type is unknown, or the description is wrong.
    """
    known = {**TRANSMISSION_TYPES, **(types or {})}
    factory = known.get(info.type)
    # Own types first: a package cannot exchange a type of ros_control.
    if factory is None:
        for entry in entry_points(group=ENTRY_POINT_GROUP, name=info.type):
            factory = entry.load()
    if factory is None:
        raise TransmissionInterfaceError(
            f"Failed to load transmission '{info.name}'. "
            f"Unsupported type '{info.type}'.",
            remedy=f"Use one of {', '.join(sorted(known))}, or install a package with "
            f"an entry point '{info.type}' in the group '{ENTRY_POINT_GROUP}'.",
            details={"transmission": info.name},
        )
    return factory(info)


def _read_two_by_two(
    info: TransmissionInfo,
) -> tuple[list[float], list[float], list[float]]:
    """Return actuator reductions, joint reductions and joint offsets, by role."""
    _check_dimension(info, 2)
    actuators = _order_by_role(info, "actuator", info.actuators)
    reductions = [_read_required(info, "Actuator", a) for a in actuators]
    joints = _order_by_role(info, "joint", info.joints)
    joint_reductions, offsets = [], []
    for joint in joints:
        joint_reductions.append(
            _read_number(info, "Joint", joint, "mechanicalReduction", 1.0)
        )
        offsets.append(_read_number(info, "Joint", joint, "offset", 0.0))
    return reductions, joint_reductions, offsets


@contextmanager
def _naming(info: TransmissionInfo) -> Iterator[None]:
    # Errors of the constructor lack the name of the transmission.
    try:
        yield
    except TransmissionInterfaceError as exc:
        raise TransmissionInterfaceError(
            f"Failed to construct transmission '{info.name}' of type "
            f"'{info.type.replace('/', '::')}'. {exc.message}",
            remedy=exc.remedy,
            details={"transmission": info.name},
        ) from exc


def _check_dimension(info: TransmissionInfo, expected: int) -> None:
    for kind, count in (
        ("actuators", len(info.actuators)),
        ("joints", len(info.joints)),
    ):
        if count != expected:
            raise TransmissionInterfaceError(
                f"Invalid description for transmission '{info.name}' of type "
                f"'{info.type}'. Expected {expected} {kind}, got {count}.",
                remedy=f"Give the transmission {expected} {kind}.",
                details={"transmission": info.name},
            )


def _order_by_role(
    info: TransmissionInfo, kind: str, members: Sequence[_Member]
) -> list[_Member]:
    expected = [f"{kind}1", f"{kind}2"]
    roles = []
    for member in members:
        element = member.element.find("role")
        where = f"{kind.title()} '{member.name}' of transmission '{info.name}'"
        if element is None:
            raise _wrong(info, f"{where} does not specify the required <role> element.")
        role = element_text(element)
        if not role:
            raise _wrong(info, f"{where} specifies an empty <role> element.")
        if role not in expected:
            raise _wrong(
                info,
                f"{where} does not specify a valid <role> element. Got '{role}', "
                f"expected '{expected[0]}' or '{expected[1]}'.",
            )
        roles.append(role)
    if roles[0] == roles[1]:
        raise _wrong(
            info,
            f"{kind.title()}s '{members[0].name}' and '{members[1].name}' of "
            f"transmission '{info.name}' must have different roles. "
            f"Both specify '{roles[0]}'.",
        )
    ordered = list(members)
    return ordered if roles == expected else ordered[::-1]


def _read_required(info: TransmissionInfo, kind: str, member: _Member) -> float:
    return _read_number(info, kind, member, "mechanicalReduction", None)


def _read_number(
    info: TransmissionInfo,
    kind: str,
    member: _Member,
    tag: str,
    default: float | None,
) -> float:
    element = member.element.find(tag)
    where = f"{kind} '{member.name}' of transmission '{info.name}'"
    if element is None:
        if default is None:
            raise _wrong(
                info, f"{where} does not specify the required <{tag}> element."
            )
        return default
    number = parse_leading_number(element_text(element))
    if number is None:
        raise _wrong(
            info, f"{where} specifies the <{tag}> element, but is not a number."
        )
    return number


def _wrong(info: TransmissionInfo, message: str) -> TransmissionInterfaceError:
    return TransmissionInterfaceError(
        message,
        remedy=f'Correct the <transmission name="{info.name}"> element.',
        details={"transmission": info.name},
    )
