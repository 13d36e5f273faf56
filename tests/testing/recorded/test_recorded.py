"""The replay finds a manager and a robot that do not do what was recorded."""

import pytest

from station.core import ControllerManager
from station.testing import RecordedBehaviour
from station.testing.recorded.recorded_behaviour import RECORDED, RecordedRobot


class Backwards(ControllerManager):
    """Lists the controllers in the wrong order."""

    def list_controllers(self):
        return super().list_controllers()[::-1]


class Eager(RecordedRobot):
    """Is told of every switch twice."""

    def do_switch(self, start, stop):
        super().do_switch(start, stop)
        super().do_switch(start, stop)


def failures(suite):
    count = 0
    for scenario in RECORDED["scenarios"]:
        try:
            suite.test_scenario_agrees_with_the_recording(scenario)
        except AssertionError:
            count += 1
    return count


def test_the_recording_is_shipped_with_the_kit():
    assert len(RECORDED["scenarios"]) == 20
    assert len(RECORDED["matrix"]) > 100


@pytest.mark.parametrize(
    "changes", [{"manager": Backwards}, {"robot": Eager}], ids=["manager", "robot"]
)
def test_another_behaviour_is_found(changes):
    suite = type("Suite", (RecordedBehaviour,), changes)()

    assert failures(RecordedBehaviour()) == 0
    assert failures(suite) > 0
