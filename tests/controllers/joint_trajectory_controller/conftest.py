"""A position-controlled trio of joints, and goals for it."""

import pytest

from station.controllers.joint_trajectory_controller import (
    PositionJointTrajectoryController,
)
from tests.controllers.joint_trajectory_controller.rrbot import FOLDER, RRBot

JOINTS = ["slide", "elbow", "wheel"]
# The original runs its tests with the first three.
VARIANTS = {
    "position": "rrbot_controllers.yaml",
    "stop ramp": "rrbot_controllers_stopramp.yaml",
    "velocity": "rrbot_vel_controllers.yaml",
    "effort": "rrbot_effort_controllers.yaml",
    "pos_vel": "rrbot_pos_vel_controllers.yaml",
    "pos_vel_acc": "rrbot_pos_vel_acc_controllers.yaml",
}
ORIGINAL_VARIANTS = ["position", "stop ramp", "velocity"]


@pytest.fixture
def start(robot):
    """Return a way to start a controller that commands positions."""

    def start_controller(**values):
        return robot.start(
            PositionJointTrajectoryController, **({"joints": JOINTS} | values)
        )

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


@pytest.fixture
def make_rrbot(tmp_path):
    """Return a way to build the robot of the original's tests, by variant or file."""

    def make(variant, **options):
        file = FOLDER / VARIANTS.get(variant, variant)
        return RRBot(tmp_path, file, **options)

    return make


@pytest.fixture(params=VARIANTS)
def rrbot(request, make_rrbot):
    """Return the robot under each interface that trajectories may command."""
    return make_rrbot(request.param)


@pytest.fixture(params=ORIGINAL_VARIANTS)
def original_rrbot(request, make_rrbot):
    """Return the robot in the three variants of the original's launch files."""
    return make_rrbot(request.param)
