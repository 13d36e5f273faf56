"""The strategies against control_toolbox's formulas, one PID at a time."""

import numpy as np
import pytest
from hypothesis import given

from station.controllers.pid_controller.saturating_pids import (
    STRATEGIES,
    SaturatingPids,
)
from station.memory.doubles import put
from tests.both_modes import arrays, assert_same, needs_both

KP, KI, KD, TRACKING, BOUND, CLAMP, DT = 2.0, 3.0, 0.1, 0.5, 1.5, 0.4, 0.01
ERRORS = np.concatenate([np.full(30, 1.0), np.full(30, -0.4), np.zeros(5)])


def pids(strategy, bound=BOUND):
    made = SaturatingPids(1)
    for memory, value in (
        (made.p, KP),
        (made.i, KI),
        (made.d, KD),
        (made.tracking, TRACKING),
        (made.maximum, bound),
        (made.minimum, -bound),
        (made.part_max, CLAMP),
        (made.part_min, -CLAMP),
        (made.strategies, STRATEGIES[strategy]),
    ):
        memory[0] = value
    return made


def run(made, errors=ERRORS):
    found = []
    for error in errors:
        made.errors[0] = error
        made.compute_commands(DT, rates_known=False)
        found.append(made.commands[0])
    return found


def expected(strategy):
    """Return the commands of control_toolbox's Pid::compute_command."""
    part, last, found = 0.0, 0.0, []
    for error in ERRORS:
        rate, last = (error - last) / DT, error
        still = not abs(error) > 0.0
        if strategy.startswith("legacy"):
            part += 0.0 if still else KI * DT * error
            if "antiwindup" in strategy:
                part = np.clip(part, -CLAMP, CLAMP)
            free = KP * error + np.clip(part, -CLAMP, CLAMP) + KD * rate
        else:
            free = KP * error + part + KD * rate
        command = np.clip(free, -BOUND, BOUND)
        if still:
            pass
        elif strategy == "back_calculation":
            part += DT * (KI * error + (command - free) / TRACKING)
        elif strategy == "none" or (
            strategy == "conditional_integration"
            and not (free != command and error * free > 0)
        ):
            part += DT * KI * error
        if not strategy.startswith("legacy"):
            part = np.clip(part, -CLAMP, CLAMP)
        found.append(command)
    return found


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_the_commands_are_those_of_the_formulas(strategy):
    assert run(pids(strategy)) == pytest.approx(expected(strategy), abs=1e-12)


def test_no_strategy_but_none_winds_up():
    parts = {}
    for strategy in STRATEGIES:
        made = pids(strategy, bound=0.5)
        if "legacy" not in strategy:
            made.part_max[0], made.part_min[0] = np.inf, -np.inf
        run(made, np.full(1000, 1.0))
        parts[strategy] = made.parts[0]

    assert parts["none"] == pytest.approx(30.0)
    assert parts["conditional_integration"] == 0.0
    assert parts["legacy with antiwindup"] == pytest.approx(CLAMP)
    # It settles where the drawing back equals the integration.
    assert parts["back_calculation"] == pytest.approx(
        0.5 - KP + KI * TRACKING, abs=1e-6
    )


def test_an_error_in_the_deadband_is_not_integrated():
    made = pids("none")
    made.deadband[0] = 0.1
    run(made, [0.1] * 10)
    assert made.parts[0] == 0.0
    run(made, [0.11])
    assert made.parts[0] > 0.0


def test_a_known_rate_is_no_last_error():
    made = pids("none", bound=np.inf)
    run(made, [0.2])
    made.errors[0], made.rates[0] = 0.7, 0.0
    made.compute_commands(DT, rates_known=True)
    made.rates[0] = float("nan")
    made.compute_commands(DT, rates_known=True)

    # The error before is still that of the last computed rate.
    expected = KP * 0.7 + KI * DT * 0.9 + KD * (0.7 - 0.2) / DT
    assert made.commands[0] == pytest.approx(expected)


def test_without_time_or_error_the_command_stays():
    made = pids("none")
    run(made, [0.5])
    before = made.commands[0]
    made.errors[0] = 0.7
    made.compute_commands(0.0, rates_known=False)
    run(made, [float("nan")])

    assert made.commands[0] == before


@needs_both
@given(arrays(5), arrays(5), arrays(25))
def test_both_modes_agree_bit_for_bit(errors, rates, gains):
    def scenario(module):
        made = module.SaturatingPids(5)
        put(made.strategies, [*STRATEGIES.values()])
        for k, memory in enumerate((
            made.p,
            made.i,
            made.d,
            made.maximum,
            made.deadband,
        )):
            put(memory, gains[5 * k : 5 * k + 5])
        put(made.errors, errors)
        put(made.rates, rates)
        for known in (True, False, True):
            made.compute_commands(0.5, known)
        return [*made.commands, *made.parts]

    assert_same("saturating_pids", scenario)
