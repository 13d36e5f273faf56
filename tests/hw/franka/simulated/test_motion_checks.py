"""Conditions of motions, each at its bound."""

import pytest

from station.hw.franka.arm.arm_limits import FR3_LIMITS, PANDA_LIMITS
from station.hw.franka.simulated.motion_checks import (
    elbow_errors,
    joint_motion_errors,
    start_position_errors,
    torque_errors,
    twist_errors,
)

Q = [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
ZEROS = [0.0] * 7
PERIOD = 0.001


def check(dq, last, limits=PANDA_LIMITS, q=Q):
    found = joint_motion_errors(
        q,
        [dq, *ZEROS[1:]],
        last_dq=[last, *ZEROS[1:]],
        last_ddq=[(dq - last) / PERIOD, *ZEROS[1:]],
        limits=limits,
        period=PERIOD,
    )
    return [error.name.removeprefix("joint_motion_generator_") for error in found]


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


def test_first_torque_may_continue_the_acting_or_the_sent_torque():
    def names(tau):
        found = torque_errors([tau] * 7, [87.0] * 7, [90.0] * 7, PANDA_LIMITS, PERIOD)
        return {error.name for error in found}

    assert names(86.0) == names(91.0) == set()
    assert names(85.9) == names(91.1) == {"controller_torque_discontinuity"}


def test_first_positions_must_be_near():
    assert start_position_errors([q + 0.0099 for q in Q], Q) == []
    (error,) = start_position_errors([*Q[:6], Q[6] + 0.02], Q)
    assert error.where == "joint7"


def test_twist_is_measured_by_its_norm():
    fast = [1.2, 1.2, 1.2, 0.0, 0.0, 0.0]
    (error,) = twist_errors(fast, fast, [0.0] * 6, PANDA_LIMITS, PERIOD)
    assert error.name == "cartesian_motion_generator_velocity_limits_violation"
    turning = [0.0] * 3 + [2.6, 0.0, 0.0]
    (error,) = twist_errors(turning, turning, [0.0] * 6, PANDA_LIMITS, PERIOD)
    assert (error.where, error.unit) == ("rotation", "rad/s")


def test_elbow_has_three_limits():
    assert elbow_errors((2.0, 9.0, 4000.0), PANDA_LIMITS) == []
    assert len(elbow_errors((3.0, 11.0, 6000.0), PANDA_LIMITS)) == 3
