"""velocity_controllers/JointVelocityController: its interface and its unit."""

from station.controllers.velocity_controllers import JointVelocityController


def test_it_claims_its_joint_for_velocity_commands(robot):
    controller = robot.load(JointVelocityController, joint="elbow")
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::VelocityJointInterface"
    assert claimed.resources == ("elbow",)


def test_its_set_points_have_the_unit_of_the_command(robot):
    controller = robot.load(JointVelocityController, joint="elbow")
    assert controller.set_points.elements[0].unit == "rad/s"
