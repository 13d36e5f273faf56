"""URDFs that cannot become a robot are refused with file, element and reason."""

from pathlib import Path

import pytest

from station.core.errors import RobotDescriptionError
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW

LIMIT = '<limit lower="-1" upper="1" effort="5" velocity="2"/>'
TRANSMISSION = """
  <transmission name="t">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="j">
      <hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface>
    </joint>
    <actuator name="m"><mechanicalReduction>10</mechanicalReduction></actuator>
  </transmission>"""
GOOD = f"""<?xml version="1.0"?>
<robot name="r">
  <link name="base"/>
  <link name="arm">
    <inertial><mass value="1"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    {LIMIT}
  </joint>{TRANSMISSION}
</robot>
"""
MESH = '<mesh filename="package://nobody/arm.stl"/>'
SECOND = TRANSMISSION.replace('"t"', '"t2"')
# What to replace in GOOD, by what, and what the message must say of it.
CASES = {
    "no limits": (LIMIT, "", ["Joint 'j'", "revolute", "no <limit>"]),
    "no effort": (' effort="5"', "", ["Joint 'j'", "<limit> without effort"]),
    "inverted limits": (
        'lower="-1"',
        'lower="3"',
        ["Joint 'j'", "<limit>", "3.0", "1.0"],
    ),
    "limit is no number": (
        'upper="1"',
        'upper="one"',
        ["Joint 'j'", '<limit> with upper="one"'],
    ),
    "unknown transmission": (
        "/SimpleTransmission",
        "/MagicTransmission",
        ['<transmission name="t">', "transmission_interface/MagicTransmission"],
    ),
    "no type": (
        "<type>transmission_interface/SimpleTransmission</type>",
        "",
        ["<transmission>", "No type element", "'t'"],
    ),
    "missing actuator": (
        '<actuator name="m"><mechanicalReduction>10</mechanicalReduction></actuator>',
        "",
        ["<transmission>", "actuators", "'t'"],
    ),
    "zero reduction": (
        ">10<",
        ">0<",
        ['<transmission name="t">', "cannot be zero"],
    ),
    "reduction is no number": (
        ">10<",
        ">ten<",
        ['<transmission name="t">', "<mechanicalReduction>"],
    ),
    "unknown interface": (
        "EffortJointInterface",
        "ThoughtJointInterface",
        ['<transmission name="t">', "ThoughtJointInterface"],
    ),
    "joint in two transmissions": (
        TRANSMISSION,
        TRANSMISSION + SECOND,
        ['<transmission name="t2">', "'j'", "in use"],
    ),
    "missing mesh": (
        '<box size="0.1 0.1 0.1"/>',
        MESH,
        ["Link 'arm' <collision>", "package://nobody/arm.stl", "not found"],
    ),
    "missing link": ('<child link="arm"/>', '<child link="leg"/>', ["'j'", "'leg'"]),
    "impossible inertia": (
        'izz="0.1"',
        'izz="9"',
        ["the element named 'arm'", "inertia must satisfy"],
    ),
    "no mass": (
        '<mass value="1"/>',
        '<mass value="0"/>',
        ["the element named 'arm'", "mass and inertia"],
    ),
    "inverted soft limits": (
        LIMIT,
        f'{LIMIT}<safety_controller soft_lower_limit="1" soft_upper_limit="-1" '
        'k_position="1" k_velocity="1"/>',
        ["<safety_controller>", "'j'", "from 1.0 to -1.0"],
    ),
    "no joint to drive": (
        'type="revolute"',
        'type="fixed"',
        ["<robot>", "no joint that could be driven"],
    ),
    "not XML": (GOOD, "shoulder: 1.0", ["not XML", "line 1"]),
    "cut off": ("</robot>", "", ["not XML", "no element found"]),
    "other XML": (GOOD, "<mujoco/>", ["not a URDF", "<mujoco>"]),
    "5 MB": ("</robot>", f"<!--{'x' * 5_000_000}--></robot>", ["5000", "bytes"]),
}


def load(path: Path, text: str) -> MujocoRobotHW:
    path.write_text(text, encoding="utf-8")
    tree = ParameterTree({"robot": {"robot_description": str(path), "strict": True}})
    hw = MujocoRobotHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw


def test_urdf_without_a_mistake_is_loaded(tmp_path):
    assert load(tmp_path / "good.urdf", GOOD).joint_limits()[0].joint == "j"


@pytest.mark.parametrize("case", CASES)
def test_bad_urdf_is_refused_with_file_element_and_reason(case, tmp_path):
    old, new, parts = CASES[case]
    assert old in GOOD
    path = tmp_path / "robot.urdf"

    with pytest.raises(RobotDescriptionError) as caught:
        load(path, GOOD.replace(old, new))

    for part in [str(path), *parts]:
        assert part in caught.value.message
    assert caught.value.remedy
