"""Robots in one MuJoCo world begin anew after its reset."""

from math import inf

import mujoco
import pytest

from station.core.errors import HardwareInterfaceError
from station.hw.mujoco.shared_world import SharedWorld
from station.hw.mujoco.world import World

MODEL = """
<mujoco><worldbody><body><joint name="hinge"/><geom size="0.1"/></body></worldbody>
</mujoco>"""


class Robot:
    """Counts how often it began anew."""

    def __init__(self, longest: float) -> None:
        self.beginnings = 0
        self.longest = longest

    def begin_anew(self) -> None:
        self.beginnings += 1

    def longest_period(self) -> float:
        return self.longest


@pytest.fixture
def world() -> SharedWorld:
    return SharedWorld(World(mujoco.MjModel.from_xml_string(MODEL)))


def test_every_robot_begins_anew_after_the_reset(world):
    robots = [Robot(0.1), Robot(0.2)]
    for robot in robots:
        world.add_robot(robot)
    world.world.step()
    assert world.time() > 0.0

    world.reset({"hinge": 0.4})

    assert world.time() == 0.0
    assert world.world.data.qpos[0] == 0.4
    assert [robot.beginnings for robot in robots] == [1, 1]
    with pytest.raises(HardwareInterfaceError, match="elbow"):
        world.reset({"elbow": 0.0})
    assert robots[0].beginnings == 1


def test_world_waits_as_its_least_patient_robot_does(world):
    assert world.longest_period() == inf
    world.add_robot(Robot(0.1))
    world.add_robot(Robot(0.2))
    assert world.longest_period() == 0.2
