"""The joint motion follows the pose, the elbow as asked for."""

from itertools import pairwise
from math import cos, pi

import pytest

from station.core.franka import Frame, RobotState
from station.hw.franka.arm.franka_kinematics import frame_pose
from tests.hw.franka.cartesian_motions import PERIOD, Generator

START = [0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4]


def follow(state: RobotState, motion: Generator, cycles: int, elbow=None):
    for cycle in range(cycles):
        speed = 0.1 * min(1.0, cycle / 200)
        twist = (speed, 0.5 * speed, 0.0, 0.0, 0.0, speed)
        assert motion.receive(twist, elbow) == []
        q, errors = motion.solve()
        assert errors == []
        dq = [(a - b) / PERIOD for a, b in zip(q, state.q_d, strict=True)]
        state.ddq_d = [(a - b) / PERIOD for a, b in zip(dq, state.dq_d, strict=True)]
        state.q_d, state.dq_d = q, dq


def test_end_effector_reaches_the_commanded_pose():
    state = RobotState(q_d=list(START))
    motion = Generator(state)
    motion.begin()
    follow(state, motion, 1_000)
    reached = frame_pose(Frame.END_EFFECTOR, state.q_d)
    assert reached == pytest.approx(state.O_T_EE_c, abs=1e-6)
    # Without an elbow command joint 3 stays where it is.
    assert state.q_d[2] == pytest.approx(0.0, abs=1e-6)


def test_lost_command_goes_on_with_constant_acceleration():
    state = RobotState(q_d=list(START))
    motion = Generator(state)
    motion.begin()
    follow(state, motion, 100)
    twist, rate = list(state.O_dP_EE_c), list(state.O_ddP_EE_c)
    motion.extrapolate()
    expected = [v + a * PERIOD for v, a in zip(twist, rate, strict=True)]
    assert state.O_dP_EE_c == pytest.approx(expected)


def test_motion_begins_as_fast_as_the_joints_are():
    state = RobotState(q_d=list(START), dq_d=[0.1, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0])
    motion = Generator(state)
    motion.begin()

    moved = [q + dq * 1e-6 for q, dq in zip(state.q_d, state.dq_d, strict=True)]
    there = frame_pose(Frame.END_EFFECTOR, moved)
    speed = [(there[i] - state.O_T_EE_c[i]) / 1e-6 for i in (12, 13, 14)]
    assert state.O_dP_EE_c[:3] == pytest.approx(speed, abs=1e-6)
    assert state.O_dP_EE_c[5] == pytest.approx(0.1 + 0.2 * cos(pi / 4))
    assert state.delbow_c[0] == 0.2


def test_elbow_that_nobody_commands_comes_to_rest_within_its_limits():
    state = RobotState(q_d=list(START), dq_d=[0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0])
    motion = Generator(state)
    motion.begin()
    rates = []
    for _ in range(100):
        twist = tuple(0.9 * v for v in state.O_dP_EE_c)
        assert not [e for e in motion.receive(twist) if "elbow" in e.name]
        motion.solve()
        rates.append(state.delbow_c[0])

    assert max(abs(b - a) for a, b in pairwise(rates)) < 0.0101
    assert abs(rates[-1]) < 1e-3
