"""Send the commands of an arm in every cycle, and tell how the arm is."""

from collections.abc import Callable, Sized
from typing import Protocol

from station.core.hardware.stages import Robot, RobotWatch, Stage
from station.hw.franka.arm.arm_codes import MOVE
from station.hw.franka.arm.flags import MotionFlags
from station.hw.franka.commands.command_sender import CommandSender
from station.memory.doubles import Doubles

_MOVE = MOVE


class Hand(Protocol):
    """The services of a hand."""

    is_moving: bool


class Fingers(Protocol):
    """The fingers of a hand."""

    @property
    def hand(self) -> Hand:
        """The services of their hand."""

    @property
    def claimed(self) -> Sized:
        """What is claimed of them."""

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
        self, robot: Robot, code: Doubles, names: dict[float, str], motion: MotionFlags
    ) -> None:
        super().__init__(robot)
        self.code = code
        self.names = names
        self.motion = motion
        self.last_code = code[0]
        self.last_name = names[code[0]]

    def is_interrupted(self) -> bool:
        """Return whether the arm has left the motion that controllers command."""
        motion = self.motion
        if self.code[0] == _MOVE:
            return False
        return motion.is_active and not motion.is_waiting

    def mode(self) -> str:
        """Return the name of the arm's mode."""
        code = self.code[0]
        if code != self.last_code:
            self.last_code, self.last_name = code, self.names[code]
        return self.last_name


class ArmWriting(Stage):
    """Sends the commands of an arm and of its fingers.

    Args:
        sender: Sends the commands while a motion runs.
    """

    def __init__(self, sender: CommandSender) -> None:
        self.sender = sender
        self.hand: Hand | None = None
        self.write_fingers: Callable[[], object] | None = None
        self.claimed: Sized = ()

    def add_fingers(self, fingers: Fingers) -> None:
        """Send the commands of fingers, too."""
        self.hand, self.write_fingers = fingers.hand, fingers.write
        self.claimed = fingers.claimed

    def run(self, time: float, period: float) -> None:
        """Send the commands; see `Stage.run`."""
        hand, write = self.hand, self.write_fingers
        if hand is None or write is None:
            pass  # without a simulated hand there are no fingers
        elif self.claimed or hand.is_moving:
            write()
        self.sender.send_commands(period)
