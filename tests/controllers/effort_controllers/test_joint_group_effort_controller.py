"""effort_controllers/JointGroupEffortController: its interface and its unit."""

from station.controllers.effort_controllers import JointGroupEffortController


def test_it_claims_its_joints_for_effort_commands(robot):
    controller = robot.load(JointGroupEffortController, joints=["elbow", "wheel"])
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::EffortJointInterface"
    assert claimed.resources == ("elbow", "wheel")


def test_its_set_points_have_the_unit_of_the_command(robot):
    controller = robot.load(JointGroupEffortController, joints=["elbow", "wheel"])
    assert controller.set_points.elements[0].unit == "Nm"
