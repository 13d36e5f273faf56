"""Conditions of motions, each at its bound."""

import struct

import pytest
from hypothesis import given, strategies as st

from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS
from station.hw.franka.simulated.motion_check import MotionCheck
from station.hw.franka.simulated.violations import JOINT_POSITION, SOLVED_POSITION
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both, sibling

Q = [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
ZEROS = [0.0] * 7
PERIOD = 0.001


class Arm:
    """A check, and the memory of the joints that it reads."""

    def __init__(self, limits=PANDA_LIMITS):
        self.memory = JointMemory(7)
        self.check = MotionCheck(self.memory, limits, PERIOD)

    def errors(self):
        return self.check.violations.errors()


def check(dq, last, limits=PANDA_LIMITS, q=Q):
    arm = Arm(limits)
    put(arm.memory.q_d, [q[0] - dq * PERIOD, *q[1:]])
    put(arm.memory.dq_d, [last, *ZEROS[1:]])
    put(arm.memory.ddq_d, [(dq - last) / PERIOD, *ZEROS[1:]])
    put(arm.memory.target, [dq, *ZEROS[1:]])
    assert arm.check.check_velocities() == len(arm.errors())
    names = [error.name for error in arm.errors()]
    return [name.removeprefix("joint_motion_generator_") for name in names]


@pytest.mark.parametrize(
    ("dq", "last", "names"),
    [
        (2.17, 2.16, []),
        # A difference of positions at the limit: (2.8 - (2.8 - 0.002175)) / 0.001.
        (2.1750000000001, 2.17, []),
        (2.18, 2.17, ["velocity_limits_violation"]),
        (1.0, 0.9851, []),
        (1.0, 0.984, ["velocity_discontinuity"]),
    ],
)
def test_joint_motion_is_measured_by_its_limits(dq, last, names):
    assert check(dq, last) == names


def test_fr3_may_not_be_fast_near_its_limit():
    near = [2.7, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
    assert check(1.0, 1.0, FR3_LIMITS) == []
    assert check(1.0, 1.0, FR3_LIMITS, near) == ["velocity_limits_violation"]


def test_fr3_reports_no_position_limit_but_a_velocity_of_zero():
    beyond = [2.75, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
    assert check(0.0, 0.0, FR3_LIMITS, beyond) == []
    assert check(1e-3, 1e-3, FR3_LIMITS, beyond) == ["velocity_limits_violation"]
    assert check(-1e-3, -1e-3, FR3_LIMITS, beyond) == []


def test_a_joint_beyond_its_limit_may_only_come_back():
    beyond = [2.9, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
    assert check(-1e-3, -1e-3, q=beyond) == check(0.0, 0.0, q=beyond) == []
    assert check(1e-3, 1e-3, q=beyond) == ["position_limits_violation"]


def test_errors_of_positions_tell_where_they_come_from_in_the_order_of_their_kinds():
    arm = Arm()
    put(arm.memory.target, [0.0, 0.1, 0.0, 0.1, 0.0, 0.0, 0.0])
    rates = ["velocity_limits_violation"] * 2
    rates += ["velocity_discontinuity"] * 2 + ["acceleration_discontinuity"] * 2

    assert arm.check.check_positions(JOINT_POSITION) == 7
    (limit, *found) = arm.errors()
    assert (limit.where, limit.value, limit.limit) == ("joint4", 0.1, -0.0698)
    assert [e.name for e in found] == [f"joint_motion_generator_{r}" for r in rates]
    assert [error.where for error in found] == ["joint2", "joint4"] * 3
    arm.check.violations.count = 0
    assert arm.check.check_positions(SOLVED_POSITION) == 7
    names = {error.name for error in arm.errors()}
    assert all(name.startswith("cartesian_motion_generator_joint") for name in names)


def seen(values):
    """Return numbers as a client of version 10 gets them, in single precision."""
    return struct.unpack("7f", struct.pack("7f", *values))


@pytest.mark.parametrize("limits", [FR3_LIMITS, PANDA_LIMITS])
def test_limiter_of_libfranka_may_stay_at_its_limits(limits):
    arm = Arm(limits)
    arm.check.set_precision(is_single=True)
    memory = arm.memory
    put(memory.q_d, [0.1, -0.8, 0.0, -2.3, 0.0, 3.6, 0.8])
    for cycle in range(4_000):
        q, dq, ddq = map(seen, (memory.q_d, memory.dq_d, memory.ddq_d))
        turn = 1.0 if (cycle + 50) % 200 < 100 else -1.0
        for i in range(7):
            # Source: libfranka@0.21.2 include/franka/rate_limiting.h, kLimitEps.
            jerk, most = limits.jerk[i] - 1e-3, limits.acceleration[i] - 1e-3
            rate = (
                ddq[i] + max(-jerk, min((turn * most - ddq[i]) / PERIOD, jerk)) * PERIOD
            )
            memory.target[i] = q[i] + (dq[i] + rate * PERIOD) * PERIOD
        assert arm.check.check_positions(JOINT_POSITION) == 0, arm.errors()
        last = [*memory.dq_d]
        put(memory.dq_d, memory.target_dq)
        rates = [(a - b) / PERIOD for a, b in zip(memory.dq_d, last, strict=True)]
        put(memory.ddq_d, rates)
        put(memory.q_d, memory.target)


@pytest.mark.parametrize("torque", [33.4, 80.3])
def test_torque_that_rises_as_fast_as_a_client_sees_is_no_step(torque):
    arm = Arm()
    arm.check.set_precision(is_single=True)
    put(arm.memory.tau_J_d, [torque] * 7)
    put(arm.memory.torques, [1.0 + value for value in seen([torque] * 7)])
    assert seen([torque] * 7)[0] > torque
    assert arm.check.check_torques() == 0
    # Whoever sees the state in double precision has no such excuse.
    arm.check.set_precision(is_single=False)
    assert arm.check.check_torques() == 7


def test_first_torque_may_continue_the_acting_or_the_sent_torque():
    def names(tau):
        arm = Arm()
        put(arm.memory.torques, [tau] * 7)
        put(arm.memory.tau_J_d, [87.0] * 7)
        put(arm.memory.sent, [90.0] * 7)
        arm.check.check_torques()
        return {error.name for error in arm.errors()}

    assert names(86.0) == names(91.0) == set()
    assert names(85.9) == names(91.1) == {"controller_torque_discontinuity"}


def test_first_positions_must_be_near():
    arm = Arm()
    put(arm.memory.q_d, Q)
    put(arm.memory.target, [q + 0.0099 for q in Q])
    assert arm.check.check_start() == 0
    put(arm.memory.target, [*Q[:6], Q[6] + 0.02])
    assert arm.check.check_start() == 1
    assert arm.errors()[0].where == "joint7"


def test_twist_is_measured_by_its_norm():
    for twist, where, unit in (
        ([1.2, 1.2, 1.2, 0.0, 0.0, 0.0], "translation", "m/s"),
        ([0.0, 0.0, 0.0, 2.6, 0.0, 0.0], "rotation", "rad/s"),
    ):
        arm = Arm()
        same = doubles(twist)
        assert arm.check.check_twist(same, same, zeros(6)) == 1
        (error,) = arm.errors()
        assert error.name == "cartesian_motion_generator_velocity_limits_violation"
        assert (error.where, error.unit) == (where, unit)


def test_elbow_has_three_limits():
    arm = Arm()
    assert arm.check.check_elbow(2.0, 9.0, 4000.0) == 0
    assert arm.check.check_elbow(3.0, 11.0, -6000.0) == 3
    units = [error.unit for error in arm.errors()]
    assert units == ["rad/s", "rad/s^2", "rad/s^3"]


@needs_both
@given(st.lists(arrays(7), min_size=6, max_size=6), st.sampled_from([1e-3, 1.0]))
def test_both_modes_find_the_same(parts, scale):
    def scenario(module):
        names = ("q_d", "dq_d", "ddq_d", "tau_J_d", "target", "torques")
        memory = sibling(module, "joint_memory").JointMemory(7)
        for name, values in zip(names, parts, strict=True):
            put(getattr(memory, name), [scale * value for value in values])
        found = []
        for limits in (PANDA_LIMITS, FR3_LIMITS):
            check = module.MotionCheck(memory, limits, PERIOD)
            found += [check.check_velocities(), check.check_positions(JOINT_POSITION)]
            found += [check.check_torques(), check.check_start()]
            for error in check.violations.errors():
                found += [error.value, error.limit]
        return found

    assert_same("motion_check", scenario)
