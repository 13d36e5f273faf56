"""The target pose is the newest set-point, or rest once it has expired."""

import pytest

from station.controllers.franka_arm.pose_target import PoseTarget
from station.core.clock import ManualClock
from station.core.errors import CommandTimeoutError, InvalidCommandError
from station.core.parameters import Parameters, ParameterTree

REST = [0.1, 0.0, 0.4, 1.0, 0.0, 0.0, 0.0]
POSE = [0.3, 0.0, 0.5, 0.0, 0.6, 0.8, 0.0]


def make_target(**params):
    """Return a target whose rest is `REST`."""
    target = PoseTarget(Parameters(ParameterTree(params)), "arm", lambda: list(REST))
    target.port.clock = ManualClock()
    target.start_at_rest()
    return target


def test_a_pose_is_returned_once():
    target = make_target()
    assert target.newest() is None
    target.port.check(POSE)
    target.port.post(POSE)

    position, rotation = target.newest()
    assert position.tolist() == POSE[:3]
    assert rotation == pytest.approx(POSE[3:])
    assert target.newest() is None


def test_rest_replaces_an_expired_pose():
    target = make_target(command_timeout=0.2)
    target.port.post(POSE)
    target.newest()
    target.port.clock.advance(0.3)

    position, _ = target.newest()

    assert position.tolist() == REST[:3]


def test_the_timeout_of_a_pose_can_fail_the_controller():
    target = make_target(command_timeout=0.2, command_timeout_action="stop")
    target.port.post(POSE)
    target.newest()
    target.port.clock.advance(0.3)

    with pytest.raises(CommandTimeoutError, match="arm"):
        target.newest()


@pytest.mark.parametrize("rotation", [[0.0] * 4, [0.5, 0.0, 0.0, 0.0]])
def test_a_quaternion_whose_length_is_not_1_is_refused(rotation):
    with pytest.raises(InvalidCommandError, match="has the length"):
        make_target().port.check([*POSE[:3], *rotation])
