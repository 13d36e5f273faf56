"""position_controllers/JointGroupPositionController: its interface and its unit."""

from station.controllers.position_controllers import JointGroupPositionController


def test_it_claims_its_joints_for_position_commands(robot):
    controller = robot.load(JointGroupPositionController, joints=["elbow", "wheel"])
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claimed.resources == ("elbow", "wheel")


def test_its_set_points_have_the_unit_of_the_command(robot):
    controller = robot.load(JointGroupPositionController, joints=["elbow", "wheel"])
    assert controller.set_points.elements[0].unit == "rad"
