"""Make joints and inertials of foreign URDFs readable, and report each change.

Source: MuJoCo's URDF reader decides which of these descriptions are usable; differs:
every change is reported with the old and the new value, and a joint with the range 0 to
0 is locked unless the caller asks to free it.
"""

from dataclasses import dataclass, field
from typing import Literal
from xml.etree import ElementTree as ET

from station.core.description.urdf_text import parse_decimal, parse_robot

RepairKind = Literal[
    "inertia",
    "mass",
    "range",
    "mimic",
    "motor",
    "friction",
    "transmission",
    "self_collision",
    "start_pose",
    "base",
    "name",
    "armature",
    "gravity",
    "ros2_control",
]
ZeroRange = Literal["lock", "free"]
"""Treatment of a joint whose range is 0 to 0."""
_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_LIMITED = {"revolute", "prismatic"}
_SLACK = 1e-6
"""Allowed difference between the ranges of a mimic joint and its leader, as a share of
the leader's range: conversions lose the last decimals."""
_OUT_OF_REACH = 1000.0
"""End of a range that no prismatic joint reaches [m]."""
WORLD = "world"
"""Name of the simulator's own root body."""


@dataclass(frozen=True, slots=True)
class Repair:
    """One difference between the simulated robot and its description.

    Attributes:
        kind: Kind of the changed element.
        element: The element of the description, e.g. `link 'wrist'`.
        problem: Fault of the element, without a full stop.
        old: The value in the description; empty if there is none.
        new: The value that is used instead.
    """

    kind: RepairKind
    element: str
    problem: str
    old: str
    new: str

    @property
    def is_addition(self) -> bool:
        """Return whether the repair adds an element that a URDF cannot state."""
        return self.kind in {"armature", "gravity"}

    def sentence(self) -> str:
        """Return the repair in one line."""
        was = f" (was {self.old})" if self.old else ""
        return f"{self.element}: {self.problem}; now {self.new}{was}"


def repair_urdf(
    xml: str, zero_range: ZeroRange = "lock", base: str = "fixed"
) -> tuple[str, tuple[Repair, ...]]:
    """Return a URDF whose joints and inertials can be read, and the changes.

    Args:
        xml: The document.
        zero_range: Treatment of a joint whose range is 0 to 0.
        base: How the root link is held: `fixed`, `floating` or `planar`.

    Returns:
        The document and the repairs; the same text if there is nothing to repair.

    Raises:
        RobotDescriptionError: The document is not a URDF.
    """
    work = _Repairs(parse_robot(xml), zero_range)
    work.repair_inertials()
    work.repair_ranges()
    work.repair_mimics()
    work.adopt_root_joint(base)
    work.rename_world(base)
    if not work.found:
        return xml, ()
    return ET.tostring(work.robot, encoding="unicode"), tuple(work.found)


@dataclass(slots=True)
class _Repairs:
    """The repairs of one document, which is changed in place."""

    robot: ET.Element
    zero_range: ZeroRange
    found: list[Repair] = field(default_factory=list)

    def repair_inertials(self) -> None:
        """Drop an `<inertial>` without a usable mass; complete a missing tensor."""
        for link in self.robot.findall("link"):
            inertial = link.find("inertial")
            if inertial is None:
                continue
            mass = inertial.find("mass")
            text = "" if mass is None else mass.get("value", "")
            number = parse_decimal(text)
            where = f"link '{link.get('name', '')}'"
            if number is None or number < 0.0:
                link.remove(inertial)
                problem = "its <inertial> has no mass of 0 or more"
                self._add("mass", where, problem, text, "no inertia")
                continue
            self._repair_tensor(where, inertial)

    def _repair_tensor(self, where: str, inertial: ET.Element) -> None:
        tensor = inertial.find("inertia")
        if tensor is None:
            tensor = ET.SubElement(inertial, "inertia")
        missing = [key for key in _MOMENTS if tensor.get(key) is None]
        wrong = [
            key
            for key in _MOMENTS
            if key not in missing and parse_decimal(tensor.get(key, "")) is None
        ]
        if not missing and not wrong:
            return
        old = ", ".join(f"{key} {tensor.get(key)}" for key in wrong)
        for key in (*missing, *wrong):
            tensor.set(key, "0")
        names = ", ".join((*missing, *wrong))
        self._add("inertia", where, f"{names} is no number or missing", old, "0")

    def repair_ranges(self) -> None:
        """Lock or free the joints whose range is 0 to 0."""
        for joint in self.robot.findall("joint"):
            kind, limit = joint.get("type", ""), joint.find("limit")
            if kind not in _LIMITED or limit is None:
                continue
            ends = [parse_decimal(limit.get(key, "0")) for key in ("lower", "upper")]
            if ends != [0.0, 0.0]:
                continue
            if self.zero_range == "lock":
                joint.set("type", "fixed")
                new = "locked (zero_range: free lets it move)"
            elif kind == "revolute":
                joint.set("type", "continuous")
                new = "free"
            else:
                # A prismatic joint needs a range; 1 km is out of reach.
                _set_range(limit, -_OUT_OF_REACH, _OUT_OF_REACH)
                new = "-1000 to 1000"
            name = joint.get("name", "")
            self._add("range", f"joint '{name}'", "its range is empty", "0 to 0", new)

    def repair_mimics(self) -> None:
        """Drop mimic rules of missing joints; let a chain follow its last leader."""
        joints = {joint.get("name", ""): joint for joint in self.robot.findall("joint")}
        for name, joint in joints.items():
            rule = joint.find("mimic")
            if rule is None:
                continue
            where, leader = f"joint '{name}'", rule.get("joint", "")
            found = self._find_leader(rule, joints)
            if found is None:
                joint.remove(rule)
                problem = "it mimics a joint that is missing or cannot move"
                self._add("mimic", where, problem, leader, "moves by itself")
            elif found[0] != leader:
                last, multiplier, offset = found
                rule.set("joint", last)
                rule.set("multiplier", repr(multiplier))
                rule.set("offset", repr(offset))
                new = f"mimics '{last}' with {multiplier:g} and {offset:g}"
                self._add("mimic", where, "it mimics a mimic joint", leader, new)
            if found is not None:
                self._repair_mimic_range(joint, joints[found[0]], found[1:])

    def _repair_mimic_range(
        self, joint: ET.Element, leader: ET.Element, rule: tuple[float, float]
    ) -> None:
        """Let the ranges of a mimic joint and its leader allow the same motion."""
        own, limit = _range(joint), joint.find("limit")
        # An inverted range cannot be repaired, because its meaning is unknown.
        if own is None or limit is None or own[0] > own[1] or rule[0] == 0.0:
            return
        lead = _range(leader)
        if lead is None:
            self._free_mimic(joint, limit, leader.get("name", ""))
            return
        low, high = sorted(rule[0] * end + rule[1] for end in lead)
        slack = _SLACK * (high - low)
        if own[0] - low <= slack and high - own[1] <= slack:
            return
        name = leader.get("name", "")
        if min(own[1], high) > max(own[0], low):
            low, high = min(own[0], low), max(own[1], high)
            problem = f"its range is smaller than that of '{name}', which it follows"
        else:
            problem = f"its range does not meet that of '{name}'"
        _set_range(limit, low, high)
        where = f"joint '{joint.get('name', '')}'"
        old, new = f"{own[0]:g} to {own[1]:g}", f"{low:g} to {high:g}"
        self._add("range", where, problem, old, new)

    def _free_mimic(self, joint: ET.Element, limit: ET.Element, leader: str) -> None:
        """Remove the range of a mimic joint whose leader has no range."""
        old = f"{limit.get('lower', '0')} to {limit.get('upper', '0')}"
        if joint.get("type") == "prismatic":
            _set_range(limit, -_OUT_OF_REACH, _OUT_OF_REACH)
        else:
            joint.set("type", "continuous")
        where = f"joint '{joint.get('name', '')}'"
        problem = f"its range would block its leader '{leader}', which has none"
        self._add("range", where, problem, old, "free")

    def adopt_root_joint(self, base: str) -> None:
        """Remove a root joint whose type is that of the base: the base replaces it."""
        joints, root = self.robot.findall("joint"), self._root()
        below = [joint for joint in joints if _link_of(joint, "parent") == root]
        if len(below) != 1 or below[0].get("type") != base or base == "fixed":
            return
        if not self._is_frame_only(root):
            return
        below[0].set("type", "fixed")
        where = f"joint '{below[0].get('name', '')}'"
        problem = f"robot.base: {base} lets the root link move already"
        self._add("base", where, problem, base, "fixed")

    def rename_world(self, base: str) -> None:
        """Rename a link that has the name of the simulator's world."""
        above = {
            _link_of(joint, "child"): joint for joint in self.robot.findall("joint")
        }
        is_frame = self._is_frame_only(WORLD)
        if WORLD in above:
            is_frame = is_frame and above[WORLD].get("type") == "fixed"
        else:
            is_frame = is_frame and base == "fixed"
        links = {link.get("name"): link for link in self.robot.findall("link")}
        if WORLD not in links or is_frame:
            return
        new = f"{WORLD}_link"
        while new in links:
            new += "_"
        links[WORLD].set("name", new)
        for element in self.robot.iter():
            for key in ("link", "reference"):
                if element.get(key) == WORLD:
                    element.set(key, new)
        problem = "the simulation's own frame has this name"
        self._add("name", f"link '{WORLD}'", problem, WORLD, new)

    def _root(self) -> str:
        children = {_link_of(joint, "child") for joint in self.robot.findall("joint")}
        links = [link.get("name", "") for link in self.robot.findall("link")]
        return next((name for name in links if name not in children), "")

    def _is_frame_only(self, name: str) -> bool:
        links = self.robot.findall("link")
        link = next((one for one in links if one.get("name") == name), None)
        return link is None or (
            link.find("inertial") is None and link.find("collision") is None
        )

    def _find_leader(
        self, rule: ET.Element, joints: dict[str, ET.Element]
    ) -> tuple[str, float, float] | None:
        """Return the last leader of a chain of mimic rules, with factor and offset."""
        multiplier, offset = 1.0, 0.0
        seen: set[str] = set()
        while True:
            factor = parse_decimal(rule.get("multiplier", "1"))
            summand = parse_decimal(rule.get("offset", "0"))
            leader = rule.get("joint", "")
            joint = joints.get(leader)
            if factor is None or summand is None or leader in seen or joint is None:
                return None
            if joint.get("type") == "fixed":
                return None
            offset += multiplier * summand
            multiplier *= factor
            seen.add(leader)
            following = joint.find("mimic")
            if following is None:
                return leader, multiplier, offset
            rule = following

    def _add(
        self, kind: RepairKind, element: str, problem: str, old: str, new: str
    ) -> None:
        self.found.append(Repair(kind, element, problem, old, new))


def _link_of(joint: ET.Element, tag: str) -> str:
    """Return the parent or child link of a joint; empty if it is missing."""
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")


def _set_range(limit: ET.Element, low: float, high: float) -> None:
    limit.set("lower", repr(low))
    limit.set("upper", repr(high))


def _range(joint: ET.Element) -> tuple[float, float] | None:
    """Return the range of a joint; None if it has none or it cannot be read."""
    limit = joint.find("limit")
    if limit is None or joint.get("type") not in _LIMITED:
        return None
    low, high = (parse_decimal(limit.get(key, "0")) for key in ("lower", "upper"))
    return None if low is None or high is None else (low, high)
