"""The joints swing by position commands."""

import pytest

from station.controllers.franka_example_controllers.joint_position_controller import (
    AMPLITUDE,
)
from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)


@pytest.mark.slow
def test_joints_are_where_they_should_be_after_half_a_period():
    station = start_example("JointPosition")
    start = Arms(station.robots).state("panda").q_d

    run_without_errors(station, 5.0)

    moved = [
        now - then
        for now, then in zip(Arms(station.robots).state("panda").q, start, strict=True)
    ]
    way = 2 * AMPLITUDE
    assert moved == pytest.approx([way] * 4 + [-way] + [way] * 2, abs=1e-3)
