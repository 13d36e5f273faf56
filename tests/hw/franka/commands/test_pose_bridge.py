"""Poses go on while the loop is late, and return to its commands smoothly."""

from itertools import pairwise, repeat
from math import cos, hypot, pi, sin
from random import Random

import pytest
from hypothesis import given, strategies as st

from station.core.franka import FrankaPoseCartesianInterface
from station.hw.franka.commands.cartesian_sender import PoseBridge
from station.memory.doubles import doubles
from tests.both_modes import arrays, assert_same, needs_both
from tests.hw.franka.commands.test_motion_start import controllers, make

UNIT = doubles([1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0])
NO_ELBOW = doubles([0.0, 0.0])
PERIOD = 0.001


def at(x):
    pose = doubles(UNIT)
    pose[12] = x
    return pose


def pass_on(bridge, x):
    """Return where a commanded place along x is sent."""
    if bridge.is_expected():
        bridge.note_next(at(x), NO_ELBOW)
        return x
    bridge.pass_on(at(x), NO_ELBOW)
    return x if bridge.is_on_commands else bridge.pose[12]


def predict(bridge):
    """Return the place along x that is sent without a command."""
    bridge.predict()
    return bridge.pose[12]


@pytest.fixture
def bridge():
    """Return a bridge that has passed on a motion of 0.1 mm per cycle."""
    bridge = PoseBridge(PERIOD)
    bridge.rest_at(at(0.0), NO_ELBOW)
    for cycle in range(1, 4):
        pass_on(bridge, 1e-4 * cycle)
    return bridge


def test_the_last_three_commands_are_kept(bridge):
    places = [bridge.poses[16 * ((bridge.newest - age) % 3) + 12] for age in range(3)]
    assert places == pytest.approx([3e-4, 2e-4, 1e-4])
    cycles = (bridge.last_cycle, bridge.earlier_cycle, bridge.before_cycle)
    assert cycles == (3, 2, 1)


def test_commands_of_every_cycle_are_expected_and_noted(bridge):
    assert bridge.is_expected()
    bridge.note_next(at(0.1), NO_ELBOW)
    assert bridge.is_expected()
    assert bridge.repeats(at(0.1))
    assert not bridge.repeats(at(3e-4))


def test_a_command_after_a_gap_is_not_expected_until_the_return(bridge):
    bridge.predict()
    assert not bridge.is_expected()
    bridge.pass_on(at(5e-4), NO_ELBOW)
    assert not bridge.is_on_commands
    assert not bridge.is_expected()


def test_motion_goes_on_without_commands(bridge):
    places = [predict(bridge) for _ in range(4)]

    assert places == pytest.approx([4e-4, 5e-4, 6e-4, 7e-4])


def test_return_to_the_commands_is_smooth_and_complete(bridge):
    places = [predict(bridge) for _ in range(5)]
    # The motion had stopped at once.
    places += [pass_on(bridge, 3e-4) for _ in range(4_000)]

    speeds = [b - a for a, b in pairwise(places)]
    # 1 m/s^2 in cycles of 1 ms.
    assert max(abs(b - a) for a, b in pairwise(speeds)) < 1.1e-6
    assert places[-1] == pytest.approx(3e-4, abs=1e-8)


def test_commands_pass_unchanged_again_after_the_return(bridge):
    bridge.predict()
    for cycle in range(5, 1_000):
        pass_on(bridge, 1e-4 * cycle)

    assert bridge.is_on_commands
    assert bridge.is_expected()


def test_whatever_the_gaps_are_nothing_leaps() -> None:
    bridge, random, sent, cycle = PoseBridge(PERIOD), Random(1), [], 0
    bridge.rest_at(at(0.0), NO_ELBOW)
    while cycle < 3_000:
        gap = random.choice([0] * 10 + [1, 2, 9, 19])
        sent += [predict(bridge) for _ in range(gap)]
        cycle += gap + 1
        # Up to 0.3 m/s and 0.9 m/s^2.
        x = 0.1 * (1.0 - cos(3e-3 * cycle))
        sent.append(pass_on(bridge, x))

        assert sent[-1] == pytest.approx(x, abs=5e-3)
    speeds = [(b - a) / 1e-3 for a, b in pairwise(sent)]
    accelerations = [(b - a) / 1e-3 for a, b in pairwise(speeds)]
    jerks = [(b - a) / 1e-3 for a, b in pairwise(accelerations)]
    assert max(map(abs, accelerations)) < 2.0
    assert max(map(abs, jerks)) < 300.0


def test_elbow_goes_on_as_well():
    bridge = PoseBridge(PERIOD)
    bridge.rest_at(UNIT, NO_ELBOW)
    for angle in (0.1, 0.2, 0.3):
        bridge.pass_on(UNIT, doubles([angle, -1.0]))

    bridge.predict()
    assert [*bridge.elbow] == pytest.approx([0.4, -1.0])


@needs_both
@given(st.lists(st.tuples(arrays(16), arrays(2), st.integers(0, 2)), max_size=6))
def test_both_modes_agree_bit_for_bit(commands):
    def scenario(module):
        bridge, results = module.PoseBridge(PERIOD), []
        bridge.rest_at(UNIT, NO_ELBOW)
        for values, elbow, gap in commands:
            for _ in range(gap):
                bridge.predict()
            pose = doubles([*UNIT[:12], *values[12:]])
            if bridge.is_expected():
                bridge.note_next(pose, doubles(elbow))
            else:
                bridge.pass_on(pose, doubles(elbow))
            results += [bridge.repeats(doubles(values)), bridge.newest]
            results += [*bridge.poses, *bridge.pose, *bridge.elbow]
            results += [bridge.is_on_commands, bridge.before_cycle]
        return [float(value) for value in results]

    assert_same("cartesian_sender", scenario)


@pytest.mark.slow
@pytest.mark.parametrize(
    "periods_ms",
    [
        repeat(5),
        repeat(10),
        (Random(3).choice([1] * 40 + [2, 3, 5, 8, 15, 20]) for _ in repeat(None)),
    ],
    ids=["200 Hz", "100 Hz", "late now and then"],
)
def test_slow_and_late_loops_trace_an_arc_without_an_error(periods_ms):
    hw = make()
    hw.do_switch(controllers("cp"), [])
    handle = hw.get(FrankaPoseCartesianInterface).get_handle("panda_robot")
    start = list(handle.get_robot_state().O_T_EE_d)
    time = 0.0
    while time < 5.0:
        period = next(periods_ms) / 1000.0
        time += period
        hw.read(time, period)
        angle = pi / 4 * (1.0 - cos(pi / 5 * time))
        pose = list(start)
        pose[12] -= 0.15 * sin(angle)
        pose[14] -= 0.15 * (cos(angle) - 1.0)
        handle.set_command(pose)
        hw.write(time, period)

        assert hw.mode() == "move", hw.arm.errors()
        reached = handle.get_robot_state().O_T_EE
        away = hypot(reached[12] - start[12], reached[14] - start[14] - 0.15)
        assert away == pytest.approx(0.15, abs=5e-4)
