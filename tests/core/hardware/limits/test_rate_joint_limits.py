"""Commands keep to the rates against the one before, and come back from outside."""

from itertools import pairwise
from math import nan
from random import Random

import pytest

from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import (
    ClampReason,
    JointLimits,
    PositionJointRateLimitsHandle,
    PositionJointRateLimitsInterface,
    VelocityJointRateLimitsHandle,
    VelocityJointRateLimitsInterface,
)

PERIOD = 0.001
LIMITS = JointLimits(-1.0, 1.0, max_velocity=2.0, max_acceleration=10.0)
JERK_LIMITS = JointLimits(-1.0, 1.0, 2.0, 10.0, max_jerk=1000.0)


class Joint:
    """A joint that does exactly what its command says."""

    def __init__(self, position=0.0, velocity=0.0):
        self.position = [position]
        self.velocity = [velocity]
        state = JointStateHandle("elbow", self.position, self.velocity, [0.0])
        self.handle = JointHandle(state, [0.0])

    def ask(self, limits, command, period=PERIOD):
        """Command, enforce, and return what is left of the command."""
        self.handle.set_command(command)
        limits.enforce_limits(period)
        return self.handle.get_command()


def rates(values):
    return [(b - a) / PERIOD for a, b in pairwise(values)]


def play_positions(limits, seed):
    """Ask for jumps all over the range and beyond it."""
    random = Random(seed)
    joint = Joint(random.uniform(-1.0, 1.0))
    handle = PositionJointRateLimitsHandle(joint.handle, limits)
    given = [joint.position[0]] * 3  # at rest before
    asked = 0.0
    for _ in range(3000):
        if random.random() < 0.01:
            asked = random.choice([random.uniform(-3.0, 3.0), 1.0, -50.0, 50.0])
        given.append(joint.ask(handle, asked))
    return given


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("limits", [LIMITS, JERK_LIMITS])
def test_positions_keep_to_range_velocity_acceleration_and_jerk(limits, seed):
    positions = play_positions(limits, seed)
    velocities = rates(positions)
    accelerations = rates(velocities)
    # differences of positions near 1 over periods of 1 ms round at 1e-16 * 1e3^n
    assert max(map(abs, positions)) <= 1.0
    assert max(map(abs, velocities)) <= 2.0 + 1e-12
    assert max(map(abs, accelerations)) <= 10.0 + 1e-8
    if limits.max_jerk is not None:
        assert max(map(abs, rates(accelerations))) <= 1000.0 + 1e-5


def test_range_is_used_up_to_its_bound():
    joint = Joint()
    handle = PositionJointRateLimitsHandle(joint.handle, LIMITS)
    for _ in range(2000):
        joint.ask(handle, 5.0)
    assert joint.handle.get_command() == pytest.approx(1.0, abs=1e-9)
    assert handle.last_clamp.reason is ClampReason.POSITION


@pytest.mark.parametrize(
    ("asked", "given"), [(5.0, 1.5), (1.6, 1.5), (1.5, 1.5), (1.49999, 1.49999)]
)
def test_position_outside_the_range_may_only_come_back(asked, given):
    joint = Joint(1.5)
    handle = PositionJointRateLimitsHandle(joint.handle, LIMITS)
    assert joint.ask(handle, asked) == given


@pytest.mark.parametrize(
    ("position", "asked", "given"),
    [(1.5, 0.005, 0.0), (1.5, -0.005, -0.005), (-1.5, -0.005, 0.0), (0.0, 9.0, 0.01)],
)
def test_velocity_outside_the_range_may_only_come_back(position, asked, given):
    joint = Joint(position)
    handle = VelocityJointRateLimitsHandle(joint.handle, LIMITS)
    assert joint.ask(handle, asked) == pytest.approx(given, abs=1e-15)


def test_joint_under_velocity_commands_stops_at_its_bound():
    joint = Joint()
    handle = VelocityJointRateLimitsHandle(joint.handle, LIMITS)
    velocities = []
    for _ in range(3000):
        velocities.append(joint.ask(handle, 9.0))
        joint.position[0] += velocities[-1] * PERIOD
    assert 0.999 < joint.position[0] <= 1.0 + 1e-12
    assert max(velocities) == 2.0
    assert max(map(abs, rates(velocities))) <= 10.0 + 1e-9


def test_moving_joint_is_taken_over_at_its_velocity():
    joint = Joint(velocity=1.0)
    handle = VelocityJointRateLimitsHandle(joint.handle, LIMITS)
    assert joint.ask(handle, 2.0) == pytest.approx(1.01)
    joint.velocity[0] = 0.5
    handle.reset()
    assert joint.ask(handle, 2.0) == pytest.approx(0.51)


@pytest.mark.parametrize("period", [0.0, -0.001])
def test_cycle_without_time_repeats_the_last_command(period):
    joint = Joint(0.25)
    position = PositionJointRateLimitsHandle(joint.handle, LIMITS)
    assert joint.ask(position, 0.9, period) == 0.25
    velocity = VelocityJointRateLimitsHandle(joint.handle, LIMITS)
    assert joint.ask(velocity, 0.9, period) == 0.0


@pytest.mark.parametrize(
    "handle_type", [PositionJointRateLimitsHandle, VelocityJointRateLimitsHandle]
)
def test_handle_begins_anew_after_a_nan(handle_type):
    joint = Joint()
    handle = handle_type(joint.handle, LIMITS)
    given = joint.ask(handle, nan)
    assert given != given  # only NaN differs from itself
    assert handle.clamp_count == 0
    assert abs(joint.ask(handle, 5.0)) < 0.011


@pytest.mark.parametrize(
    ("interface_type", "handle_type"),
    [
        (PositionJointRateLimitsInterface, PositionJointRateLimitsHandle),
        (VelocityJointRateLimitsInterface, VelocityJointRateLimitsHandle),
    ],
)
def test_interface_enforces_and_counts(interface_type, handle_type):
    joint = Joint()
    interface = interface_type()
    interface.register_handle(handle_type(joint.handle, LIMITS))
    joint.ask(interface, 5.0)
    assert interface.clamp_count == 1
