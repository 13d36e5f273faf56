"""The scorecard of a robot."""

import pytest

from station.experiments.validation import Check, Scorecard, validate
from station.trials.trial import Setup

ONE = "effort_group_position_controller"


@pytest.fixture(scope="module")
def wrong():
    """A Panda with a controller without stiffness, and one of unknown joints."""
    default = Setup.load().config().model_dump()["controllers"][ONE]
    pid = {"pid": {"p": 1.0, "i": 0.0, "d": 0.0}}
    weak = {**default, **dict.fromkeys(default["joints"], pid)}
    lost = {**default, "joints": ["elbow"]}
    controllers = {"weak": weak, "lost": lost}
    return validate(Setup.load({"controllers": controllers, "start": []}), "weak panda")


def outcomes(card):
    return {check.name: check.outcome for check in card.checks}


def test_what_is_wrong_is_found(wrong):
    found = outcomes(wrong)

    assert not wrong.is_good, wrong
    assert found["controller lost loads"] == "failed"
    assert found["weak keeps still"] == "passed"
    assert found["weak reaches a goal"] == "failed"
    assert found["energy of free motion"] == "passed"
    assert found["limits of joints"] == "passed"
    assert found["holds its weight without a controller"] == "passed"


def test_robot_that_cannot_be_built_is_a_scorecard_too():
    missing = {"type": "mujoco_hw/MujocoRobotHW", "robot_description": "/no/such.urdf"}

    card = validate(Setup.load({"robot": missing}), "nothing")

    assert [check.name for check in card.checks] == ["robot loads"]
    assert not card.is_good
    assert "cannot be read" in card.checks[0].detail


URDF = """
<robot name="two">
  <link name="base">
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="slide">
    <inertial><mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  </link>
  <link name="block">
    <inertial><mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="slide"/>
    <axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="50" velocity="1"/></joint>
  <joint name="push" type="prismatic"><parent link="slide"/><child link="block"/>
    <origin xyz="0.05 0 0"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="0.1" velocity="1"/><mimic joint="lift"/></joint>
</robot>
"""


def test_joint_without_motor_and_links_that_touch_are_named(tmp_path):
    (tmp_path / "two.urdf").write_text(URDF)
    robot = {
        "type": "mujoco_hw/MujocoRobotHW",
        "robot_description": str(tmp_path / "two.urdf"),
    }

    card = validate(Setup.load({"robot": robot}), "two")

    found = {check.name: check for check in card.checks}
    limits = found["limits of joints"]
    assert limits.outcome == "passed", limits
    assert limits.detail == "1 joints have all limits. Without a motor: push."
    rest = found["holds its weight without a controller"]
    assert rest.outcome == "passed", rest
    # What touches at the start does not push itself: it is left out, and told.
    assert "base" in found["description"].detail, found["description"]
    assert "block" in found["description"].detail


def test_page_shows_every_check_and_escapes_what_it_shows():
    check = Check("a <b>", "failed", "1 > 0")
    page = Scorecard("<robot>", "abc", (check, Check("c", "skipped", "-"))).to_html()

    assert "<b>" not in page
    assert "a &lt;b&gt;" in page
    assert "1 checks failed." in page
    assert '<tr class="skipped">' in page


@pytest.mark.slow
def test_default_station_is_good():
    card = validate(Setup.load(), "panda")

    assert [c for c in card.checks if c.outcome == "failed"] == []
    assert (
        outcomes(card)["effort_joint_trajectory_controller reaches a goal"] == "passed"
    )


def test_an_unknown_parameter_of_a_file_of_ros_is_told_as_by_a_station(tmp_path):
    (tmp_path / "two.urdf").write_text(URDF)
    (tmp_path / "ros.yaml").write_text("""
lifter:
  ros__parameters:
    type: joint_trajectory_controller/JointTrajectoryController
    joints: [lift]
    command_interfaces: [effort]
    gains.lift: {p: 10.0, i: 0.0, d: 1.0}
    open_loop_control: true
""")
    robot = {
        "type": "mujoco_hw/MujocoRobotHW",
        "robot_description": str(tmp_path / "two.urdf"),
    }

    setup = Setup.load({"robot": robot}, controllers=[tmp_path / "ros.yaml"])
    card = validate(setup, "two")

    (loaded,) = [c for c in card.checks if c.name == "controller lifter loads"]
    assert loaded.outcome == "passed", loaded
    assert "parameter 'open_loop_control' is unknown" in loaded.detail
