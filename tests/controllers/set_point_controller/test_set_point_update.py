"""A set-point is followed, and replaced by a new one in the cycle that finds it."""

import pytest
from hypothesis import given, strategies as st

from station.core.clock import ManualClock
from station.core.hardware.interfaces import JointStateGroup, JointStateHandle
from station.core.numerics.pid import PidGains
from station.core.ports.set_point import SetPointElement
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import assert_same, compiled, needs_both, sibling


class Following:
    """Two joints that are measured at 1 and 2, and follow a set-point by PIDs."""

    def __init__(self, module) -> None:
        ports, errors_of, pid, samples = (
            sibling(module, name)
            for name in ("set_point", "joint_errors", "pid", "sample_columns")
        )
        elements = [SetPointElement(name, "rad", -5.0, 5.0) for name in "ab"]
        self.port = ports.SetPointPort(elements, clock=ManualClock())
        self.set_point = ports.ActiveSetPoint(
            self.port, ports.TimeoutAction.HOLD, "the arm", lambda: [1.5, 1.0]
        )
        self.set_point.start_at_rest()
        errors, rates, self.commands = zeros(2), zeros(2), zeros(2)
        pids = pid.PidGroup(errors, rates, self.commands)
        for k, (p, d) in enumerate([(10.0, 2.0), (100.0, 3.0)]):
            pids.set_gains(k, PidGains(p=p, d=d))
        compare = errors_of.JointErrors
        law = module.PidLaw(
            pids,
            self.set_point,
            compare(self.set_point.desired, doubles([1.0, 2.0]), errors),
            compare(self.set_point.desired_rates, doubles([0.1, 0.2]), rates),
        )
        columns = [self.set_point.desired, self.commands]
        self.sampled = samples.SampleColumns(columns)
        handles = [JointStateHandle(name, [0.0], [0.0], [0.0]) for name in "ab"]
        joints = module.ControlledJoints(JointStateGroup(handles))
        self.update = module.SetPointUpdate(self.set_point, joints, law, self.sampled)


@pytest.fixture
def following():
    return Following(compiled("set_point_controller"))


def test_the_set_point_is_followed_and_the_sample_kept(following):
    following.update.command_joints(3.0, 0.001)
    # The rates of the errors are those since an error of 0.
    assert [*following.commands] == [5.0 + 2.0 * 500.0, -100.0 - 3.0 * 1000.0]
    assert following.sampled.newest[0] == 3.0
    assert following.update.period == 0.001


def test_known_rates_are_compared_with_the_measured_ones(following):
    following.port.post([1.5, 1.0, 0.6, 0.2])
    following.update.command_joints(3.0, 0.001)
    assert [*following.commands] == [5.0 + 2.0 * 0.5, -100.0]


def test_a_new_set_point_is_followed_at_once_and_rest_when_it_expires(following):
    following.port.post([9.0, 2.0], timeout=1.0)
    following.update.command_joints(3.0, 0.001)
    assert [*following.set_point.desired] == [5.0, 2.0]
    following.port.clock.advance(1.1)
    following.update.command_joints(3.001, 0.001)
    assert [*following.set_point.desired] == [1.5, 1.0]


@needs_both
@given(
    st.lists(st.lists(st.floats(), min_size=4, max_size=4), min_size=1, max_size=5),
    st.booleans(),
)
def test_both_modes_command_the_same(set_points, has_rates):
    def scenario(module):
        following, found = Following(module), []
        following.set_point.has_rates = has_rates
        for values in set_points:
            put(following.set_point.desired, values[:2])
            put(following.set_point.desired_rates, values[2:])
            following.update.command_joints(0.0, 0.001)
            found += following.commands
        return found

    assert_same("set_point_controller", scenario)
