"""A pose is a position and a quaternion of length 1."""

import pytest

from station.controllers.franka_arm import PosePort
from station.core.errors import InvalidCommandError


@pytest.fixture
def port():
    return PosePort("xyzw", tolerance=0.01, timeout=0.2, longest=1.0)


@pytest.mark.parametrize("length", [1.0, 0.995, 1.005])
def test_a_rounded_quaternion_is_accepted(port, length):
    port.check([0.3, 0.0, 0.5, 0.6 * length, 0.0, -0.8 * length, 0.0])


@pytest.mark.parametrize("length", [0.0, 0.98, 1.02])
def test_a_quaternion_of_another_length_is_refused_with_a_remedy(port, length):
    with pytest.raises(InvalidCommandError, match="allowed is 1") as caught:
        port.check([0.3, 0.0, 0.5, 0.6 * length, 0.0, -0.8 * length, 0.0])

    assert "qx, qy, qz, qw" in caught.value.remedy
    assert caught.value.details["length"] == pytest.approx(length)


def test_a_pose_is_valid_for_at_most_the_longest_time(port):
    with pytest.raises(InvalidCommandError, match="timeout"):
        port.check([0.3, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0], 2.0)
