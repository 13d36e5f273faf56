"""A motion is in nobody's way but that of who commands the same joints."""

import pytest

from station.client.claims import in_the_way

RUNNING = {
    "torques": ("panda_joint1", "panda_joint2"),
    "pose": ("panda_robot",),
    "fingers": ("panda_finger_joint1",),
    "other": ("left_joint1",),
    "states": (),
}


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        (["panda_joint1"], ["torques", "pose"]),
        (["panda_robot"], ["torques", "pose"]),
        (["panda_finger_joint1"], ["fingers"]),
        (["left_robot"], ["other"]),
        ([], []),
    ],
)
def test_controllers_of_the_same_joints_are_found(wanted, found):
    assert in_the_way(wanted, RUNNING) == found
