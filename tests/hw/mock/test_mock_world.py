"""The mock's world advances its joints and puts them back."""

import pytest

from station.core.errors import HardwareInterfaceError
from station.hw.mock import MockJoints, MockWorld


def test_reset_takes_time_and_joints_back_to_their_start():
    joints = MockJoints([0.1, 0.2])
    world = MockWorld(["a", "b"], joints)
    world.advance(0.5)
    joints.position[:] = [1.0, 2.0]
    assert world.time() == 0.5

    world.reset({"b": 0.7})

    assert world.time() == 0.0
    assert joints.position == [0.1, 0.7]


def test_unknown_joint_is_refused_and_nothing_changes():
    joints = MockJoints([0.1])
    world = MockWorld(["a"], joints)
    joints.position[:] = [1.0]

    with pytest.raises(HardwareInterfaceError, match="no joint 'c'"):
        world.reset({"a": 0.5, "c": 0.5})
    assert joints.position == [1.0]
