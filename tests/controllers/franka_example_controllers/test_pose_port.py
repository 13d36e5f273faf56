"""A pose is a position and a unit quaternion."""

import pytest

from station.controllers.franka_example_controllers.pose_port import PosePort
from station.core.errors import InvalidCommandError

POSE = [0.3, 0.0, 0.5, 0.0, 0.6, 0.8, 0.0]


def test_pose_is_taken_once():
    port = PosePort()
    port.check(POSE)
    port.post(POSE)

    position, rotation = port.take_pose()
    assert position.tolist() == POSE[:3]
    assert rotation == pytest.approx(POSE[3:])
    assert port.take_pose() is None


@pytest.mark.parametrize("rotation", [[0.0] * 4, [0.5, 0.0, 0.0, 0.0]])
def test_quaternion_of_another_length_is_refused(rotation):
    with pytest.raises(InvalidCommandError, match="quaternion of the command has the"):
        PosePort().check([*POSE[:3], *rotation])
