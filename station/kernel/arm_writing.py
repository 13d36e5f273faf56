"""Send the commands of an arm in every cycle, and tell how the arm is."""

from collections.abc import Sized
from typing import Protocol

from station.kernel.arm_codes import MOVE
from station.kernel.command_sending import CommandSending
from station.kernel.doubles import Doubles
from station.kernel.stages import Robot, RobotWatch, Stage

_MOVE = MOVE


class Motion(Protocol):
    """The motion that controllers have begun."""

    is_active: bool
    is_waiting: bool


class Hand(Protocol):
    """The services of a hand."""

    is_moving: bool


class Fingers(Protocol):
    """The fingers of a hand."""

    hand: Hand
    claimed: Sized

    def write(self) -> None:
        """Pass on the commands of the fingers."""


class ArmWatch(RobotWatch):
    """Tells how an arm is.

    Args:
        robot: The robot.
        code: The arm's mode, one number.
        names: Name of each mode, by its number.
        motion: What controllers have begun.
    """

    def __init__(
        self, robot: Robot, code: Doubles, names: dict[float, str], motion: Motion
    ) -> None:
        super().__init__(robot)
        self.code = code
        self.names = names
        self.motion = motion

    def is_interrupted(self) -> bool:
        """Return whether the arm has left the motion that controllers command."""
        motion = self.motion
        if self.code[0] == _MOVE or not motion.is_active or motion.is_waiting:
            return False
        return True

    def mode(self) -> str:
        """Return the name of the arm's mode."""
        return self.names[self.code[0]]


class ArmWriting(Stage):
    """Sends the commands of an arm and of its fingers.

    Args:
        code: The arm's mode, one number.
        sender: Sends the commands while a motion runs.

    Attributes:
        fingers: The fingers; None without a simulated hand.
    """

    def __init__(self, code: Doubles, sender: CommandSending) -> None:
        self.code = code
        self.sender = sender
        self.fingers: Fingers | None = None

    def run(self, time: float, period: float) -> None:
        """Send the commands; see `Stage.run`."""
        fingers = self.fingers
        if fingers is not None and (fingers.claimed or fingers.hand.is_moving):
            fingers.write()
        if self.code[0] == _MOVE:
            self.sender.send_limited(period)
