"""A robot that its description alone does not allow is simulated, and says how."""

from pathlib import Path

import numpy as np
import pytest

from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.errors import RobotDescriptionError
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.description_repair import repair_robot
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.hw.mujoco.robot_transmissions import read_transmissions

INERTIAL = (
    '<inertial><mass value="{mass}"/>'
    '<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial>'
)
GOOD = INERTIAL.format(mass=1, x=0.1, y=0.1, z=0.1)
SIMPLE = (
    "<type>transmission_interface/SimpleTransmission</type>"
    '<joint name="j"><hardwareInterface>EffortJointInterface'
    "</hardwareInterface></joint>"
    '<actuator name="m"><mechanicalReduction>10</mechanicalReduction></actuator>'
)


def robot(inertial: str = GOOD, effort: float = 5.0, transmission: str = "") -> str:
    return f"""<robot name="r"><link name="base"/><link name="arm">{inertial}</link>
      <joint name="j" type="revolute"><parent link="base"/><child link="arm"/>
      <limit lower="-1" upper="1" effort="{effort}" velocity="2"/></joint>
      {transmission}</robot>"""


def repaired(xml: str, **options):
    return repair_robot(RobotFiles("r", Path("r.urdf"), xml, None), **options)


def make(path: Path, xml: str, **parameters) -> MujocoRobotHW:
    path.write_text(xml, encoding="utf-8")
    tree = ParameterTree({"robot": {"robot_description": str(path), **parameters}})
    hw = MujocoRobotHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw


@pytest.mark.parametrize("name", ["ur3", "so100", "panda"])
def test_robot_that_needs_no_repair_is_the_same(name) -> None:
    files = load_robot_files(f"example-robot-data:{name}")
    lenient, strict = repair_robot(files), repair_robot(files, strict=True)
    assert lenient == strict


def test_impossible_inertia_gets_the_mean_of_its_moments() -> None:
    """MuJoCo's balanceinertia: (1 + 2 + 9) / 3 = 4."""
    found = repaired(robot(INERTIAL.format(mass=1, x=1, y=2, z=9)))
    assert found.urdf.links["arm"].inertial.inertia == pytest.approx(
        (4,) * 3 + (0,) * 3
    )
    (repair,) = found.repairs
    assert repair.element == "link 'arm'"
    assert (repair.old, repair.new) == ("1 2 9", "4 about every axis [kg m^2]")


@pytest.mark.parametrize("inertial", ["", INERTIAL.format(mass=0, x=0, y=0, z=0)])
def test_moving_link_without_mass_gets_a_small_one(inertial) -> None:
    found = repaired(robot(inertial))
    assert found.urdf.links["arm"].inertial.mass == 1e-3
    assert [repair.kind for repair in found.repairs] == ["mass"]


def test_moving_point_mass_gets_an_inertia() -> None:
    found = repaired(robot(INERTIAL.format(mass=2, x=0, y=0, z=0)))
    assert found.urdf.links["arm"].inertial.mass == 2.0
    assert found.urdf.links["arm"].inertial.inertia[0] == pytest.approx(0.8e-4)


@pytest.mark.parametrize(("friction", "used"), [(4.9, 4.9), (5.0, 2.5), (7.0, 2.5)])
def test_motor_that_cannot_overcome_its_joint_gets_a_joint_that_it_can(
    friction, used
) -> None:
    """The joint's effort limit is 5 Nm."""
    rough = f'<dynamics friction="{friction}"/></joint>'
    found = repaired(robot().replace("</joint>", rough))
    assert found.urdf.joints["j"].friction == used
    assert [repair.kind for repair in found.repairs] == ["friction"] * (used == 2.5)


def test_old_transmission_keeps_its_reduction(tmp_path) -> None:
    old = (
        '<transmission name="t" type="pr2_mechanism_model/SimpleTransmission">'
        '<actuator name="m"/><joint name="j"/>'
        "<mechanicalReduction>-79</mechanicalReduction></transmission>"
    )
    found = repaired(robot(transmission=old))
    (info,) = read_transmissions(found.description, found.urdf)
    assert (info.name, info.actuators[0].name) == ("t", "m")
    assert info.actuators[0].element.findtext("mechanicalReduction") == "-79"
    assert "today's form" in found.repairs[0].sentence()
    make(tmp_path / "r.urdf", robot(transmission=old))


@pytest.mark.parametrize(
    ("transmission", "reason"),
    [
        (SIMPLE.replace("/Simple", "/HalfDifferential"), "HalfDifferential"),
        (SIMPLE.replace("EffortJoint", "ThoughtJoint"), "ThoughtJointInterface"),
        (SIMPLE.replace(">10<", ">0<"), "cannot be zero"),
        (SIMPLE.replace('"m"', '""'), "actuator"),
        (SIMPLE.replace('"j"', '"ghost"'), "no motor can move ghost"),
    ],
)
def test_transmission_that_cannot_be_used_becomes_a_direct_drive(
    tmp_path, transmission, reason
) -> None:
    xml = robot(transmission=f'<transmission name="t">{transmission}</transmission>')
    hw = make(tmp_path / "r.urdf", xml)
    assert [t.name for t in hw.transmissions()] == ["j_transmission"]
    (repair,) = [r for r in hw.repairs() if not r.is_addition]
    assert repair.element == "transmission 't'"
    assert reason in repair.problem


def test_second_transmission_of_an_actuator_becomes_a_direct_drive() -> None:
    twice = "".join(
        f'<transmission name="{name}">{SIMPLE}</transmission>' for name in "tu"
    )
    found = repaired(robot(transmission=twice))
    (info,) = read_transmissions(found.description, found.urdf)
    assert info.name == "t"
    assert "in use already" in found.repairs[0].problem


def test_robot_without_motors_starts_and_says_so(tmp_path) -> None:
    hw = make(tmp_path / "r.urdf", robot(effort=0))
    hw.read(0.001, 0.001)
    hw.write(0.001, 0.001)
    assert "passive" in [repair.new for repair in hw.repairs()]
    assert np.isfinite(hw.world.data.qpos).all()


def test_strict_refuses_what_would_be_repaired(tmp_path) -> None:
    with pytest.raises(RobotDescriptionError, match="mass and inertia"):
        make(tmp_path / "r.urdf", robot(""), strict=True)


FOLLOWER = """<link name="second">{inertial}</link>
  <joint name="k" type="revolute"><parent link="arm"/><child link="second"/>
  <limit lower="0" upper="0.5" effort="5" velocity="2"/><mimic joint="j"/></joint>
  </robot>"""


def test_strict_refuses_a_follower_that_would_block_its_leader(tmp_path) -> None:
    xml = robot().replace("</robot>", FOLLOWER.format(inertial=GOOD))
    with pytest.raises(RobotDescriptionError, match="'k': its range is smaller"):
        make(tmp_path / "r.urdf", xml, strict=True)
    assert "range" in [r.kind for r in make(tmp_path / "r.urdf", xml).repairs()]


@pytest.mark.parametrize("effort", [0.0, 5.0, 50.0])
def test_joint_limits_replace_the_effort_of_the_urdf(tmp_path, effort) -> None:
    limits = {"j": {"has_effort_limits": True, "max_effort": 30.0}}
    hw = make(tmp_path / "r.urdf", robot(effort=effort), joint_limits=limits)
    assert hw.world.joints(["j"]).effort_limits == [30.0]
    (report,) = hw.joint_limits()
    assert report.limits.max_effort == 30.0
    assert report.sources["effort"] == "parameters"
    assert "motor" not in [repair.kind for repair in hw.repairs()]


def test_joint_limits_can_take_a_motor_away(tmp_path) -> None:
    limits = {"j": {"has_effort_limits": True, "max_effort": 0.0}}
    hw = make(tmp_path / "r.urdf", robot(), joint_limits=limits)
    assert "motor" in [repair.kind for repair in hw.repairs()]


FLOATING = """<robot name="r"><link name="base"/><link name="body">{inertial}</link>
  <joint name="root" type="floating"><parent link="base"/><child link="body"/></joint>
  </robot>"""


@pytest.mark.parametrize("strict", [False, True])
def test_floating_root_joint_is_simulated_by_a_floating_base(tmp_path, strict) -> None:
    path, xml = tmp_path / "r.urdf", FLOATING.format(inertial=GOOD)
    with pytest.raises(RobotDescriptionError) as refused:
        make(path, xml)
    assert "Set robot.base to floating" in refused.value.remedy
    if strict:
        xml = xml.replace("</robot>", _ARM)
    hw = make(path, xml, base="floating", base_xyz=[0, 0, 1.0], strict=strict)
    for _ in range(100):
        hw.read(0.001, 0.001)
    # It falls: g t^2 / 2.
    assert hw.world.data.body("base").xpos[2] == pytest.approx(0.951, abs=1e-3)


_ARM = f"""<link name="arm">{GOOD}</link><joint name="j" type="revolute">
  <parent link="body"/><child link="arm"/>
  <limit lower="-1" upper="1" effort="5" velocity="2"/></joint></robot>"""


def test_floating_joint_within_a_robot_is_refused_with_a_way_out(tmp_path) -> None:
    inner = robot().replace('type="revolute"', 'type="floating"')
    inner = inner.replace('<link name="base"/>', f'<link name="base">{GOOD}</link>')
    with pytest.raises(RobotDescriptionError) as refused:
        make(tmp_path / "r.urdf", inner, base="floating")
    assert "another type" in refused.value.remedy


@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_link_called_world_is_simulated(tmp_path, base) -> None:
    solid = robot().replace('name="base"/>', f'name="base">{GOOD}</link>')
    fixed = '<joint name="f" type="fixed"><parent link="world"/><child link="base"/>'
    fixed = f'<link name="world"/>{fixed}</joint></robot>'
    hw = make(tmp_path / "r.urdf", solid.replace("</robot>", fixed), base=base)
    assert ("name" in [r.kind for r in hw.repairs()]) is (base == "floating")
    moving = solid.replace('"arm"', '"world"')
    hw = make(tmp_path / "s.urdf", moving, base=base)
    assert [r.new for r in hw.repairs() if r.kind == "name"] == ["world_link"]
