"""velocity_controllers/JointTrajectoryController: its interface."""

from station.controllers.joint_trajectory_controller.velocity_controllers import (
    JointTrajectoryController,
)


def test_it_claims_its_joints_for_velocity_commands(robot):
    controller = robot.load(
        JointTrajectoryController,
        joints=["elbow", "slide"],
        gains={"elbow": {"p": 1.0}, "slide": {"p": 1.0}},
    )
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::VelocityJointInterface"
    assert claimed.resources == ("elbow", "slide")
    assert controller.joint_names == ["elbow", "slide"]
