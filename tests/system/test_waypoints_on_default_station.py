"""What `station run` runs without a file tracks trajectories as closely as promised."""

from math import sqrt

import pytest

from tests.system.arm_bench import ARM, ArmBench
from tests.system.test_joint_trajectories_on_franka import WAYPOINTS

PACE = 1.2
"""Time from waypoint to waypoint [s]."""


@pytest.fixture
def bench(tmp_path):
    bench = ArmBench(tmp_path)
    yield bench
    bench.close()


@pytest.mark.parametrize("name", [ARM, "position_joint_trajectory_controller"])
def test_five_waypoints_are_tracked_within_six_milliradians(bench, name):
    bench.start(name)
    goal = bench.send(*WAYPOINTS, name=name, pace=PACE)
    cycles = round(len(WAYPOINTS) * PACE * 1000)
    squares = [0.0] * 7
    for _ in range(cycles):
        bench.station.loop.step()
        errors = bench.station.controller_sample(name).error
        squares = [s + e * e for s, e in zip(squares, errors, strict=True)]
    assert (
        max(sqrt(square / cycles) for square in squares) < 6e-3
    )  # friction and noise included
    done = bench.finish(goal, name)
    assert done.status == "succeeded"
    bench.run(0.5)
    assert bench.positions() == pytest.approx(WAYPOINTS[-1], abs=2e-3)
    assert bench.client.robot("panda").errors().errors == []
