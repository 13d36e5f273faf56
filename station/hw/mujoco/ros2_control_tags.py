"""Use the `<ros2_control>` elements of a URDF for the simulated robot.

Plug-ins of simulators and mocks are replaced by the simulated robot. So is a driver of
real hardware, and a repair names it. The elements list everything that controllers may
command: joints that they do not name hold their positions.

Source: mujoco_ros2_control docs/hardware_interface.rst; gz_ros2_control doc/index.rst;
ros2_control@6.x mock_components_userdoc.rst, joint_limiting.rst.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from xml.etree import ElementTree as ET

from station.core.description.robot_files import RobotFiles
from station.core.description.ros2_control import (
    ComponentTag,
    HardwareTag,
    InterfaceTag,
    read_ros2_control,
)
from station.core.description.urdf_parser import read_joint_limit
from station.core.description.urdf_repair import Repair
from station.core.description.urdf_text import element_text, parse_robot
from station.core.errors import RobotDescriptionError
from station.hw.mujoco.mujoco_robot_parameters import SensorRequest, SensorType

_SIMULATED = (
    "mujoco_ros2_control/",
    "gz_ros2_control/",
    "ign_ros2_control/",
    "gazebo_ros2_control/",
    "mock_components/",
    "fake_components/",
    "topic_based_ros2_control/",
    "isaac_ros2_control/",
)
"""Packages of plug-ins that simulate hardware, or replace it."""
# In mujoco_ros2_control these three words mean the same.
_QUANTITIES = {
    "position": "position",
    "velocity": "velocity",
    "effort": "effort",
    "torque": "effort",
    "force": "effort",
}
_LIMITS_ONLY = ("acceleration", "jerk")
"""Command interfaces that only carry limits here."""
_SENSORS = {
    # A pose has an orientation, too, and is not simulated: so this entry is first.
    "position": None,
    "force": SensorType.FORCE_TORQUE,
    "torque": SensorType.FORCE_TORQUE,
    "orientation": SensorType.IMU,
    "angular_velocity": SensorType.IMU,
    "linear_acceleration": SensorType.IMU,
    "magnetic_field": SensorType.MAGNETOMETER,
    "range": SensorType.RANGE,
    "latitude": SensorType.GPS,
    "battery_voltage": SensorType.BATTERY,
}
"""The kind of sensor by the first part of a state interface's name."""
_FRAME_KEYS = ("frame_id", "frame_name", "link", "link_name", "reference_frame")


@dataclass(frozen=True, slots=True)
class TaggedRobot:
    """A robot description with the meaning of its `<ros2_control>` elements.

    Attributes:
        description: The files, with the mimic rules and transmissions of the elements.
        hardware: The hardware components; empty if the URDF has none.
        commands: The command interfaces of each joint that has any, by quantity.
        limited: The command interfaces that carry limits, by joint.
        positions: Initial positions of joints [rad or m].
        sensors: Sensors that the simulation has.
        gpios: General-purpose inputs and outputs.
        repairs: The parts that are left out or simulated in another way.
    """

    description: RobotFiles
    hardware: tuple[HardwareTag, ...]
    commands: Mapping[str, frozenset[str]]
    limited: Mapping[str, Sequence[InterfaceTag]]
    positions: Mapping[str, float]
    sensors: tuple[SensorRequest, ...]
    gpios: tuple[ComponentTag, ...]
    repairs: tuple[Repair, ...]


def read_tagged_robot(
    description: RobotFiles,
    sensors: Sequence[SensorRequest] = (),
    *,
    strict: bool = False,
) -> TaggedRobot:
    """Return a robot description with the meaning of its `<ros2_control>` elements.

    Args:
        description: The files of the robot.
        sensors: Sensors of the configuration; they replace sensors of the same name.
        strict: Whether to refuse a driver of real hardware, or a part that the
            simulation does not have.

    Raises:
        RobotDescriptionError: An element is wrong, or is refused by `strict`.
    """
    robot = parse_robot(description.xml)
    reader = _TagReader(robot, {one.name for one in sensors})
    try:
        hardware = read_ros2_control(robot)
        for one in hardware:
            reader.add(one)
    except RobotDescriptionError as error:
        raise RobotDescriptionError(
            f"{description.urdf_path}: {error.message}",
            remedy=error.remedy,
            details=error.details,
        ) from error
    if strict and reader.repairs:
        first = reader.repairs[0]
        raise RobotDescriptionError(
            f"{description.urdf_path}: {first.element}: {first.problem}.",
            remedy=f"Correct the URDF. Without robot.strict: {first.new}.",
        )
    if reader.is_changed:
        xml = ET.tostring(robot, encoding="unicode")
        description = replace(description, xml=xml)
    return TaggedRobot(
        description,
        hardware,
        reader.commands,
        reader.limited,
        reader.positions,
        (*sensors, *reader.sensors),
        tuple(gpio for one in hardware for gpio in one.gpios),
        tuple(reader.repairs),
    )


class _TagReader:
    """Collects the settings of the elements, and writes mimic rules into the URDF."""

    def __init__(self, robot: ET.Element, configured: set[str]) -> None:
        self._robot = robot
        self._joints = {one.get("name", ""): one for one in robot.findall("joint")}
        self._links = {one.get("name", "") for one in robot.findall("link")}
        self._configured = configured
        self.is_changed = False
        self.commands: dict[str, frozenset[str]] = {}
        self.limited: dict[str, list[InterfaceTag]] = {}
        self.positions: dict[str, float] = {}
        self.sensors: list[SensorRequest] = []
        self.repairs: list[Repair] = []

    def add(self, hardware: HardwareTag) -> None:
        """Add one hardware component."""
        if not hardware.plugin.startswith(_SIMULATED):
            self._tell(
                f"hardware '{hardware.name}'",
                "its plug-in drives real hardware that the station does not know",
                "simulated by MuJoCo",
                hardware.plugin,
            )
        for key, value in hardware.timing.items():
            self._tell(
                f"hardware '{hardware.name}'",
                f"its {key} is not that of a simulation",
                "read and written in every cycle, unless robot.is_async says otherwise",
                value,
            )
        for joint in hardware.joints:
            self._add_joint(joint)
        for sensor in hardware.sensors:
            if sensor.name not in self._configured:
                self._add_sensor(sensor)
        for transmission in hardware.transmissions:
            self._robot.append(_in_older_form(transmission))
            self.is_changed = True

    def _add_joint(self, tag: ComponentTag) -> None:
        self._settle_mimic(tag)
        quantities = {_QUANTITIES.get(one.name) for one in tag.commands} - {None}
        before = self.commands.get(tag.name, frozenset())
        self.commands[tag.name] = before | {each for each in quantities if each}
        limited = self.limited.setdefault(tag.name, [])
        for one in tag.commands:
            if one.name in _QUANTITIES or one.name in _LIMITS_ONLY:
                name = _QUANTITIES.get(one.name, one.name)
                limited.append(replace(one, name=name))
            else:
                what = f"command interface '{one.name}'"
                self._leave_out(f"joint '{tag.name}'", what)
        position = tag.initial_value("position")
        joint = self._joints[tag.name]
        if position is None or joint.find("mimic") is not None:
            return
        limit = read_joint_limit(joint)
        low, high = (None, None) if limit is None else (limit.lower, limit.upper)
        if low is not None and high is not None and not low <= position <= high:
            raise RobotDescriptionError(
                f"Joint '{tag.name}' of <ros2_control> begins at {position:g}; its "
                f"range is {low:g} to {high:g}.",
                remedy="Correct the initial_value of its position, or its <limit>.",
                details={"joint": tag.name},
            )
        self.positions[tag.name] = position

    def _settle_mimic(self, tag: ComponentTag) -> None:
        """Remove a mimic rule that is switched off; add a rule given by parameters."""
        joint = self._joints[tag.name]
        rule = joint.find("mimic")
        if rule is not None and tag.is_mimic is False:
            joint.remove(rule)
            self.is_changed = True
        leader = tag.parameters.get("mimic")
        if rule is None and leader:
            numbers = {
                key: tag.parameters[key]
                for key in ("multiplier", "offset")
                if key in tag.parameters
            }
            ET.SubElement(joint, "mimic", {"joint": leader, **numbers})
            self.is_changed = True

    def _add_sensor(self, tag: ComponentTag) -> None:
        what = f"sensor '{tag.name}'"
        parts = {one.name.partition(".")[0] for one in tag.states}
        found = [kind for part, kind in _SENSORS.items() if part in parts]
        if not found or found[0] is None:
            self._leave_out(what, f"kind ({', '.join(sorted(parts)) or 'no states'})")
            return
        link = self._link_of(tag)
        values = {one.name: one.initial_value or 0.0 for one in tag.states}
        if found[0].is_constant:
            new = "constant"
            self._tell(what, "the simulation does not measure it", new)
        elif link is None:
            self._tell(
                what,
                f"it names no link; write <param name={_FRAME_KEYS[0]!r}>, or "
                f"robot.sensors/{tag.name} with its type and link",
                "left out",
            )
            return
        self.sensors.append(SensorRequest(tag.name, found[0], link or "", values))

    def _link_of(self, tag: ComponentTag) -> str | None:
        names = [tag.parameters.get(key, "") for key in _FRAME_KEYS]
        # gz_ros2_control finds a sensor by its name among the sensors of Gazebo.
        for element in self._robot.findall("gazebo"):
            if any(one.get("name") == tag.name for one in element.findall("sensor")):
                place = element.get("reference", "")
                child = (
                    self._joints[place].find("child") if place in self._joints else None
                )
                names.append(place if child is None else child.get("link", ""))
        names.append(tag.name)
        return next((name for name in names if name in self._links), None)

    def _leave_out(self, what: str, part: str) -> None:
        self._tell(what, f"its {part} is not simulated", "left out")

    def _tell(self, what: str, problem: str, new: str, old: str = "") -> None:
        self.repairs.append(Repair("ros2_control", what, problem, old, new))


def _in_older_form(tag: ET.Element) -> ET.Element:
    """Return a `<transmission>` of ROS 2 in the form of ros_control."""
    result = ET.Element("transmission", {"name": tag.get("name", "")})
    plugin = tag.find("plugin")
    kind = "" if plugin is None else element_text(plugin)
    ET.SubElement(result, "type").text = kind
    is_simple = kind.endswith("/SimpleTransmission")
    reduction = tag.findtext("joint/mechanical_reduction", "1")
    for part in ("joint", "actuator"):
        for one in tag.findall(part):
            new = ET.SubElement(result, part, {"name": one.get("name", "")})
            if one.get("role"):
                ET.SubElement(new, "role").text = one.get("role")
            if part == "joint":
                interface = ET.SubElement(new, "hardwareInterface")
                interface.text = "hardware_interface/EffortJointInterface"
                ET.SubElement(new, "offset").text = one.findtext("offset", "0")
            own = one.findtext("mechanical_reduction", "1")
            # In ROS 2 the reduction of a simple transmission belongs to the joint, in
            # ros_control to the actuator.
            text = reduction if is_simple and part == "actuator" else own
            ET.SubElement(new, "mechanicalReduction").text = text
    if is_simple and tag.find("actuator") is None:
        name = f"{tag.get('name', '')}_actuator"
        actuator = ET.SubElement(result, "actuator", {"name": name})
        ET.SubElement(actuator, "mechanicalReduction").text = reduction
    return result
