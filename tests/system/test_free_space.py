"""The default arm finds no collision in free space."""

from itertools import permutations

import pytest

import station
from station.client.poses import POSES
from station.core.facade.robots import Robots
from station.core.franka.arms import Arms
from station.core.franka.franka_robot_state import RobotMode

pytestmark = pytest.mark.long

HIGH = [0.0, 0.0, 2.0]  # no pose touches the floor

# From random motions in the whole range of the joints: those whose estimated forces
# were the largest, 24 to 31 N, while nothing touched the arm. Duration [s].
WORST = [
    (
        [-1.293, 1.181, 1.9, -0.597, 0.676, 2.411, -2.564],
        [-0.414, 0.427, -1.288, -1.049, 0.298, 2.479, 2.021],
        18.3425,
    ),
    (
        [1.926, 0.089, 0.793, -0.999, -0.761, 1.926, -0.815],
        [-1.271, -1.447, 2.196, -2.023, 1.202, 0.795, 0.546],
        6.39345,
    ),
    (
        [1.425, 0.193, 1.626, -2.041, -1.659, 1.891, -1.549],
        [0.507, 0.15, 1.081, -2.94, 1.631, 0.485, -0.142],
        6.57999,
    ),
    (
        [-1.876, 0.372, -1.428, -0.398, 2.021, 1.976, -1.447],
        [-2.024, -0.922, 0.153, -1.325, -2.064, 2.775, -0.077],
        3.45249,
    ),
]


def mode_of(robots: Robots) -> RobotMode:
    return Arms(robots).report("panda").robot_mode


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("duration", [None, 2.0, 6.0])
def test_the_arm_moves_between_its_named_poses(
    seed: int, duration: float | None
) -> None:
    with station.open(settings={"robot.realism_seed": seed}) as robot:
        for begin, end in permutations(POSES, 2):
            robot.move_to(begin, duration=duration)
            robot.move_to(end, duration=duration)
            robot.run(0.5)
            assert mode_of(robot.facade.robots) is RobotMode.MOVE


@pytest.mark.parametrize("seed", [0, 5])
@pytest.mark.parametrize("case", range(len(WORST)))
def test_the_arm_moves_through_nearly_singular_poses(case: int, seed: int) -> None:
    begin, end, duration = WORST[case]
    settings = {"robot.realism_seed": seed, "robot.base_xyz": HIGH}
    with station.open(settings=settings) as robot:
        robot.reset(dict(zip(robot.joint_names, begin, strict=False)))
        robot.run(0.05)
        robot.move_to(end, duration=duration)
        robot.run(0.5)
        assert mode_of(robot.facade.robots) is RobotMode.MOVE
