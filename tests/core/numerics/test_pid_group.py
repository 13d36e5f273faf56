"""The PIDs of a group are independent, and the same in both modes."""

from math import inf, nan
from typing import NamedTuple

import pytest
from hypothesis import given, strategies as st

from station.core.numerics.pid import PidGains, PidGroup
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import arrays, assert_same, needs_both, numbers

SIZE = 3
NO_ERROR, NO_RATE = 1, 2
PLAIN = PidGains(2.0, 3.0, 0.5, 9.0, -9.0)


def make(module_class, gains=(PLAIN,) * SIZE):
    errors, rates, commands = zeros(SIZE), zeros(SIZE), zeros(SIZE)
    group = module_class(errors, rates, commands)
    for k, each in enumerate(gains):
        group.set_gains(k, each)
    return group, errors, rates, commands


def test_a_joint_whose_error_is_not_finite_leaves_the_others_alone():
    group, errors, rates, commands = make(PidGroup)
    put(errors, [1.0, nan, 1.0])
    assert group.compute_commands(0.5, rates_known=False) == NO_ERROR
    # p 2, integral 0.5 with i 3, rate 2 with d 0.5
    assert commands.tolist() == [4.5, 0.0, 4.5]
    assert rates.tolist() == [2.0, 0.0, 2.0]
    assert [group.integral(k) for k in range(SIZE)] == [0.5, 0.0, 0.5]


def test_a_joint_whose_rate_is_not_finite_is_not_commanded():
    group, errors, rates, commands = make(PidGroup)
    put(errors, [1.0] * SIZE)
    put(rates, [1.0, inf, nan])
    assert group.compute_commands(0.5, rates_known=True) == NO_RATE
    assert commands.tolist() == [4.0, 0.0, 0.0]


@pytest.mark.parametrize("rates_known", [False, True])
def test_no_time_gives_no_command(rates_known):
    group, errors, _, commands = make(PidGroup)
    put(errors, [1.0] * SIZE)
    put(commands, [5.0] * SIZE)
    assert group.compute_commands(0.0, rates_known) == NO_ERROR
    assert commands.tolist() == [0.0] * SIZE


def test_a_rate_set_by_hand_is_used_once():
    group, errors, _, commands = make(PidGroup, [PidGains(d=1.0)] * SIZE)
    group.reset_to(1, 7.0, 0.0)
    put(errors, [1.0] * SIZE)
    group.compute_commands(0.5, rates_known=False)
    assert commands.tolist() == [2.0, 7.0, 2.0]
    group.compute_commands(0.5, rates_known=False)
    assert commands.tolist() == [0.0] * SIZE
    group.reset()
    group.compute_commands(0.5, rates_known=False)
    assert commands.tolist() == [2.0] * SIZE


class Gains(NamedTuple):
    """Gains of any kind; those of a configuration are finite and in order."""

    p: float
    i: float
    d: float
    i_max: float
    i_min: float
    antiwindup: bool


steps = st.tuples(
    st.booleans(),
    arrays(SIZE),
    arrays(SIZE),
    st.one_of(st.sampled_from([0.001, 0.0, -0.001]), numbers),
)


@needs_both
@given(
    st.lists(arrays(5), min_size=SIZE, max_size=SIZE),
    st.lists(st.booleans(), min_size=SIZE, max_size=SIZE),
    st.tuples(numbers, numbers),
    st.lists(steps, max_size=8),
)
def test_both_modes_compute_the_same(gains, antiwindup, start, cycles):
    def scenario(module):
        each = [
            Gains(*values, on) for values, on in zip(gains, antiwindup, strict=True)
        ]
        group, errors, rates, commands = make(module.PidGroup, each)
        group.reset_to(0, *start)
        found = []
        for rates_known, new_errors, new_rates, period in cycles:
            put(errors, new_errors)
            if rates_known:
                put(rates, new_rates)
            found.append(float(group.compute_commands(period, rates_known)))
            found += [*commands, *rates, *map(group.integral, range(SIZE))]
        return found

    assert_same("pid", scenario)


@needs_both
def test_the_comparison_of_both_modes_can_fail():
    def scenario(module):
        group, errors, _, commands = make(module.PidGroup)
        put(errors, doubles([1.0] * SIZE))
        group.compute_commands(0.5, rates_known=False)
        return [*commands, float(module.__file__.endswith(".py"))]

    with pytest.raises(AssertionError):
        assert_same("pid", scenario)


def test_a_desired_rate_times_its_gain_is_added():
    group, errors, rates, commands = make(PidGroup)
    put(errors, [1.0, nan, 1.0])
    put(rates, [0.0] * SIZE)
    group.feed_forward(doubles([10.0, 20.0, 0.0]), doubles([0.5, 1.0, 1.0]))
    group.compute_commands(0.5, rates_known=True)
    # p 2, integral 0.5 with i 3
    assert commands.tolist() == [3.5 + 5.0, 20.0, 3.5]


@needs_both
@given(arrays(SIZE), arrays(SIZE), arrays(SIZE))
def test_both_modes_add_the_same(given_errors, rates, gains):
    def scenario(module):
        group, errors, _, commands = make(module.PidGroup)
        put(errors, given_errors)
        group.feed_forward(doubles(rates), doubles(gains))
        group.compute_commands(0.5, rates_known=True)
        return commands

    assert_same("pid", scenario)
