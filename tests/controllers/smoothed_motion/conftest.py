"""Ways to run smoothed controllers on joints that follow position commands."""

from itertools import pairwise

import pytest

from station.controllers.smoothed_motion import (
    PositionJointJogController,
    PositionJointStreamingController,
)
from station.core.clock import ManualClock

JOINTS = ["slide", "elbow"]
LIMITS = {
    "joints": JOINTS,
    "max_velocity": [0.5, 1.5],
    "max_acceleration": [2.0, 6.0],
    "max_jerk": [40.0, 120.0],
}


class Runner:
    """Runs a controller on the wall clock of its set-points and notes the motion."""

    def __init__(self, robot, controller):
        self.robot = robot
        self.controller = controller
        self.clock = ManualClock()
        controller.set_points.clock = self.clock
        self.track = []

    def run(self, cycles, period=0.001):
        """Run cycles."""
        for _ in range(cycles):
            self.clock.advance(period)
            self.robot.run_with_position(self.controller, period=period)
            self.track.append(list(self.robot.position[:2]))

    def rates(self, order, period=0.001):
        """Return the largest magnitude of a derivative of the track, per joint."""
        rows = self.track
        for _ in range(order):
            rows = [
                [(b - a) / period for a, b in zip(before, after, strict=True)]
                for before, after in pairwise(rows)
            ]
        return [max(abs(row[i]) for row in rows) for i in range(2)]


@pytest.fixture
def stream(robot):
    """Return a runner of a streaming controller."""
    return Runner(robot, robot.start(PositionJointStreamingController, **LIMITS))


@pytest.fixture
def jog(robot):
    """Return a runner of a jog controller."""
    return Runner(robot, robot.start(PositionJointJogController, **LIMITS))
