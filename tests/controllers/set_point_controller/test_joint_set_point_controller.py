"""What all set-point controllers share, shown on the smallest one possible."""

import pytest

from station.controllers.set_point_controller import (
    JointQuantity,
    JointSetPointController,
)
from station.core.errors import RobotDescriptionError
from station.core.hardware.interfaces import VelocityJointInterface


class Follower(JointSetPointController[VelocityJointInterface]):
    """Only remembers the set-point in force."""

    hardware_interface = VelocityJointInterface
    quantity = JointQuantity.VELOCITY

    def update(self, time, period):
        """Take the newest set-point."""
        self.followed = self.newest_set_point()


def test_the_newest_of_several_set_points_counts(robot, send):
    controller = robot.start(Follower, joints=["wheel"])
    send(controller, [0.1])
    send(controller, [0.2])
    robot.step(controller)
    assert controller.followed == [0.2]


def test_restarting_begins_with_rest_again(robot, send):
    controller = robot.start(Follower, joints=["wheel"])
    send(controller, [0.1])
    robot.step(controller)
    controller.stop_request(robot.time)
    controller.start_request(robot.time)
    robot.step(controller)
    assert controller.followed == [0.0]


def test_a_joint_that_the_description_lacks_is_refused(make_robot):
    robot = make_robot(urdf="<robot><joint name='other' type='fixed'/></robot>")
    with pytest.raises(RobotDescriptionError, match="no joint 'wheel'"):
        robot.load(Follower, joints=["wheel"])
