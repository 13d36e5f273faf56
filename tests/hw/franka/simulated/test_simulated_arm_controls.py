"""Pushes and collisions of a simulated arm stay within the configured range."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import InvalidCommandError
from station.core.franka import FaultKind, SimulatedFault
from station.hw.franka.arm.service_limits import ServiceLimits
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate

ZEROS = [0.0] * 3
HAND = "panda_hand"


@pytest.fixture
def world():
    description = load_robot_files("example-robot-data:panda")
    limits = ServiceLimits(push_force=50.0, push_duration=2.0)
    return simulate([ArmPlacement("panda", description, service_limits=limits)])


@pytest.mark.parametrize(
    ("push", "message"),
    [
        ((HAND, [0.0, 0.0, 1e308], ZEROS, 1.0), "force of a push is .* 50 N"),
        ((HAND, ZEROS, [0.0, 101.0, 0.0], 1.0), "torque of a push is .* 100 Nm"),
        ((HAND, ZEROS, ZEROS, 2.1), r"push of 2\.1 s .* at most 2 s"),
        ((HAND, ZEROS, ZEROS, 0.0), r"push of 0\.0 s .* above 0 s"),
    ],
)
def test_push_out_of_range_is_refused_and_nothing_is_pushed(world, push, message):
    with pytest.raises(InvalidCommandError, match=message):
        world.arms["panda"].simulation().apply_force(*push)
    assert not world.world.data.xfrc_applied.any()


def test_point_far_from_the_link_is_refused(world):
    with pytest.raises(InvalidCommandError, match=r"point of a push is .* 10 m"):
        world.arms["panda"].simulation().apply_force(
            HAND, ZEROS, ZEROS, 1.0, point=[0.0, 0.0, 11.0]
        )


def test_collision_is_no_harder_than_a_push(world):
    with pytest.raises(InvalidCommandError, match=r"force of a push is .* 50 N"):
        world.arms["panda"].simulation().inject(
            SimulatedFault(FaultKind.COLLISION, 10, force=(0.0, 0.0, -60.0))
        )
