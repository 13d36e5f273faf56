"""Poses take a short way to the arm in usual cycles, with the same result."""

from math import cos, pi, sin

import pytest

from station.core.franka import FrankaPoseCartesianInterface
from tests.hw.franka.commands.test_motion_start import controllers, make

PERIOD = 0.001


class Followed:
    """An arm that follows poses; `is_short` chooses the way."""

    def __init__(self, *, is_short, **parameters):
        self.hw = hw = make(**parameters)
        hw.do_switch(controllers("cp"), [])
        self.handle = hw.get(FrankaPoseCartesianInterface).get_handle("panda_robot")
        self.start = list(self.handle.get_robot_state().O_T_EE_d)
        self.time = 0.0
        self.sent = []
        assert hw._sender.pose_send is not None
        if not is_short:
            hw._sender.pose_send = None

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


AS_THEY_ARE = {"rate_limiting": False, "cutoff_frequency": 1000.0}


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
def test_both_ways_send_the_same_poses(parameters):
    short = motion(Followed(is_short=True, **parameters))
    long = motion(Followed(is_short=False, **parameters))

    assert len(short) == len(long)
    for a, b in zip(short, long, strict=True):
        assert a == pytest.approx(b, abs=1e-10)


def test_a_refused_pose_ends_the_motion():
    arm = Followed(is_short=True, **AS_THEY_ARE)
    for _ in range(5):
        arm.cycle()
    arm.handle.set_command([*arm.start[:15], 2.0])
    arm.hw.read(arm.time, PERIOD)
    arm.hw.write(arm.time, PERIOD)
    arm.hw.read(arm.time, PERIOD)

    assert arm.hw.mode() != "move"
