"""Fingers hold their width against a push."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate


@pytest.mark.parametrize("width", [0.08, 0.04, 0.0])
def test_fingers_go_to_the_width_and_stay(width: float) -> None:
    description = load_robot_files("example-robot-data:panda")
    simulation = simulate([ArmPlacement("panda", description)])
    world = simulation.world
    simulation.grippers["panda"].hold(width)
    world.data.qfrc_applied[7] = -1.0
    for _ in range(1_000):
        world.step()
    # 1 N at 5000 N/m is 0.2 mm.
    expected = [width / 2.0] * 2
    assert world.data.qpos[7:] == pytest.approx(expected, abs=3e-4)


def test_pressing_fingers_close_and_holding_fingers_keep_their_width() -> None:
    description = load_robot_files("example-robot-data:panda")
    simulation = simulate([ArmPlacement("panda", description)])
    world, gripper = simulation.world, simulation.grippers["panda"]
    gripper.press(-0.5)
    for _ in range(20):
        world.step()
    assert gripper.read_force() == pytest.approx(-0.5)
    assert gripper.read_velocity() < 0.0
    assert gripper.read_position() < 0.039

    gripper.hold(0.05)
    for _ in range(500):
        world.step()

    assert gripper.read_position() == pytest.approx(0.025, abs=1e-4)
    world.reset()
    for _ in range(10):
        world.step()
    assert gripper.read_position() == pytest.approx(0.04, abs=1e-4)


def test_a_blocked_hold_presses_with_its_force_and_no_more() -> None:
    description = load_robot_files("example-robot-data:panda")
    simulation = simulate([ArmPlacement("panda", description)])
    world, gripper = simulation.world, simulation.grippers["panda"]
    gripper.hold(-1.0, speed=0.4, force=30.0)
    for _ in range(1_000):
        world.step()

    assert gripper.read_position() == pytest.approx(0.0, abs=1e-3)
    assert gripper.read_force() == pytest.approx(-30.0, rel=1e-3)
    assert gripper.read_time() == pytest.approx(1.0)
