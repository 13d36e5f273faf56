"""The joints swing by velocity commands."""

import pytest

from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)


@pytest.mark.slow
def test_joints_go_the_way_that_is_under_the_velocity():
    station = start_example("JointVelocity")
    start = Arms(station.robots).state("panda").q_d

    run_without_errors(station, 4.0)

    state = Arms(station.robots).state("panda")
    assert state.dq == pytest.approx([0.1] * 7, abs=2e-3)
    # Half of the mean velocity of 0.05 rad/s over 8 s.
    expected = [q + 0.2 for q in start]
    assert state.q_d == pytest.approx(expected, abs=1e-3)
