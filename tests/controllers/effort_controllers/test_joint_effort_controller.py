"""effort_controllers/JointEffortController: its interface and its unit."""

from station.controllers.effort_controllers import JointEffortController


def test_it_claims_its_joint_for_effort_commands(robot):
    controller = robot.load(JointEffortController, joint="elbow")
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::EffortJointInterface"
    assert claimed.resources == ("elbow",)


def test_its_set_points_have_the_unit_of_the_command(robot):
    controller = robot.load(JointEffortController, joint="elbow")
    assert controller.set_points.elements[0].unit == "Nm"
