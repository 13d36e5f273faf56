"""Fingers hold their width against a push."""

import pytest

from station.hw.franka.simulated_gripper import SimulatedGripper
from station.hw.franka.simulation import ArmPlacement, simulate
from station.hw.robot_description import load_robot_description


@pytest.mark.parametrize("width", [0.08, 0.04, 0.0])
def test_fingers_go_to_the_width_and_stay(width: float) -> None:
    description = load_robot_description("example-robot-data:panda")
    simulation = simulate([ArmPlacement("panda", description)])
    world = simulation.world
    # It acts after the one that holds the hand open and so has the last word.
    SimulatedGripper(world, "panda_finger_joint1", width=width)
    world.data.qfrc_applied[7] = -1.0
    for _ in range(1_000):
        world.step()
    # 1 N at 5000 N/m is 0.2 mm.
    expected = [width / 2.0] * 2
    assert world.data.qpos[7:] == pytest.approx(expected, abs=3e-4)
