"""The elbow swings, the end effector stays."""

import pytest

from station.controllers.franka_example_controllers.elbow_controller import AMPLITUDE
from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)


@pytest.mark.slow
def test_elbow_swings_and_the_end_effector_stays():
    station = start_example("Elbow")
    start = Arms(station.robots).state("panda")

    path = run_without_errors(station, 5.0)

    state = Arms(station.robots).state("panda")
    assert state.elbow_d[0] == pytest.approx(start.elbow_d[0] + 2 * AMPLITUDE, abs=1e-3)
    for point in path:
        assert point == pytest.approx(start.O_T_EE[12:15], abs=1e-3)
