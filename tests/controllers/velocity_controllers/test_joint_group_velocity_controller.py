"""velocity_controllers/JointGroupVelocityController: its interface and its unit."""

from station.controllers.velocity_controllers import JointGroupVelocityController


def test_it_claims_its_joints_for_velocity_commands(robot):
    controller = robot.load(JointGroupVelocityController, joints=["elbow", "wheel"])
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::VelocityJointInterface"
    assert claimed.resources == ("elbow", "wheel")


def test_its_set_points_have_the_unit_of_the_command(robot):
    controller = robot.load(JointGroupVelocityController, joints=["elbow", "wheel"])
    assert controller.set_points.elements[0].unit == "rad/s"
