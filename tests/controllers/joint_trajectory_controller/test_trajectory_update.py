"""Time passes along a trajectory; what waits or is watched is left to others."""

from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from typing_extensions import override

from station.controllers.joint_trajectory_controller.trajectory_update import (
    FeedForwardPidLaw,
    SpeedFactor,
    TrajectoryTime,
    TrajectoryUpdate,
)
from station.controllers.set_point_controller import DirectLaw
from station.core.control.sample_columns import SampleColumns
from station.core.numerics.joint_errors import JointErrors
from station.core.numerics.pid import PidGains, PidGroup
from station.core.trajectory.splines import SplineGroup
from station.memory.doubles import doubles, zeros
from tests.both_modes import assert_same, needs_both

LINE = [0.0, 10.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0]
"""x = 1 + 2 t for 10 s."""


class Line(TrajectoryTime):
    """One joint on a line."""

    def __init__(self) -> None:
        self.states = zeros(3)
        errors = [
            JointErrors(self.states[i : i + 1], zeros(1), zeros(1)) for i in range(2)
        ]
        super().__init__(SpeedFactor(1.0, 0.5), SplineGroup(self.states, *errors))
        self.loads = []

    @override
    def load(self, now):
        self.loads.append(now)
        self.splines.load(0, doubles(LINE))
        self.load_time = float("inf")
        self.begin = 0.0


class Run:
    """An update along the line, and what it commands."""

    def __init__(self) -> None:
        self.line, self.requests = Line(), []
        self.supervision = SimpleNamespace(goal=None)
        self.commands = zeros(1)
        self.sampled = SampleColumns([self.commands])
        self.update = TrajectoryUpdate(
            self.line,
            self.requests,
            self.supervision,
            DirectLaw(self.line.states[:1], self.commands),
            self.sampled,
        )


@pytest.fixture
def run():
    return Run()


def test_time_passes_and_the_joint_follows(run):
    for cycle in range(3):
        assert run.update.run(100.0 + cycle, 0.5)
    assert [*run.commands] == [4.0]
    assert run.line.loads == [0.5]
    assert run.line.moment == (102.0, 0.5, 1_500_000_000)
    assert [*run.line.times_from_start] == [0.0, 1.5]
    assert run.sampled.newest[0] == 102.0


def test_a_trajectory_that_is_over_rests_at_its_end(run):
    for cycle in range(30):
        run.update.run(float(cycle), 0.5)
    assert run.line.rests
    assert [*run.commands] == [21.0]


@pytest.mark.parametrize("unusual", ["request", "goal"])
def test_nothing_is_done_while_a_request_waits_or_a_goal_is_watched(run, unusual):
    if unusual == "request":
        run.requests.append(object())
    else:
        run.supervision.goal = object()
    assert not run.update.run(1.0, 0.5)
    assert run.line.moment == (0.0, 0.0, 0)
    assert run.sampled.newest is None


def test_the_speed_changes_by_its_ramp():
    speed = SpeedFactor(1.0, 0.5)
    speed.target = 0.0
    passed = [speed.advance(0.2) for _ in range(4)]
    assert passed == pytest.approx([0.2 * 0.8, 0.2 * 0.4, 0.2 * 0.1, 0.0])
    assert (speed.factor, speed.rate) == (0.0, 0.0)


@pytest.mark.parametrize(("gain", "command"), [(0.0, 6.0), (0.5, 7.0)])
def test_a_desired_rate_times_its_gain_is_added_to_the_pid(gain, command):
    commands = zeros(1)
    pids = PidGroup(doubles([3.0]), doubles([0.0]), commands)
    pids.set_gains(0, PidGains(p=2.0))
    FeedForwardPidLaw(pids, doubles([2.0]), doubles([gain])).compute_commands(0.001)
    assert [*commands] == [command]


@needs_both
@given(
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
    st.floats(0.0, 2.0),
    st.lists(st.floats(0.0, 1.0), min_size=1, max_size=8),
)
def test_both_modes_change_the_speed_the_same(first, target, ramp, periods):
    def scenario(module):
        speed = module.SpeedFactor(first, ramp)
        speed.target = target
        found = []
        for period in periods:
            found += [speed.advance(period), speed.factor, speed.rate]
        return found

    assert_same("trajectory_update", scenario)
