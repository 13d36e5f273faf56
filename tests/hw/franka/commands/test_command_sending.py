"""The commands of an arm: checked, limited, filtered and passed on, in that order."""

from functools import partial

from typing_extensions import override

from station.core.franka.command_rates import CommandRates
from station.core.franka.joint_memory import JointMemory
from station.core.hardware.limits.enforced_limits import EnforcedLimits
from station.hw.franka.arm.receiver import Receiver
from station.hw.franka.commands.command_sending import (
    CommandSending,
    PositionSend,
    TorqueSend,
    VelocitySend,
)
from station.memory.doubles import doubles, put
from station.memory.finite_check import FiniteCheck


class Limited:
    """A joint that notes when its limits are enforced."""

    def __init__(self, done):
        self.done = done

    def enforce_limits(self, period):
        self.done.append(f"limit {period:g}")


class Halved:
    """A limit that halves commands."""

    def __init__(self, commands):
        self.commands = commands

    def enforce_limits(self, period):
        put(self.commands, [value / 2.0 for value in self.commands])


def rates_of(commands):
    """Return a filter that lets commands pass, of positions up to 10."""
    large = [1e9] * len(commands)
    return CommandRates(
        JointMemory(len(commands)),
        positions=commands,
        velocities=commands,
        efforts=commands,
        velocity=large,
        acceleration=large,
        jerk=large,
        torque_rate=large,
        lower=[-10.0] * len(commands),
        upper=[10.0] * len(commands),
        braking_share=0.5,
        approach_gain=50.0,
        period=0.001,
    )


class Sending(CommandSending):
    """Notes what is done."""

    def __init__(self):
        super().__init__()
        self.done = []
        self.commands = doubles([1.0, 2.0])
        self.checks = [FiniteCheck(self.commands)]
        limits = EnforcedLimits()
        limits.singles = [Limited(self.done)]
        self.limits = [limits]
        self.rates = rates_of(self.commands)
        receiver = Receiver(lambda values: self.done.append([*values]))
        prepare = partial(self.done.append, "filter")
        self.sends = [PositionSend(self.rates, receiver, prepare)]

    @override
    def refuse(self):
        self.done.append("refuse")

    @override
    def send_end_effector(self, is_new):
        self.done.append(f"pose {is_new}")


def test_commands_are_limited_filtered_and_passed_on():
    sending = Sending()
    sending.send_limited(0.001)
    assert sending.done == ["limit 0.001", "filter", [1.0, 2.0]]


def test_goals_are_noted_before_the_limits_and_poses_come_last():
    sending = Sending()
    sending.is_cartesian = True
    sending.goals, sending.rates.is_limiting = sending.rates, True
    sending.limits[0].singles = [Halved(sending.commands)]
    sending.send_limited(0.001)
    assert [*sending.commands] == [0.5, 1.0]
    assert [*sending.rates.goals] == [1.0, 2.0]
    assert sending.done[-1] == "pose True"


def test_positions_and_velocities_are_prepared_and_sent():
    found = []
    rates = rates_of(doubles([1.0, 2.0]))
    receiver = Receiver(lambda values: found.append([*values]))
    PositionSend(rates, receiver).send()
    VelocitySend(rates, receiver, partial(found.append, "prepared")).send()
    TorqueSend(rates, receiver).send()
    assert found == [[1.0, 2.0], "prepared", [1.0, 2.0], [1.0, 2.0]]


def test_no_time_has_no_limits():
    sending = Sending()
    sending.send_limited(0.0)
    assert sending.done == ["filter", [1.0, 2.0]]


def test_a_command_that_is_not_finite_is_refused_and_nothing_is_sent():
    sending = Sending()
    sending.commands[1] = float("inf")
    sending.send_limited(0.001)
    assert sending.done == ["refuse"]
