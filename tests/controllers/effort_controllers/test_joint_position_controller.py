"""effort_controllers/JointPositionController: the original's simple robot."""

import pytest

from station.controllers.effort_controllers import JointPositionController

SIMPLE_BOT = """
<robot name="simple_bot">
  <joint name="joint" type="prismatic">
    <limit lower="-2" upper="2" velocity="1" effort="1"/>
  </joint>
</robot>
"""


@pytest.mark.parametrize("target", [1.0, -1.0, 0.0])
def test_the_simple_robot_reaches_its_targets(make_robot, send, target):
    robot = make_robot(["joint"], SIMPLE_BOT)
    controller = robot.start(
        JointPositionController, joint="joint", pid={"p": 0.25, "d": 1.0, "i": 0.0}
    )
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
