"""A station for a robot of which only the URDF is known."""

import re

import httpx
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.app.any_robot import configure_robot, examine_robot
from station.app.composition import compose
from station.config import load_config
from station.core import SwitchRequest
from station.core.errors import RobotDescriptionError
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport


def test_arm_gets_trajectories_that_reach_a_goal() -> None:
    config = configure_robot("example-robot-data:ur3")
    station = compose(load_config(config)).station
    name = "joint_trajectory_controller"
    station.switch_controllers(SwitchRequest(start=(name,)))
    joints = config["controllers"][name]["joints"]
    point = {"positions": [-0.1] * len(joints), "time_from_start": 0.3}
    trajectory = {"joint_names": joints, "points": [point]}
    goal = station.motion.submit_goal(
        name, {"trajectory": trajectory, "goal_time_tolerance": 1.0}
    )
    station.loop.step(1500)
    assert goal.status.value == "succeeded"
    # What the robot's transmissions pass on to its motors is nobody's intrusion.
    assert station.manager.command_violations == (0, None)


def test_every_read_of_the_api_is_answered_for_a_robot_of_a_urdf() -> None:
    config = configure_robot("example-robot-data:ur3")
    station = compose(load_config(config)).station
    station.loop.step(5)
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    paths = [
        path for path, methods in app.openapi()["paths"].items() if "get" in methods
    ]
    answers = {}
    with httpx.Client(transport=AppTransport(app), base_url=URL) as http:
        http.headers["Authorization"] = f"Bearer {OPERATOR}"
        for path in paths:
            known = re.sub("{[^}]*}", "joint_trajectory_controller", path)
            answers[path] = http.get(known).status_code
    # Its loop is stepped: it is not ready for others, and no stream is read like this.
    failed = {path: status for path, status in answers.items() if status >= 500}

    assert failed == {"/api/v1/ready": 503}
    assert len(paths) > 60


def test_mobile_robot_gets_controllers_for_its_wheels() -> None:
    config = configure_robot("example-robot-data:tiago_no_hand", "planar")
    drive = config["controllers"]["mobile_base_controller"]
    assert drive["left_wheel"] == ["wheel_left_joint"]
    assert drive["right_wheel"] == ["wheel_right_joint"]
    limbs = config["controllers"]["joint_trajectory_controller"]["joints"]
    assert "wheel_left_joint" not in limbs


def test_robot_without_motors_gets_its_joint_states() -> None:
    config = configure_robot("example-robot-data:iris")
    assert list(config["controllers"]) == ["joint_state_controller"]
    compose(load_config(config)).station.loop.step(10)


def test_doctor_tells_what_a_robot_needs() -> None:
    added = examine_robot("example-robot-data:so100")
    assert [repair.kind for repair in added] == ["armature", "gravity"]
    pairs, *_ = examine_robot("example-robot-data:ur3")
    assert pairs.kind == "self_collision"
    with pytest.raises(RobotDescriptionError, match="no robot 'nobody'"):
        examine_robot("example-robot-data:nobody")


def test_list_of_moveit_that_names_unknown_joints_is_refused_in_words(tmp_path) -> None:
    """And the controllers of the robot itself are there all the same."""
    file = tmp_path / "controllers.yaml"
    file.write_text(
        "controller_list:\n  - {name: arm, type: FollowJointTrajectory, "
        "joints: [elbow_joint, wrist_9_joint]}\n"
    )
    config = load_config(
        configure_robot("example-robot-data:ur5"), controller_files=[file]
    )
    composed = compose(config)
    assert list(composed.not_loaded) == ["arm"]
    assert "has no joint 'wrist_9_joint'" in composed.not_loaded["arm"].message
    names = [controller.name for controller in composed.station.controllers()]
    assert "joint_trajectory_controller" in names


LEGGED = """<robot name="r"><link name="base"/><link name="trunk">{mass}</link>
  <joint name="root" type="floating"><parent link="base"/><child link="trunk"/></joint>
  <link name="leg">{mass}</link><joint name="hip" type="revolute">
  <parent link="trunk"/><child link="leg"/>
  <limit lower="-1" upper="1" effort="5" velocity="2"/></joint></robot>"""
MASS = (
    '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" '
    'iyz="0"/></inertial>'
)


def test_robot_with_a_floating_root_joint_needs_a_floating_base(tmp_path) -> None:
    path = tmp_path / "legged.urdf"
    path.write_text(LEGGED.format(mass=MASS), encoding="utf-8")
    with pytest.raises(RobotDescriptionError) as refused:
        configure_robot(str(path))
    assert "--base floating" in refused.value.remedy
    assert (
        "joint_trajectory_controller" in configure_robot(str(path), "floating")["start"]
    )
    assert "base" in [one.kind for one in examine_robot(str(path), "floating")]
