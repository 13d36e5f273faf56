"""What a control cycle does, one thing after the other."""

from typing import Protocol


class Stage:
    """One of the things that every cycle does. Control thread only."""

    def run(self, time: float, period: float) -> None:
        """Do it.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError


class Robot(Protocol):
    """What is read and written in every cycle."""

    def read(self, time: float, period: float) -> None:
        """Bring its state up to date."""

    def write(self, time: float, period: float) -> None:
        """Send its commands."""

    def is_interrupted(self) -> bool:
        """Return whether it no longer carries out the commands of controllers."""

    def mode(self) -> str:
        """Return its mode."""


class RobotWatch:
    """Asks a robot in every cycle how it is, by its own methods.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def is_interrupted(self) -> bool:
        """Return whether it no longer carries out the commands of controllers."""
        return self.robot.is_interrupted()

    def mode(self) -> str:
        """Return its mode."""
        return self.robot.mode()


class RobotReading(Stage):
    """Reads a robot by its own method.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def run(self, time: float, period: float) -> None:
        """Read the robot."""
        self.robot.read(time, period)


class RobotWriting(Stage):
    """Writes a robot by its own method.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def run(self, time: float, period: float) -> None:
        """Write to the robot."""
        self.robot.write(time, period)


class StageSequence(Stage):
    """Several stages, run in order.

    Args:
        stages: The stages.
    """

    def __init__(self, stages: list[Stage]) -> None:
        self.stages = stages

    def run(self, time: float, period: float) -> None:
        """Run all of them."""
        for stage in self.stages:
            stage.run(time, period)
