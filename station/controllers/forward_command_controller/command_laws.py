"""How controllers compute commands from what is desired and what is measured."""

from station.core.numerics.joint_errors import JointErrors
from station.core.numerics.pid_group import PidGroup, add_feed_forward
from station.memory.doubles import Doubles
from station.memory.vectors import copy_into


class CommandLaw:
    """Computes the commands of n joints; reads and writes memory that it was given."""

    def command(self, period: float) -> None:
        """Write the commands.

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError


class DirectLaw(CommandLaw):
    """Commands what is desired.

    Args:
        desired: Desired values, shape (n,).
        commands: Where the commands are written, shape (n,).
    """

    def __init__(self, desired: Doubles, commands: Doubles) -> None:
        self.desired = desired
        self.commands = commands
        self.size = len(commands)

    def command(self, period: float) -> None:
        """Copy the desired values."""
        copy_into(self.commands, 0, self.desired, self.size)


class ComparingLaw(DirectLaw):
    """Commands what is desired, and compares it with what is measured.

    Args:
        desired: Desired values, shape (n,).
        commands: Where the commands are written, shape (n,).
        errors: Compares.
    """

    def __init__(
        self, desired: Doubles, commands: Doubles, errors: JointErrors
    ) -> None:
        DirectLaw.__init__(self, desired, commands)
        self.errors = errors

    def command(self, period: float) -> None:
        """Copy the desired values, and compare them."""
        copy_into(self.commands, 0, self.desired, self.size)
        self.errors.compare()


class PidLaw(CommandLaw):
    """Commands what PIDs compute, and shares of desired rates.

    Args:
        pids: One PID per joint; their errors and rates are known.
        rates: Desired rates, shape (n,).
        shares: By how much the rates are multiplied, shape (n,).
    """

    def __init__(self, pids: PidGroup, rates: Doubles, shares: Doubles) -> None:
        self.pids = pids
        self.commands = pids.commands
        self.rates = rates
        self.shares = shares
        self.feeds_forward = any(shares)

    def command(self, period: float) -> None:
        """Compute the commands."""
        self.pids.compute_with_rates(period)
        if self.feeds_forward:
            add_feed_forward(self.commands, self.rates, self.shares)
