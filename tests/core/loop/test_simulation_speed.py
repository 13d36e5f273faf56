"""Whether station time passes."""

import pytest

from station.core.errors import ParameterError
from station.core.loop.simulation_speed import SimulationSpeed


def test_time_passes_unless_paused():
    speed = SimulationSpeed(0.5)
    assert speed.real_time_factor == 0.5
    assert speed.passes()

    speed.paused = True

    assert not speed.passes()


def test_steps_are_counted_down_while_paused():
    speed = SimulationSpeed()
    speed.paused, speed.steps_due = True, 2

    assert [speed.passes() for _ in range(3)] == [True, True, False]


def test_resuming_forgets_the_steps():
    speed = SimulationSpeed()
    speed.paused, speed.steps_due = True, 5

    speed.resume()

    assert (speed.passes(), speed.steps_due) == (True, 0)


@pytest.mark.parametrize("factor", [0.0, 1e-308, 0.0099, 100.1, float("nan")])
def test_factor_out_of_range_is_refused_with_the_range(factor):
    with pytest.raises(ParameterError, match=r"0\.01 to 100"):
        SimulationSpeed(factor)
