"""Smooth motion against closed forms."""

import pytest

from station.controllers.smoothed_motion.axis_limits import AxisLimits
from station.controllers.smoothed_motion.motion_generator import MotionGenerator

LIMITS = AxisLimits((1.0, 1.0), (2.0, 2.0), (20.0, 20.0))


@pytest.fixture
def generator():
    generator = MotionGenerator(LIMITS)
    generator.start([0.0, 0.5], [0.0, 0.0])
    return generator


def run(generator, cycles, period=0.001):
    for _ in range(cycles):
        generator.advance(period)


def test_a_motion_without_target_rests_where_it_started(generator):
    run(generator, 100)

    assert generator.positions == [0.0, 0.5]
    assert generator.velocities == [0.0, 0.0]


def test_the_fastest_way_takes_the_time_of_the_closed_form(generator):
    # With cruise: distance/v + v/a + a/j = 1 + 0.5 + 0.1 s for 1 m.
    generator.go_to([1.0, 0.5])
    run(generator, 1_599)
    assert generator.velocities[0] > 0.0
    run(generator, 2)

    assert generator.positions == pytest.approx([1.0, 0.5], abs=1e-9)
    assert generator.velocities == pytest.approx([0.0, 0.0], abs=1e-9)


def test_braking_ends_where_it_says(generator):
    generator.go_at([1.0, -0.5])
    run(generator, 700)
    ends = generator.resting_positions()
    # From full speed: v^2/(2a) + v a/(2j) = 0.25 + 0.05 m.
    assert ends[0] == pytest.approx(generator.positions[0] + 0.3, abs=1e-9)

    generator.brake()
    run(generator, 700)

    assert generator.positions == pytest.approx(ends, abs=1e-9)
    assert generator.velocities == pytest.approx([0.0, 0.0], abs=1e-9)


def test_long_cycles_lead_to_the_same_place(generator):
    generator.go_to([1.0, 0.0])
    for period in (0.001, 0.004, 0.02) * 80:
        generator.advance(period)

    assert generator.positions == pytest.approx([1.0, 0.0], abs=1e-9)


def test_time_that_stands_still_moves_nothing(generator):
    generator.go_to([1.0, 0.0])
    run(generator, 300)
    before = generator.positions

    run(generator, 10, period=0.0)

    assert generator.positions == before


def test_a_start_in_motion_is_continued_and_ended(generator):
    generator.start([0.0, 0.0], [0.5, 3.0])  # the second is faster than allowed
    generator.advance(0.001)
    assert generator.positions == pytest.approx([0.5e-3, 3.0e-3], abs=1e-5)

    run(generator, 3_000)

    assert generator.velocities == pytest.approx([0.0, 0.0], abs=1e-9)


def test_what_cannot_arrive_together_arrives_all_the_same():
    # Found among random streams: ruckig 0.19.4 finds no synchronised motion here.
    axis = 1.0 / 3.0**0.5
    limits = AxisLimits(
        (0.3 * axis,) * 3 + (1.0 * axis,) * 3,
        (1.5 * axis,) * 3 + (4.0 * axis,) * 3,
        (15.0 * axis,) * 3 + (40.0 * axis,) * 3,
    )
    state = (
        [-0.06613950721805234, -0.04032492418378759, 0.020162907568371042, 0, 0, 0],
        [-0.0984789103623339, -0.09864162820588442, -0.017276930192972936,
         -0.1330875211303574, -0.01554849796155242, 0.3683946537007316],
        [0.23914478537466075, 0.266812457161681, 0.1299038105676672,
         -1.2701705922171787, 0.5748711963334194, 0.3464101615137785],
    )  # fmt: skip
    target = [0.10044507167952277, -0.3360004623804792, -0.48923567579073046,
              1.5365225122103698, 0.7406612576758644, 1.142515625784421]  # fmt: skip
    generator = MotionGenerator(limits)
    generator.start(state[0], state[1])
    generator.restore(state)
    generator.go_to(target)
    run(generator, 6_000)

    assert generator.positions == pytest.approx(target, abs=1e-9)


def test_positions_can_be_counted_anew_and_a_step_taken_back(generator):
    generator.go_at([1.0, 0.0])
    run(generator, 300)
    before = generator.state()
    run(generator, 1)
    generator.restore(before)
    generator.relocate([5.0, 0.5])
    generator.go_at([1.0, 0.0])
    run(generator, 1)

    assert generator.velocities[0] > before[1][0]
    assert generator.accelerations[0] == pytest.approx(2.0)
    assert generator.positions[0] == pytest.approx(5.0 + before[1][0] * 1e-3, abs=1e-5)


def test_a_motion_that_has_braked_is_still_until_something_is_wanted(generator):
    generator.go_at([0.3, -0.2])
    run(generator, 500)
    assert not generator.is_still
    generator.brake()
    run(generator, 1_000)
    assert generator.is_still
    rest = generator.positions

    run(generator, 10)
    assert generator.positions is rest  # nothing was computed
    generator.go_at([0.3, -0.2])
    run(generator, 10)
    assert generator.positions[0] > rest[0]


def test_a_target_is_not_rest_even_where_the_axes_are(generator):
    generator.go_to([0.0, 0.5])
    run(generator, 10)
    assert not generator.is_still


@pytest.mark.parametrize("cycles", range(1, 400, 37))
def test_rounding_is_no_motion_whenever_it_braked(generator, cycles):
    generator.go_to([0.3, 0.2])
    run(generator, cycles)
    generator.brake()
    run(generator, 3000)

    assert generator.is_still
    assert generator.velocities == generator.accelerations == [0.0, 0.0]
