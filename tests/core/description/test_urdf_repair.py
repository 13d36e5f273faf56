"""What other people's URDFs get wrong is repaired, and every repair is told."""

import pytest

from station.core.description.urdf import JointType
from station.core.description.urdf_parser import parse_urdf, read_joint_limit
from station.core.description.urdf_repair import Repair, repair_urdf
from station.core.description.urdf_text import parse_robot

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def joint(name: str, inside: str, kind: str = "revolute") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="base"/>'
        f'<child link="{name}_link"/>{inside}</joint><link name="{name}_link"/>'
    )


def robot(*parts: str) -> str:
    return f'<robot name="r"><link name="base"/>{"".join(parts)}</robot>'


def test_good_description_stays_the_same_text() -> None:
    xml = robot(joint("a", LIMIT), joint("b", LIMIT + '<mimic joint="a"/>'))
    assert repair_urdf(xml) == (xml, ())


def test_joint_with_an_empty_range_is_locked() -> None:
    xml, (repair,) = repair_urdf(robot(joint("a", '<limit effort="1" velocity="1"/>')))
    assert parse_urdf(xml).joints["a"].type is JointType.FIXED
    assert repair.kind == "range"
    assert repair.sentence() == (
        "joint 'a': its range is empty; now locked (zero_range: free lets it move) "
        "(was 0 to 0)"
    )


@pytest.mark.parametrize(
    ("kind", "freed"),
    [("revolute", JointType.CONTINUOUS), ("prismatic", JointType.PRISMATIC)],
)
def test_joint_with_an_empty_range_is_freed_when_asked(kind, freed) -> None:
    xml, _ = repair_urdf(
        robot(joint("a", '<limit effort="1" velocity="1"/>', kind)), "free"
    )
    found = parse_urdf(xml).joints["a"]
    assert found.type is freed
    assert found.limit.lower is None or found.limit.lower < found.limit.upper


def test_mimic_of_a_missing_joint_moves_by_itself() -> None:
    xml, (repair,) = repair_urdf(robot(joint("a", LIMIT + '<mimic joint="ghost"/>')))
    assert parse_urdf(xml).joints["a"].mimic is None
    assert (repair.kind, repair.old, repair.new) == (
        "mimic",
        "ghost",
        "moves by itself",
    )


def test_circle_of_mimics_is_opened() -> None:
    xml, repairs = repair_urdf(
        robot(
            joint("a", LIMIT + '<mimic joint="b"/>'),
            joint("b", LIMIT + '<mimic joint="a"/>'),
        )
    )
    assert parse_urdf(xml).joints["a"].mimic is None
    assert parse_urdf(xml).joints["b"].mimic.joint == "a"
    assert len(repairs) == 1


def test_chain_of_mimics_follows_its_leader() -> None:
    wide = LIMIT.replace("1", "9", 2)
    xml, (repair,) = repair_urdf(
        robot(
            joint("a", LIMIT),
            joint("b", wide + '<mimic joint="a" multiplier="2" offset="0.1"/>'),
            joint("c", wide + '<mimic joint="b" multiplier="-3" offset="0.5"/>'),
        )
    )
    mimic = parse_urdf(xml).joints["c"].mimic
    # c = -3 b + 0.5 = -3 (2 a + 0.1) + 0.5
    assert (mimic.joint, mimic.multiplier) == ("a", -6.0)
    assert mimic.offset == pytest.approx(0.2)
    assert repair.element == "joint 'c'"


def test_mimic_outside_of_its_own_range_gets_that_of_its_leader() -> None:
    """The gripper of a PR2: 0 to 0.548 mimicked with a factor of -1."""
    limit = LIMIT.replace('"-1"', '"0"')
    xml, (repair,) = repair_urdf(
        robot(
            joint("a", limit),
            joint("b", limit + '<mimic joint="a" multiplier="-1"/>'),
        )
    )
    found = parse_urdf(xml).joints["b"].limit
    assert (found.lower, found.upper) == (-1.0, 0.0)
    assert (repair.old, repair.new) == ("0 to 1", "-1 to 0")


@pytest.mark.parametrize(
    ("multiplier", "offset", "range_"),
    [(1, 0, (-1.0, 2.0)), (-2, 0, (-4.0, 2.0)), (1, 0.5, (-1.0, 2.5))],
)
def test_mimic_with_a_smaller_range_gets_that_of_its_leader(
    multiplier, offset, range_
) -> None:
    """Else it would block its leader, whose own limits say that it may go on."""
    leader = LIMIT.replace('"1"', '"2"', 1)
    rule = f'<mimic joint="a" multiplier="{multiplier}" offset="{offset}"/>'
    xml, (repair,) = repair_urdf(robot(joint("a", leader), joint("b", LIMIT + rule)))
    found = parse_urdf(xml).joints["b"].limit
    assert (found.lower, found.upper) == range_
    assert "smaller than that of 'a', which it follows" in repair.problem


def test_mimic_of_a_joint_without_a_range_has_none() -> None:
    rule = LIMIT + '<mimic joint="a"/>'
    xml, repairs = repair_urdf(
        robot(
            joint("a", "", "continuous"),
            joint("b", rule),
            joint("c", rule, "prismatic"),
        )
    )
    found = parse_urdf(xml).joints
    assert found["b"].type is JointType.CONTINUOUS
    assert (found["c"].limit.lower, found["c"].limit.upper) == (-1000.0, 1000.0)
    assert [repair.new for repair in repairs] == ["free", "free"]


def test_rounded_range_of_a_mimic_is_no_mistake() -> None:
    rounded = LIMIT.replace('"1"', '"0.9999999"', 1)
    xml = robot(joint("a", LIMIT), joint("b", rounded + '<mimic joint="a"/>'))
    assert repair_urdf(xml) == (xml, ())


def test_base_takes_the_place_of_a_root_joint_of_its_kind() -> None:
    xml = robot(joint("root", "", "floating"))
    assert repair_urdf(xml, base="fixed") == (xml, ())
    adopted, (repair,) = repair_urdf(xml, base="floating")
    assert parse_urdf(adopted).joints["root"].type is JointType.FIXED
    assert (repair.kind, repair.element) == ("base", "joint 'root'")


@pytest.mark.parametrize(
    "more", [joint("other", LIMIT), '<link name="base"><collision/></link>']
)
def test_base_with_something_else_on_it_is_left_alone(more) -> None:
    parts = f'<robot name="r">{more}{joint("root", "", "floating")}</robot>'
    if "<collision" not in more:
        parts = robot(joint("root", "", "floating"), more)
    assert not [r for r in repair_urdf(parts, base="floating")[1] if r.kind == "base"]


def test_link_named_as_the_world_gets_another_name() -> None:
    xml = robot(joint("j", LIMIT)).replace("j_link", "world")
    renamed, (repair,) = repair_urdf(xml)
    assert parse_urdf(renamed).joints["j"].child == "world_link"
    assert (repair.kind, repair.old, repair.new) == ("name", "world", "world_link")


def test_world_as_a_frame_is_the_usual_root_and_stays() -> None:
    xml = robot(joint("f", "", "fixed")).replace('"base"', '"world"')
    assert repair_urdf(xml) == (xml, ())
    assert "world_link" in repair_urdf(xml, base="floating")[0]


@pytest.mark.parametrize(
    ("inertial", "kind", "mass"),
    [
        ("<inertial/>", "mass", None),
        ('<inertial><mass value="-1"/></inertial>', "mass", None),
        ('<inertial><mass value="2"/></inertial>', "inertia", 2.0),
        ('<inertial><mass value="2"/><inertia ixx="nan"/></inertial>', "inertia", 2.0),
    ],
)
def test_inertial_is_completed_or_left_out(inertial, kind, mass) -> None:
    xml, (repair,) = repair_urdf(
        f'<robot name="r"><link name="base">{inertial}</link></robot>'
    )
    found = parse_urdf(xml).links["base"].inertial
    assert (found and found.mass) == mass
    assert (repair.kind, repair.element) == (kind, "link 'base'")


def test_inverted_range_is_not_repaired() -> None:
    """Nobody knows which of the two ends is wrong."""
    limit = '<limit lower="1" upper="0" effort="1" velocity="1"/>'
    xml, repairs = repair_urdf(robot(joint("a", limit)))
    (element,) = parse_robot(xml).findall("joint")
    assert repairs == ()
    assert read_joint_limit(element).lower == 1.0


def test_sentence_has_the_old_value_if_there_is_one() -> None:
    told = Repair("mass", "link 'a'", "it has none", "", "1 g")
    assert told.sentence() == "link 'a': it has none; now 1 g"
    told = Repair("mass", "link 'a'", "it has none", "0", "1 g")
    assert told.sentence() == "link 'a': it has none; now 1 g (was 0)"
