"""The friction of an arm's joints, as a part that acts before every step."""

from collections.abc import Callable


class JointFriction:
    """Lets friction act in a `World`, whatever the arm does. Control thread only.

    Args:
        rub: Sets the friction torques of the coming step, and returns True.

    Attributes:
        before_step: As given.
    """

    def __init__(self, rub: Callable[[], bool]) -> None:
        self.before_step = rub

    def attend(self) -> None:
        """Nothing: friction has no cycle that is not a usual one."""

    def after_reset(self) -> None:
        """Nothing: friction has no memory."""
