"""Several arms are one URDF."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import Pose
from station.hw.franka.simulated.franka_world import ArmPlacement, combine_descriptions


def test_every_arm_stands_where_it_is_placed():
    description = load_robot_files("example-robot-data:panda")
    base = Pose.from_rpy((0.1, 0.2, 0.3), (0.0, 0.0, 0.5))
    text = combine_descriptions([
        ArmPlacement("left", description, base),
        ArmPlacement("right", description),
    ])

    assert text.count('name="left_joint1"') == 1
    assert text.count('name="right_joint7"') == 1
    assert 'xyz="0.1 0.2 0.3"' in text


@pytest.mark.parametrize("rpy", [(0.1, -0.2, 0.3), (0.0, 1.5, 0.0), (-3.0, 0.4, 2.0)])
def test_angles_are_recovered(rpy):
    assert Pose.from_rpy((0.0, 0.0, 0.0), rpy).rpy() == pytest.approx(rpy)
