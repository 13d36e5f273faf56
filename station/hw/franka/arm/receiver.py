"""Takes the commands of an arm, one object per kind of command.

An arm of another package needs none of it: the `command_...` methods of `RobotArm` are
called. An arm whose commands are taken by compiled code supplies receivers of its own.
"""

from collections.abc import Callable

from station.memory.doubles import Doubles, Storage


class Receiver:
    """Takes commands for an arm by a Python function.

    Args:
        function: Takes the commands.
    """

    def __init__(self, function: Callable[[Storage], object]) -> None:
        self.function = function

    def receive(self, values: Storage) -> None:
        """Take commands for the next cycle."""
        self.function(values)


class PoseReceiver:
    """Takes poses of the end effector, as far as nothing unusual is about them."""

    def is_open(self) -> bool:
        """Return whether the motion that runs commands the end effector."""
        raise NotImplementedError

    def is_settled(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        raise NotImplementedError

    def receive(self, pose: Doubles) -> bool:
        """Take a pose without an elbow for the next cycle.

        Args:
            pose: The pose, 16 numbers.

        Returns:
            Whether it was taken; if not, nothing has changed.
        """
        raise NotImplementedError
