"""Flags of an arm that every cycle looks at; whoever sets them is a subclass.

Compiled, they are fields of C, which are read without a look-up.
"""


class MotionFlags:
    """Tells about the motion of an arm that controllers command.

    Attributes:
        is_active: Whether controllers give any command.
        is_waiting: Whether the arm is coming to rest before a motion.
    """

    def __init__(self) -> None:
        self.is_active = False
        self.is_waiting = False

    def advance(self, cycles: int) -> None:
        """Begin a motion that waits, if the arm is ready for it.

        Args:
            cycles: Cycles of the arm since the last call.
        """
        raise NotImplementedError


class ContactFlag:
    """Tells about the contacts of an arm.

    Attributes:
        is_quiet: Whether nothing touches the arm.
    """

    def __init__(self) -> None:
        self.is_quiet = True


class AlertFlag:
    """Tells about the readings of an arm.

    Attributes:
        is_alert: Whether something was unusual in the cycle before.
    """

    def __init__(self) -> None:
        self.is_alert = False
