"""effort_controllers/JointPositionController: the original's test, and more.

The one of ros_controllers@678b92a effort_controllers/test, TestPosition, is
`test_the_simple_robot_reaches_its_targets_one_after_the_other`.
"""

from pathlib import Path

import pytest
import yaml

from station.controllers.effort_controllers import JointPositionController

FOLDER = Path(__file__).parents[2] / "data" / "ros_yaml" / "effort_controllers"


def test_the_simple_robot_reaches_its_targets_one_after_the_other(make_robot, send):
    values = yaml.safe_load((FOLDER / "simple_bot_controllers.yaml").read_text())
    robot = make_robot(["joint"], (FOLDER / "simple_bot.urdf").read_text())
    controller = robot.start(JointPositionController, **values["position_controller"])
    for target in (1.0, -1.0, 0.0):
        send(controller, [target])
        robot.run_with_effort(controller, count=2000, period=0.01)
        # Tolerance of the original's test; the time constant is 2 s, 20 s have passed.
        assert robot.position[0] == pytest.approx(target, abs=5e-2)


def test_it_claims_its_joint_for_efforts(robot):
    controller = robot.load(JointPositionController, joint="slide", pid={"p": 1.0})
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::EffortJointInterface"
    assert claimed.resources == ("slide",)
    assert controller.gain_schema()["slide/p"].unit == "N/m"
