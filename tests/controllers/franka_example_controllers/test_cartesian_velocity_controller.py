"""The end effector traces its line."""

from math import sqrt

import pytest

from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)


@pytest.mark.slow
@pytest.mark.parametrize("is_limiting", [True, False])
def test_line_is_traced_within_a_millimetre(is_limiting):
    station = start_example("CartesianVelocity", rate_limiting=is_limiting)
    start = Arms(station.robots).state("panda").O_T_EE[12:15]

    path = run_without_errors(station, 8.0)

    for x, y, z in path:
        dx, dz = x - start[0], z - start[2]
        assert abs(dx + dz) / sqrt(2.0) < 1e-4  # measured: 11 um
        assert abs(y - start[1]) < 1e-4
    # The mean of the speed is half of the peak: 0.025 m/s for 4 s.
    farthest = max(x for x, _, _ in path) - start[0]
    assert farthest * sqrt(2.0) == pytest.approx(0.1, abs=1e-3)
    assert path[-1] == pytest.approx(start, abs=1e-3)
    assert not any(Arms(station.robots).state("panda").last_motion_errors)
