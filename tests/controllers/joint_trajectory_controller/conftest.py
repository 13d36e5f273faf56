"""A position-controlled trio of joints, and goals for it."""

import pytest

from station.controllers.joint_trajectory_controller.position_controllers import (
    JointTrajectoryController,
)

JOINTS = ["slide", "elbow", "wheel"]


@pytest.fixture
def start(robot):
    """Return a way to start a controller that commands positions."""

    def start_controller(**values):
        return robot.start(JointTrajectoryController, **({"joints": JOINTS} | values))

    return start_controller


@pytest.fixture
def make_goal():
    """Return a way to make goals: points are (time_from_start, positions, ...)."""

    def make(*points, joints=JOINTS, stamp=0.0, **fields):
        keys = ("time_from_start", "positions", "velocities", "accelerations")
        return {
            "trajectory": {
                "joint_names": joints,
                "stamp": stamp,
                "points": [dict(zip(keys, point, strict=False)) for point in points],
            },
            **fields,
        }

    return make
