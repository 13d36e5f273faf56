"""What the layers draw."""

import math

import pytest

from station.core.description.urdf import Pose
from station.ui.layers.scene_facts import (
    PlacedRobot,
    arm_facts,
    commanded_positions,
    commanding,
    pose_of,
)
from station.ui.robot_model import load_robot
from tests.ui.views import controller, element, sample, view

TURN = math.sqrt(0.5)
IDENTITY = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]


def test_a_franka_has_base_and_flange(panda):
    assert (panda.base, panda.flange) == ("panda_link0", "panda_link8")
    assert panda.node_of("panda_link1") == "/robot/panda_link0/panda_link1"


def test_the_flange_of_another_robot_is_its_last_link():
    robot = PlacedRobot(load_robot("example-robot-data:ur5"), "/robot")
    assert robot.base == "base_link"
    assert robot.flange in {"tool0", "ee_link"}


def test_the_flange_is_where_the_datasheet_says(panda):
    # At zero the arm is straight: 0.088 m in front, 0.333 + 0.316 + 0.384 m high, and
    # the flange hangs 0.107 m below (Franka Emika, Denavit-Hartenberg parameters).
    flange = panda.poses({})[panda.flange].xyz
    assert flange == pytest.approx((0.088, 0.0, 0.926), abs=1e-9)


@pytest.mark.parametrize(
    "quaternion",
    [
        (1.0, 0, 0, 0),
        (0, 1.0, 0, 0),
        (0, 0, 1.0, 0),
        (0, 0, 0, 1.0),
        (TURN, 0, 0, TURN),
    ],
)
def test_a_matrix_gives_its_pose(quaternion):
    pose = Pose((1.0, 2.0, 3.0), quaternion)
    columns = [
        pose.compose(Pose(axis)).xyz for axis in ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))
    ]
    matrix = []
    for column in columns:
        matrix += [*(a - b for a, b in zip(column, pose.xyz, strict=True)), 0.0]
    found = pose_of([*matrix, *pose.xyz, 1.0])
    assert found.xyz == pose.xyz
    same = sum(a * b for a, b in zip(found.quaternion, quaternion, strict=True))
    assert abs(same) == pytest.approx(1.0)


def test_the_force_on_the_arm_is_opposite_to_that_of_the_arm():
    state = {
        "F_T_EE": IDENTITY,
        "EE_T_K": IDENTITY,
        "O_F_ext_hat_K": [1.0, -2, 3, 0, 0, 0],
    }
    assert arm_facts(state).force == (-1.0, 2.0, -3.0)


def test_what_an_arm_does_not_tell_is_not_drawn():
    facts = arm_facts({"O_F_ext_hat_K": [None] * 6})
    assert facts.force is None
    assert facts.flange_to_tool == Pose()


def _running(unit="rad", kind="family/Kind"):
    held = controller("arm", "running").model_copy(update={"type": kind})
    elements = (element("joint1", unit),) if unit else ()
    return view(
        held,
        elements={"arm": elements},
        samples={"arm": sample(1.0, desired=0.5, names=("joint1",))},
    )


@pytest.mark.parametrize(
    ("running", "commands"),
    [
        (_running(), {"joint1": 0.5}),
        (_running("Nm"), {}),
        (
            _running("", "position_controllers/JointTrajectoryController"),
            {"joint1": 0.5},
        ),
        (_running("", "joint_state_controller/JointStateController"), {}),
    ],
)
def test_only_controllers_of_positions_command_a_pose(running, commands):
    assert commanded_positions(running) == commands
    assert commanding(running) == ({"arm"} if commands else set())
