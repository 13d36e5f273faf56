"""Poses and twists on their way to the arm: smooth, within limits, to the same bits."""

from math import cos, pi, sin, sqrt

import pytest
from hypothesis import given, settings, strategies as st

from station.core.franka import Frame, FrankaPoseCartesianInterface, RobotState
from station.hw.franka.arm.arm_limits import MotionLimits
from station.hw.franka.arm.franka_kinematics import frame_pose
from station.hw.franka.arm.receiver import Receiver
from station.hw.franka.commands.cartesian_sender import PoseRates
from station.hw.franka.simulated.simulated_arm import SimulatedArm
from station.memory.doubles import doubles, put
from tests.both_modes import arrays, assert_same, needs_both
from tests.hw.franka.commands.test_motion_start import controllers, make
from tests.hw.franka.limited_commands import limit_twist

POSE = frame_pose(Frame.END_EFFECTOR, [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8])
BOUNDS = {
    "translation": [1.7, 13.0, 6500.0],
    "rotation": [2.5, 25.0, 12500.0],
    "elbow": [2.1, 10.0, 5000.0],
}
LIMITS = MotionLimits(2.0, 13.0, 6500.0)
PERIOD = 0.001
AS_THEY_ARE = {"rate_limiting": False, "cutoff_frequency": 1000.0}


def rates_of(kind, twist=(0.0,) * 6, acceleration=(0.0,) * 6, elbow=(0.0,) * 3):
    """Return the rates of an arm whose last command was this one."""
    state = RobotState()
    state.O_T_EE_c, state.O_dP_EE_c, state.O_ddP_EE_c = POSE, twist, acceleration
    state.elbow_c = [elbow[0], 1.0]
    state.delbow_c, state.ddelbow_c = [elbow[1], 0.0], [elbow[2], 0.0]
    return kind(state, **BOUNDS, pose_share=0.99, period=PERIOD)


@needs_both
@settings(max_examples=60, deadline=None)
@given(
    gain=st.sampled_from([0.386, 1.0]),
    limits=st.booleans(),
    passes=st.booleans(),
    state=arrays(15),
    command=arrays(8),
)
def test_both_modes_give_the_same_bits(gain, limits, passes, state, command):
    def scenario(module):
        rates = rates_of(module.PoseRates, state[:6], state[6:12], state[12:])
        rates.gain, rates.is_limiting = gain, limits
        pose = doubles(POSE)
        put(pose[12:15], command[:3])
        rates.filter_pose(pose, passes)
        rates.filter_twist(doubles(command[:6]))
        rates.filter_elbow(doubles(command[6:]), passes)
        return [*rates.sent_pose, *rates.sent_twist, *rates.sent_elbow]

    assert_same("cartesian_sender", scenario)


def test_without_filter_and_limits_everything_passes():
    rates = rates_of(PoseRates)
    pose = [*POSE[:12], 5.0, 6.0, 7.0, 1.0]
    passes = False
    rates.filter_pose(doubles(pose), passes)
    rates.filter_twist(doubles([9.0] * 6))
    rates.filter_elbow(doubles([0.5, -1.0]), passes)
    assert [*rates.sent_pose] == pytest.approx(pose)
    assert [*rates.sent_twist] == [9.0] * 6
    assert [*rates.sent_elbow] == [0.5, -1.0]


def test_an_elbow_step_rises_with_the_jerk_limit():
    rates = rates_of(PoseRates, elbow=(0.2, 0.0, 0.0))
    rates.is_limiting = True
    passes = False
    rates.filter_elbow(doubles([0.7, 1.0]), passes)
    # 5000 rad/s^3, three times over 1 ms.
    assert rates.sent_elbow[0] - 0.2 == pytest.approx(5e-6)


def norm(vector):
    return sqrt(sum(value * value for value in vector))


def test_step_is_approached_within_all_limits():
    v, a = [0.0] * 3, [0.0] * 3
    for _ in range(2_000):
        new = limit_twist([3.0, -3.0, 1.0], v, a, LIMITS)
        acceleration = [(x - y) / PERIOD for x, y in zip(new, v, strict=True)]
        jerk = [(x - y) / PERIOD for x, y in zip(acceleration, a, strict=True)]
        assert norm(new) <= 2.0 + 1e-9
        assert norm(acceleration) <= 13.0 + 1e-6
        assert norm(jerk) <= 6500.0 * (1 + 1e-6)
        v, a = new, acceleration
    assert norm(v) == pytest.approx(2.0, abs=0.02)


def test_command_within_the_limits_passes():
    assert limit_twist([1e-6, 0, 0], [0.0] * 3, [0.0] * 3, LIMITS) == pytest.approx([
        1e-6,
        0.0,
        0.0,
    ])


class Followed:
    """An arm that follows poses."""

    def __init__(self, **parameters):
        self.hw = hw = make(**parameters)
        hw.do_switch(controllers("cp"), [])
        self.handle = hw.get(FrankaPoseCartesianInterface).get_handle("panda_robot")
        self.start = list(self.handle.get_robot_state().O_T_EE_d)
        self.time = 0.0
        self.sent = []

    def cycle(self, shift=0.0, elbow=(0.0, 0.0), *, is_late=False):
        """Command a pose that is moved along z; return the commanded pose."""
        self.time += PERIOD * (3 if is_late else 1)
        self.hw.read(self.time, PERIOD * (3 if is_late else 1))
        pose = list(self.start)
        pose[14] += shift
        self.handle.set_command(pose, elbow)
        self.hw.write(self.time, PERIOD)
        assert self.hw.mode() == "move", self.hw.arm.errors()
        self.sent.append(list(self.handle.get_robot_state().O_T_EE_c))


def motion(arm):
    """Move up and rest, with a late cycle and an elbow on the way."""
    for cycle in range(2200):
        share = min(1.0, cycle / 1900)
        arm.cycle(0.05 * (share - sin(2 * pi * share) / (2 * pi)), is_late=cycle == 300)
    elbow = list(arm.handle.get_robot_state().elbow_c)
    for cycle in range(400):
        away = 0.01 * (1.0 - cos(pi * cycle / 400)) / 2.0
        arm.cycle(0.05, (elbow[0] + away, elbow[1]))
    for _ in range(200):
        arm.cycle(0.05)
    return arm.sent


@pytest.mark.slow
@pytest.mark.parametrize("parameters", [{}, AS_THEY_ARE], ids=["filtered", "raw"])
def test_an_arm_without_a_receiver_gets_the_same_poses(parameters, monkeypatch):
    received = motion(Followed(**parameters))
    monkeypatch.setattr(SimulatedArm, "receiver", lambda _arm: Receiver())
    called = motion(Followed(**parameters))

    assert len(received) == len(called)
    for a, b in zip(received, called, strict=True):
        assert a == pytest.approx(b, abs=1e-10)


def test_a_refused_pose_ends_the_motion():
    arm = Followed(**AS_THEY_ARE)
    for _ in range(5):
        arm.cycle()
    arm.handle.set_command([*arm.start[:15], 2.0])
    arm.hw.read(arm.time, PERIOD)
    arm.hw.write(arm.time, PERIOD)
    arm.hw.read(arm.time, PERIOD)

    assert arm.hw.mode() != "move"
