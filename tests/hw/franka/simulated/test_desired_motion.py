"""Desired motion: holding, following, and never jumping."""

from math import inf

import pytest

from station.core.franka.joint_memory import JointMemory
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.memory.doubles import put

PERIOD = 0.001


class OneJoint:
    """A desired motion of one joint."""

    def __init__(self, q_d, dq_d=0.0, *, lower=-inf, upper=inf) -> None:
        self.memory = JointMemory(1)
        self.motion = DesiredMotion(
            self.memory,
            lower=[lower],
            upper=[upper],
            deceleration=[10.0],
            period=PERIOD,
        )
        self.motion.seed([q_d], [dq_d])

    def follow_velocity(self, velocity: float) -> None:
        put(self.memory.target, [velocity])
        self.motion.follow_velocities()

    def follow_position(self, position: float) -> None:
        put(self.memory.target, [position])
        self.motion.follow_positions()

    @property
    def now(self) -> tuple[float, float, float]:
        memory = self.memory
        return memory.q_d[0], memory.dq_d[0], memory.ddq_d[0]


@pytest.mark.parametrize("velocity", [0.5, -0.5])
def test_hold_slows_down_at_the_set_rate_and_stays(velocity: float) -> None:
    joint = OneJoint(1.0, velocity)
    joint.motion.hold()
    assert abs(joint.now[2]) == pytest.approx(10.0)
    for _ in range(60):
        joint.motion.hold()
    assert joint.now[1:] == (0.0, 0.0)
    assert joint.motion.is_at_rest()
    # v^2 / 2a, less half a step's way for the discrete sum.
    way = velocity * abs(velocity) / 20.0
    assert joint.now[0] - 1.0 == pytest.approx(way, abs=abs(velocity) * PERIOD)


def test_velocities_are_integrated() -> None:
    joint = OneJoint(0.0)
    for _ in range(100):
        joint.follow_velocity(0.2)
    assert joint.now[0] == pytest.approx(0.02)
    assert joint.now[1] == 0.2


def test_velocity_motion_stops_at_a_position_limit_and_comes_back() -> None:
    joint = OneJoint(0.9995, upper=1.0)
    for _ in range(10):
        joint.follow_velocity(1.0)
    assert joint.now[:2] == (1.0, 0.0)
    joint.follow_velocity(-1.0)
    assert joint.now[0] == pytest.approx(0.999)


def test_joint_outside_its_limits_is_not_pushed_back_by_a_jump() -> None:
    joint = OneJoint(1.2, upper=1.0)
    joint.follow_velocity(0.5)
    joint.motion.hold()
    assert joint.now[0] == 1.2


def test_positions_are_taken_over_with_their_differences() -> None:
    joint = OneJoint(0.0)
    joint.follow_position(0.001)
    joint.follow_position(0.003)
    assert joint.now == pytest.approx((0.003, 2.0, 1000.0))


def test_constant_acceleration_goes_on_without_a_command() -> None:
    joint = OneJoint(0.0)
    joint.follow_velocity(0.001)
    joint.motion.extrapolate()
    assert joint.now[1:] == pytest.approx((0.002, 1.0))


def test_seed_begins_from_a_measured_motion() -> None:
    joint = OneJoint(0.0)
    joint.motion.seed([0.4], [0.1])
    assert joint.now == (0.4, 0.1, 0.0)
