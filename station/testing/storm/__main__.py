"""Run a storm: `python -m station.testing.storm --operations 100000`."""

import argparse
import random
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from station.core.franka.franka_services import ArmSimulation
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW
from station.hw.robot_loader import create_robot
from station.testing.storm import Fault, storm


@dataclass(frozen=True)
class StormRobot:
    """A robot for the storm.

    Attributes:
        create: Function that returns the robot, initialised.
        faults: Function that returns the possible faults of the robot.
        drift: How far one of its joints may move without an owner [rad or m].
    """

    create: Callable[[], RobotHW]
    faults: Callable[[RobotHW], Sequence[Fault]]
    drift: float


def create(robot_type: str, parameters: Mapping[str, object]) -> RobotHW:
    """Return a robot of the station's table, initialised.

    Args:
        robot_type: Its type.
        parameters: Its parameters.

    Raises:
        StationError: The type is unknown, or a parameter is not allowed.
    """
    tree, robot = Parameters(), create_robot(robot_type)
    tree.set("hw", dict(parameters))
    robot.init(tree, tree.namespace("hw"))
    return robot


def mock_faults(robot: RobotHW) -> list[Fault]:
    """Return the possible faults of a mock, or of a combined robot's mocks."""
    if isinstance(robot, CombinedRobotHW):
        return [one for part in robot.robots.values() for one in mock_faults(part)]
    return [partial(_upset_mock, robot)] if isinstance(robot, MockRobotHW) else []


def _upset_mock(robot: MockRobotHW, dice: random.Random) -> None:
    script = robot.script
    script.switch_cycles = dice.choice([0, 0, 1, 3])
    script.nan_sensors = set()
    if dice.random() < 0.3:
        script.nan_sensors = {dice.choice(robot.joint_names)}


def franka_faults(robot: RobotHW) -> list[Fault]:
    """Return the possible faults of a simulated Franka: a pressed user stop."""
    arm = getattr(robot, "arm", None)
    simulation = None if arm is None else arm.simulation()
    if not isinstance(simulation, ArmSimulation):
        return []

    def press(dice: random.Random) -> None:
        simulation.set_user_stop(pressed=dice.random() < 0.3)

    return [press]


_JOINTS = ["joint1", "joint2", "joint3"]
_PANDA = {
    "arm_id": "panda",
    "joint_names": [f"panda_joint{number}" for number in range(1, 8)],
    "robot_description": "example-robot-data:panda",
}
_TWO_MOCKS = {
    "robot_hardware": ["left", "right"],
    "left": {"type": "mock_hw/MockRobotHW", "joints": ["left_joint1", "left_joint2"]},
    "right": {
        "type": "mock_hw/MockRobotHW",
        "joints": ["right_joint1", "right_joint2"],
    },
}
ROBOTS: Mapping[str, StormRobot] = {
    "mock": StormRobot(
        partial(create, "mock_hw/MockRobotHW", {"joints": _JOINTS}), mock_faults, 1e-9
    ),
    "combined": StormRobot(
        partial(create, "combined_robot_hw/CombinedRobotHW", _TWO_MOCKS),
        mock_faults,
        1e-9,
    ),
    "franka": StormRobot(
        partial(create, "franka_hw/FrankaHW", _PANDA), franka_faults, 0.01
    ),
}
"""The robots by their short names."""


def main(words: list[str] | None = None) -> int:
    """Run a storm and print its report; return 1 if a contract was violated.

    Args:
        words: The words of the command line; None for those of this process.
    """
    parser = argparse.ArgumentParser(prog="python -m station.testing.storm")
    parser.add_argument("--operations", type=int, default=10_000)
    parser.add_argument("--threads", type=int, default=4)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robot", choices=ROBOTS, default="mock")
    options = parser.parse_args(words)
    robot = ROBOTS[options.robot]
    report = storm(
        robot.create,
        operations=options.operations,
        threads=options.threads,
        seed=options.seed,
        faults=robot.faults,
        drift=robot.drift,
    )
    sys.stdout.write(f"{report}\n")
    return 0 if report.ok else 1


if __name__ == "__main__":
    sys.exit(main())
