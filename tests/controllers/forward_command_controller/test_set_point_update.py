"""A set-point is followed without Python as long as there is no news of another one."""

from collections import deque

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.memory.doubles import doubles, put, zeros
from tests.both_modes import assert_same, compiled, needs_both, sibling


class Following:
    """Two joints that are measured at 1 and 2, and follow a set-point by PIDs."""

    def __init__(self, module) -> None:
        modules = {
            name: sibling(module, name)
            for name in (
                "joint_errors",
                "pid_group",
                "sample_columns",
                "set_point_news",
            )
        }
        self.slot = deque(maxlen=1)
        self.news = modules["set_point_news"].SetPointNews(self.slot)
        self.set_point = module.SetPointInForce(self.news, 2)
        put(self.set_point.desired, [1.5, 1.0])
        errors, rates, self.commands = zeros(2), zeros(2), zeros(2)
        pids = modules["pid_group"].PidGroup(errors, rates, self.commands)
        for k, (p, d) in enumerate([(10.0, 2.0), (100.0, 3.0)]):
            pids.set_gains(k, p, 0.0, d, 0.0, 0.0)
        compare = modules["joint_errors"].JointErrors
        law = module.SetPointPidLaw(
            self.set_point,
            compare(self.set_point.desired, doubles([1.0, 2.0]), errors),
            compare(self.set_point.desired_rates, doubles([0.1, 0.2]), rates),
            pids,
        )
        columns = [self.set_point.desired, self.commands]
        self.sampled = modules["sample_columns"].SampleColumns(columns)
        self.update = module.SetPointUpdate(self.set_point, law, self.sampled)


@pytest.fixture
def following():
    return Following(compiled("set_point_update"))


def test_without_news_the_set_point_is_followed_and_the_sample_kept(following):
    assert following.update.run(3.0, 0.001)
    # The rates of the errors are those since an error of 0.
    assert [*following.commands] == [5.0 + 2.0 * 500.0, -100.0 - 3.0 * 1000.0]
    assert following.sampled.newest[0] == 3.0
    assert following.update.period == 0.001


def test_known_rates_are_compared_with_the_measured_ones(following):
    put(following.set_point.desired_rates, [0.6, 0.2])
    following.set_point.has_rates = True
    assert following.update.run(3.0, 0.001)
    assert [*following.commands] == [5.0 + 2.0 * 0.5, -100.0]


@pytest.mark.parametrize("news", ["waits", "is void", "may expire"])
def test_with_news_nothing_is_done(following, news):
    if news == "waits":
        following.slot.append([0.0, 0.0])
    elif news == "is void":
        following.news.is_void = True
    else:
        following.news.deadline = 100.0
    assert not following.update.run(3.0, 0.001)
    assert [*following.commands] == [0.0, 0.0]
    assert following.sampled.newest is None


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
            following.update.run(0.0, 0.001)
            found += following.commands
        return found

    assert_same("set_point_update", scenario)
