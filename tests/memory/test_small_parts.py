"""Checks, copies and statistics say the same in both modes."""

from math import inf, nan

import pytest
from hypothesis import given

from station.memory.doubles import doubles, zeros
from tests.both_modes import (
    arrays,
    assert_same,
    interpreted,
    needs_both,
    numbers,
    sibling,
)


@pytest.mark.parametrize(
    ("values", "bad"),
    [
        ([0.0, 1.0, -1.0], -1),
        ([1e308, 1e308, 1e308], -1),
        ([0.0, nan, inf], 1),
        ([0.0, 1.0, -inf], 2),
    ],
)
def test_the_first_number_that_is_not_finite_is_found(values, bad):
    check = interpreted("vectors").FiniteCheck(doubles(values))
    assert check.first_bad() == bad


def test_a_block_of_commands_tells_what_changed_and_writes_it_back():
    memory = doubles([1.0, 2.0])
    block = interpreted("command_gate").DoublesBlock(memory)
    assert not block.has_changed()
    memory[1] = nan
    assert block.has_changed()
    block.write_copy()
    assert list(memory) == [1.0, 2.0]
    memory[0] = inf
    assert not block.copy_commands()


def test_durations_keep_the_last_and_sum_up_all():
    durations = interpreted("durations").DurationRing(2)
    for value in (1.0, 3.0, 2.0):
        durations.add(value)
    assert list(durations.values) == [2.0, 3.0]
    assert (durations.count, durations.largest, durations.total) == (3, 3.0, 6.0)
    durations.reset()
    assert (durations.count, durations.largest, durations.squares) == (0, 0.0, 0.0)


def test_the_times_of_the_last_cycles_are_kept_part_by_part():
    times = interpreted("durations").CycleTimes(2)
    for begin, parts in ((0.0, (4.0, 1.0, 1.0)), (8.0, (1.0, 2.0, 3.0))):
        ends = [begin + sum(parts[:i]) for i in range(4)]
        times.add(*ends)
    times.add(20.0, 20.5, 20.75, 22.0)
    assert list(times.rows) == [0.5, 0.25, 1.25, 2.0, 1.0, 2.0, 3.0, 6.0]
    longest = [times.longest_read, times.longest_update, times.longest_write]
    assert (times.count, longest, times.longest_total) == (3, [4.0, 2.0, 3.0], 6.0)
    assert times.last == 22.0
    times.reset()
    times.add(0.0, 0.5, 0.5, 1.0)
    assert (times.count, times.longest_read, times.longest_total) == (1, 0.5, 1.0)
    assert list(times.rows)[:4] == [0.5, 0.0, 0.5, 1.0]


def test_speeds_within_their_limits_hold_and_a_nan_does_not():
    speeds, shares = doubles([1.0, 0.1]), doubles([0.5, 0.5])
    check = interpreted("world_step").SpeedCheck(speeds, shares)
    assert check.holds()
    speeds[1] = 2.1
    assert not check.holds()
    speeds[1] = nan
    assert not check.holds()


def test_fingers_go_to_their_target_step_by_step_and_not_too_far_ahead():
    module = interpreted("finger_motor")
    memory = {"positions": doubles([0.02]), "controls": zeros(1)}
    motor = module.FingerMotor(
        sibling(module, "simulator_memory").SimulatorMemory(1, **memory)
    )
    motor.stiffness, motor.step, motor.reach = 100.0, 0.01, 0.015
    motor.place, motor.target = 0.02, 0.04
    places = []
    for _ in range(3):
        motor.prepare_step()
        places.append(motor.place)
    assert places == pytest.approx([0.03, 0.035, 0.035])
    assert memory["controls"][0] == pytest.approx(3.5)


@pytest.mark.parametrize(
    ("values", "finite", "some"),
    [
        ([0.0, -0.0], True, False),
        ([0.0, 5e-324], True, True),
        ([1.0, nan], False, True),
        ([inf, -inf], False, True),
        ([1e308, 1e308], False, True),
    ],
)
def test_many_numbers_are_looked_at_at_once(values, finite, some):
    module, memory = interpreted("vectors"), doubles(values)
    assert (module.are_finite(memory, 2), module.any_of(memory, 2)) == (finite, some)
    assert module.differ(memory, doubles([0.0, 0.0]), 2) == some


@needs_both
@given(arrays(4), numbers, numbers)
def test_both_modes_give_the_same_bits(values, target, step):
    def finite(module):
        return [module.FiniteCheck(doubles(values)).first_bad()]

    def blocks(module):
        block = module.DoublesBlock(doubles(values))
        return [block.copy_commands(), block.has_changed(), *block.values]

    def durations(module):
        kept = module.DurationRing(3)
        for value in values:
            kept.add(value)
        times = module.CycleTimes(1)
        times.add(*values)
        return [*kept.values, kept.largest, kept.total, kept.squares, *times.rows]

    def speeds(module):
        # Rounded differently, but it is the braking that decides at the limit.
        if abs(sum(value * value for value in values) - 4.0) < 1e-9:
            return []
        return [module.SpeedCheck(doubles(values), doubles([0.5] * 4)).holds()]

    def fingers(module):
        memory = {"positions": doubles(values[:1]), "controls": zeros(1)}
        motor = module.FingerMotor(
            sibling(module, "simulator_memory").SimulatorMemory(1, **memory)
        )
        motor.stiffness, motor.reach = 5000.0, values[1]
        motor.place, motor.step, motor.target = values[2], step, target
        motor.prepare_step()
        return [motor.place, memory["controls"][0]]

    def at_once(module):
        memory, size = doubles(values), len(values)
        return [
            module.are_finite(memory, size),
            module.any_of(memory, size),
            module.differ(memory, doubles([*values[:3], target]), size),
        ]

    assert_same("vectors", at_once)
    assert_same("vectors", finite)
    assert_same("command_gate", blocks)
    assert_same("durations", durations)
    assert_same("world_step", speeds)
    assert_same("finger_motor", fingers)
