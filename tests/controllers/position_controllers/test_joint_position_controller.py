"""position_controllers/JointPositionController: its interface and its unit."""

from station.controllers.position_controllers import JointPositionController


def test_it_claims_its_joint_for_position_commands(robot):
    controller = robot.load(JointPositionController, joint="elbow")
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claimed.resources == ("elbow",)


def test_its_set_points_have_the_unit_of_the_command(robot):
    controller = robot.load(JointPositionController, joint="elbow")
    assert controller.set_points.elements[0].unit == "rad"
