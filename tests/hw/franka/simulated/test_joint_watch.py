"""An arm is only called quiet when its end effector is, as differences show."""

from dataclasses import replace
from math import cos, dist

import pytest
from hypothesis import assume, example, given, strategies as st

from station.core.franka import Frame
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm.arm_limits import (
    PANDA_LIMITS,
    MotionLimits,
    SupervisorLimits,
)
from station.hw.franka.arm.franka_kinematics import CHAIN, IDENTITY, frame_pose
from station.hw.franka.simulated.joint_watch import JointWatch
from station.memory.doubles import doubles, put
from tests.both_modes import arrays, assert_same, needs_both, sibling

SIZE = 7
STEP = 1e-6
FASTEST, FARTHEST, MOST_TURNED, ELBOW = 0.5, 0.1, 0.3, 0.2
joints = st.lists(st.floats(-1.5, 1.5), min_size=SIZE, max_size=SIZE)
speeds = st.lists(st.floats(-1.0, 1.0), min_size=SIZE, max_size=SIZE)
small = st.lists(st.floats(-0.1, 0.1), min_size=SIZE, max_size=SIZE)
TURNS_ALONE = [0.0] * 6 + [0.4]


LIMITS = replace(
    PANDA_LIMITS,
    lower=(-3.0,) * SIZE,
    upper=(3.0,) * SIZE,
    velocity=(2.0,) * SIZE,
    torque=(87.0,) * SIZE,
    translation=MotionLimits(FASTEST, 13.0, 6500.0),
)
THRESHOLDS = SupervisorLimits(
    position_tolerance=0.0,
    velocity_factor=1.0,
    power=1e4,
    path_deviation=(FARTHEST, MOST_TURNED, ELBOW),
)


def watch_of(memory, watch_class=JointWatch):
    return watch_class(
        memory, CHAIN, doubles(IDENTITY), LIMITS, THRESHOLDS, 0.001, has_hand=True
    )


def is_quiet(q, *, dq=(0.0,) * SIZE, q_d=None, is_following=False):
    memory = JointMemory(SIZE)
    put(memory.positions, q)
    put(memory.dtheta, dq)
    put(memory.q_d, q if q_d is None else q_d)
    watch = watch_of(memory)
    watch.room = 1.0
    return not watch.check_readings(is_following, has_moved=True)


def origin(q):
    return frame_pose(Frame.END_EFFECTOR, q)[12:15]


@given(joints, speeds)
def test_the_speed_that_counts_is_that_of_the_end_effector(q, dq):
    ahead = origin([p + STEP * v for p, v in zip(q, dq, strict=True)])
    behind = origin([p - STEP * v for p, v in zip(q, dq, strict=True)])
    speed = dist(ahead, behind) / (2.0 * STEP)
    assume(abs(speed - FASTEST) > 1e-6)

    assert is_quiet(q, dq=dq) == (speed < FASTEST)


@given(joints, small)
@example([0.0] * SIZE, TURNS_ALONE)
@example([0.0] * SIZE, [0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.0])
def test_the_deviation_that_counts_is_that_of_the_end_effector(q, away):
    q_d = [a + b for a, b in zip(q, away, strict=True)]
    pose, desired = (
        frame_pose(Frame.END_EFFECTOR, q),
        frame_pose(Frame.END_EFFECTOR, q_d),
    )
    shift = dist(pose[12:15], desired[12:15])
    # The trace of a rotation tells its angle.
    turned = sum(pose[i] * desired[i] for i in (0, 1, 2, 4, 5, 6, 8, 9, 10))
    assume(abs(shift - FARTHEST) > 1e-6)
    cosine_of_most = cos(MOST_TURNED)
    assume(abs((turned - 1.0) / 2.0 - cosine_of_most) > 1e-6)
    is_near = (turned - 1.0) / 2.0 > cosine_of_most and shift < FARTHEST
    expected = is_near and abs(away[2]) < ELBOW

    assert is_quiet(q, q_d=q_d, is_following=True) == expected
    assert is_quiet(q, q_d=q_d, is_following=False)


@pytest.mark.parametrize("joint", range(SIZE))
def test_what_is_not_known_is_not_quiet(joint):
    nothing = [float("nan") if i == joint else 0.9 for i in range(SIZE)]

    assert not is_quiet(nothing)
    assert not is_quiet([0.1] * SIZE, dq=nothing)


@needs_both
@given(arrays(SIZE), arrays(SIZE), arrays(SIZE), st.booleans())
def test_both_modes_find_the_same(q, dq, q_d, is_following):
    def scenario(module):
        memory = sibling(module, "joint_memory").JointMemory(SIZE)
        put(memory.positions, q)
        put(memory.dtheta, dq)
        put(memory.q_d, q_d)
        watch = watch_of(memory, module.JointWatch)
        watch.room = 1.0
        found = [watch.check_readings(is_following, has_moved=True), watch.room]
        for error in watch.violations.errors():
            found += [error.value, error.limit]
        return found

    assert_same("joint_watch", scenario)
