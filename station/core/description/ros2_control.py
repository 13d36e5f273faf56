"""Read the `<ros2_control>` elements of a URDF: hardware, its joints, sensors, GPIOs.

Each element describes one hardware component by its plug-in, and lists the interfaces
that controllers may command and read.

Source: ros2_control@6.x hardware_interface/src/component_parser.cpp; differs: a number
that cannot be read is refused and not skipped, and arrays are refused.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NoReturn
from xml.etree.ElementTree import Element

from station.core.description.urdf import JointType
from station.core.description.urdf_parser import read_joint_type
from station.core.description.urdf_text import element_text, parse_decimal
from station.core.errors import RobotDescriptionError

TAG = "ros2_control"
_TYPES = ("system", "actuator", "sensor")
_INTEGERS = tuple(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32))
_DATA_TYPES = ("double", "float32", "bool", *_INTEGERS)
_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


@dataclass(frozen=True, slots=True)
class InterfaceTag:
    """A `<command_interface>` or `<state_interface>`.

    Attributes:
        name: Its name, e.g. `position`.
        minimum: Smallest command in the unit of the interface; None if there is none.
        maximum: Largest command; None if there is none.
        initial_value: Value at the start; None if there is none.
        data_type: `double`, `bool`, or another type of numbers.
        is_limited: False if its limits are switched off.
    """

    name: str
    minimum: float | None = None
    maximum: float | None = None
    initial_value: float | None = None
    data_type: str = "double"
    is_limited: bool = True


@dataclass(frozen=True, slots=True)
class ComponentTag:
    """A `<joint>`, `<sensor>` or `<gpio>` of a hardware component.

    Attributes:
        name: Its name.
        commands: Its command interfaces.
        states: Its state interfaces.
        parameters: Its `<param>` elements.
        is_mimic: The attribute `mimic` of a joint; None without it.
    """

    name: str
    commands: tuple[InterfaceTag, ...] = ()
    states: tuple[InterfaceTag, ...] = ()
    parameters: Mapping[str, str] = field(default_factory=dict)
    is_mimic: bool | None = None

    def initial_value(self, interface: str) -> float | None:
        """Return the initial value of a state interface; None if there is none."""
        for one in self.states:
            if one.name == interface:
                return one.initial_value
        return None


@dataclass(frozen=True, slots=True)
class HardwareTag:
    """A `<ros2_control>` element: one hardware component.

    Attributes:
        name: Its name.
        type: `system`, `actuator` or `sensor`.
        plugin: Class that drives it, `package/Class`.
        parameters: Parameters of the plug-in.
        joints: Its joints.
        sensors: Its sensors.
        gpios: Its general-purpose inputs and outputs.
        transmissions: Its `<transmission>` elements, in the form of ROS 2.
        timing: By name, the attributes of the element and of `<properties>` that set
            how it is read and written, if not in every cycle.
    """

    name: str
    type: str
    plugin: str
    parameters: Mapping[str, str]
    joints: tuple[ComponentTag, ...]
    sensors: tuple[ComponentTag, ...]
    gpios: tuple[ComponentTag, ...]
    transmissions: tuple[Element, ...]
    timing: Mapping[str, str] = field(default_factory=dict)


def read_ros2_control(robot: Element) -> tuple[HardwareTag, ...]:
    """Return the hardware components that a URDF describes, in its order.

    Args:
        robot: The `<robot>` element.

    Raises:
        RobotDescriptionError: An element is incomplete or contradicts the joints of the
            URDF; the message names the component and the element.
    """
    joints = {one.get("name", ""): one for one in robot.findall("joint")}
    found = [_Reader(element, joints).read() for element in robot.findall(TAG)]
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            _refuse(name, "is there twice")
    return tuple(found)


class _Reader:
    """Reads one component."""

    def __init__(self, element: Element, joints: Mapping[str, Element]) -> None:
        self._element = element
        self._joints = joints
        self._name = element.get("name", "").strip()

    def read(self) -> HardwareTag:
        kind = self._attribute(self._element, "type")
        self._attribute(self._element, "name")
        if kind not in _TYPES:
            self._refuse(f"has the type '{kind}'; allowed are {', '.join(_TYPES)}")
        parts: dict[str, list[Element]] = {}
        for child in self._element:
            # A comment is a node, too; its tag is not a string.
            if isinstance(child.tag, str):
                parts.setdefault(child.tag, []).append(child)
        known = ("hardware", "properties", "joint", "sensor", "gpio", "transmission")
        for tag in parts:
            if tag not in known:
                self._refuse(f"has the unknown element <{tag}>")
        hardware = parts.get("hardware", [])
        plugin = hardware[0].find("plugin") if hardware else None
        if plugin is None or not element_text(plugin):
            self._refuse("has no <hardware> with a <plugin>")
        return HardwareTag(
            self._name,
            kind,
            element_text(plugin),
            self._parameters(hardware[0]),
            self._check_joints([self._component(e) for e in parts.get("joint", ())]),
            tuple(self._component(e) for e in parts.get("sensor", ())),
            tuple(self._component(e) for e in parts.get("gpio", ())),
            tuple(parts.get("transmission", ())),
            self._timing(parts.get("properties", ())),
        )

    def _timing(self, properties: Sequence[Element]) -> Mapping[str, str]:
        found: dict[str, str] = {}
        for key, value in self._element.attrib.items():
            if key == "is_async":
                if self._boolean(value, key):
                    found[key] = value
            elif key == "rw_rate":
                rate = parse_decimal(value)
                if rate is None or rate < 0.0:
                    self._refuse(f"has '{value}' for rw_rate; it must be 0 or more")
                # A rate of 0 means the rate of the manager.
                found |= {key: value} if rate else {}
            elif key == "thread_priority":
                found[key] = value
            elif key not in {"name", "type"}:
                self._refuse(f"has the unknown attribute '{key}'")
        for each in properties:
            for part in each.iter("async"):
                found |= {f"async {key}": value for key, value in part.items()}
        return found

    def _component(self, element: Element) -> ComponentTag:
        name = self._attribute(element, "name")
        mimic = element.get("mimic")
        is_limited = self._is_limited(element)

        def interfaces(tag: str) -> tuple[InterfaceTag, ...]:
            return tuple(
                self._interface(name, each, is_limited=is_limited)
                for each in element.findall(tag)
            )

        return ComponentTag(
            name,
            interfaces("command_interface"),
            interfaces("state_interface"),
            self._parameters(element),
            None if mimic is None else self._boolean(mimic, f"mimic of '{name}'"),
        )

    def _interface(
        self, component: str, element: Element, *, is_limited: bool
    ) -> InterfaceTag:
        name = self._attribute(element, "name")
        what = f"{component}/{name}"
        values = self._parameters(element)
        data_type = element.get("data_type", "double").strip()
        if data_type not in _DATA_TYPES:
            self._refuse(f"has {what} of the unknown data type '{data_type}'")
        if element.get("size", "1").strip() != "1":
            self._refuse(f"has {what} as an array, which is not supported")
        numbers: dict[str, float | None] = {}
        for key in ("min", "max", "initial_value"):
            text = values.get(key, "")
            number = parse_decimal(text)
            if text.lower() in {"true", "false"}:
                number = float(_BOOLEANS[text.lower()])
            if text and number is None:
                self._refuse(f"has {key} of {what} as '{text}', not a number")
            numbers[key] = number
        low, high = numbers["min"], numbers["max"]
        if low is not None and high is not None and low > high:
            self._refuse(f"has min {low:g} of {what} above max {high:g}")
        return InterfaceTag(
            name,
            low,
            high,
            numbers["initial_value"],
            data_type,
            is_limited and self._is_limited(element),
        )

    def _check_joints(self, tags: Sequence[ComponentTag]) -> tuple[ComponentTag, ...]:
        names = [tag.name for tag in tags]
        for tag in tags:
            joint = self._joints.get(tag.name)
            if joint is None:
                self._refuse(f"has the joint '{tag.name}', which the URDF has not")
            if read_joint_type(joint) is JointType.FIXED:
                self._refuse(f"has the joint '{tag.name}', which is fixed")
            mimic = joint.find("mimic")
            if mimic is None:
                if tag.is_mimic:
                    self._refuse(f"says that '{tag.name}' mimics; the URDF does not")
            elif tag.is_mimic is not False:
                if tag.commands:
                    self._refuse(
                        f"commands the joint '{tag.name}', which mimics another one"
                    )
                if mimic.get("joint") not in names:
                    self._refuse(
                        f"lacks the joint '{mimic.get('joint')}', which '{tag.name}' "
                        "mimics"
                    )
        return tuple(tags)

    def _parameters(self, element: Element) -> Mapping[str, str]:
        return {
            self._attribute(each, "name"): element_text(each)
            for each in element.findall("param")
        }

    def _is_limited(self, element: Element) -> bool:
        limits = element.find("limits")
        if limits is None:
            return True
        return self._boolean(self._attribute(limits, "enable"), "<limits>")

    def _boolean(self, text: str, what: str) -> bool:
        value = _BOOLEANS.get(text.strip().lower())
        if value is None:
            self._refuse(f"has '{text}' for {what}; it must be true or false")
        return value

    def _attribute(self, element: Element, key: str) -> str:
        value = element.get(key, "").strip()
        if not value:
            self._refuse(f"has a <{element.tag}> without the attribute '{key}'")
        return value

    def _refuse(self, problem: str) -> NoReturn:
        _refuse(self._name, problem)


def _refuse(name: str, problem: str) -> NoReturn:
    raise RobotDescriptionError(
        f'<{TAG} name="{name}"> {problem}.',
        remedy="Correct that element of the URDF; run xacro first if it comes from it.",
        details={"component": name},
    )
