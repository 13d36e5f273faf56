"""Times as ROS writes them, and the port for trajectories."""

import pytest

from station.core.control.controller import TrajectoryPort
from station.core.trajectory.ros_time import to_nanoseconds, to_seconds


@pytest.mark.parametrize(
    ("seconds", "nanoseconds"),
    [
        (0.0, 0),
        (1e-9, 1),
        (10.117231181, 10_117_231_181),
        (812455251.854365826, 812_455_251_854_365_826),
        (-0.25, -250_000_000),
    ],
)
def test_seconds_become_whole_nanoseconds(seconds, nanoseconds):
    # A float of 8e8 s resolves 1.2e-7 s.
    assert to_nanoseconds(seconds) == pytest.approx(nanoseconds, abs=120)


def test_sums_compare_exactly():
    total = to_nanoseconds(0.1) + to_nanoseconds(0.2)
    assert total == to_nanoseconds(0.3)
    assert to_seconds(to_nanoseconds(10.5)) == 10.5


def test_it_is_a_contract_and_nothing_to_use_by_itself():
    with pytest.raises(TypeError, match="abstract"):
        TrajectoryPort()
