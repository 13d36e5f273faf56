"""Find and check the `<transmission>` elements of a robot description.

Source: ros_control@633c374 transmission_parser.cpp, TransmissionParser; differs: the
reasons for skipped transmissions are kept, not only logged, and a document without a
root element is refused instead of crashing the program.
"""

from dataclasses import dataclass, field
from xml.etree import ElementTree as ET

from station.core.description.urdf_text import element_text, parse_robot_description
from station.core.errors import RobotDescriptionError


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
