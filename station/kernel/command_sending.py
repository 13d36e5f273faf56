"""Check, limit, filter and send the commands of an arm."""

from collections.abc import Callable

from station.kernel.arm_step import ArmStep
from station.kernel.command_rates import CommandRates
from station.kernel.doubles import Doubles
from station.kernel.enforced_limits import EnforcedLimits
from station.kernel.finite_check import FiniteCheck


class Receiver:
    """Takes commands for an arm by a Python function.

    Args:
        function: Takes the commands.
    """

    def __init__(self, function: Callable[[Doubles], object]) -> None:
        self.function = function

    def receive(self, values: Doubles) -> None:
        """Take commands for the next cycle."""
        self.function(values)


class TorqueReceiver(Receiver):
    """Takes torques for a simulated arm.

    Args:
        function: Takes what the step does not take, or refuses it.
        step: The arm's arithmetic.
    """

    def __init__(self, function: Callable[[Doubles], object], step: ArmStep) -> None:
        super().__init__(function)
        self.step = step

    def receive(self, values: Doubles) -> None:
        """Take torques [Nm], shape (7,)."""
        if not self.step.wants_torques or not self.step.receive_torques(values):
            self.function(values)


class JointSend:
    """Filters commands of the joints and passes them on.

    Args:
        filtering: Filters them into `result`.
        receiver: Takes them.
        result: The filtered commands, shape (7,).
    """

    def __init__(
        self, filtering: Callable[[], object], receiver: Receiver, result: Doubles
    ) -> None:
        self.filtering = filtering
        self.receiver = receiver
        self.result = result

    def send(self) -> None:
        """Filter and send."""
        self.filtering()
        self.receiver.receive(self.result)


class TorqueSend(JointSend):
    """Filters torques and passes them on.

    Args:
        rates: Filters them.
        receiver: Takes them.
    """

    def __init__(self, rates: CommandRates, receiver: Receiver) -> None:
        super().__init__(rates.filter_torques, receiver, rates.result)
        self.rates = rates

    def send(self) -> None:
        """Filter and send."""
        self.rates.filter_torques()
        self.receiver.receive(self.result)


class CommandSending:
    """Sends the commands of the present mode; a subclass does what is not usual.

    Attributes:
        checks: Look for commands that are not finite.
        limits: The limits of the commands that are sent.
        sends: What is sent for the joints.
        has_goals: Whether positions are noted as goals before they are limited.
        is_cartesian: Whether poses or twists are sent.
    """

    def __init__(self) -> None:
        self.checks: list[FiniteCheck] = []
        self.limits: list[EnforcedLimits] = []
        self.sends: list[JointSend] = []
        self.has_goals = False
        self.is_cartesian = False

    def refuse(self) -> None:
        """End the motion, because a command is not finite."""
        raise NotImplementedError

    def note_goals(self) -> None:
        """Note the commanded positions as goals."""
        raise NotImplementedError

    def send_end_effector(self, is_new: bool) -> None:  # noqa: FBT001 - as `send`
        """Filter and send a pose or a twist."""
        raise NotImplementedError

    def send_limited(self, period: float) -> None:
        """Limit and send the controllers' commands, while a motion runs.

        The motion ends when a command is not finite.

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        for check in self.checks:
            if check.first_bad() >= 0:
                self.refuse()
                return
        if self.has_goals:
            self.note_goals()
        if period > 0.0:
            for limits in self.limits:
                limits.enforce(period)
        for one in self.sends:
            one.send()
        if self.is_cartesian:
            self.send_end_effector(True)  # noqa: FBT003 - as `send`
