"""Whether station time passes."""

import pytest

from station.core.errors import ParameterError
from station.core.loop.pace import Pace


def test_time_passes_unless_paused():
    pace = Pace(0.5)
    assert pace.real_time_factor == 0.5
    assert pace.passes()

    pace.paused = True

    assert not pace.passes()


def test_steps_are_counted_down_while_paused():
    pace = Pace()
    pace.paused, pace.steps_due = True, 2

    assert [pace.passes() for _ in range(3)] == [True, True, False]


def test_resuming_forgets_the_steps():
    pace = Pace()
    pace.paused, pace.steps_due = True, 5

    pace.resume()

    assert (pace.passes(), pace.steps_due) == (True, 0)


@pytest.mark.parametrize("factor", [0.0, 1e-308, 0.0099, 100.1, float("nan")])
def test_factor_out_of_range_is_refused_with_the_range(factor):
    with pytest.raises(ParameterError, match=r"0\.01 to 100"):
        Pace(factor)
