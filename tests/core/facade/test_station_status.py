"""The status tells where the station is, from the loop, the robot and the latch."""

import pytest

from station.core.clock import ManualClock
from station.core.control.controller_manager import ControllerManager
from station.core.facade.station import Station, label_robot
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.loop.stop_latch import StopState
from station.core.parameters import Parameters


class Dozing(RobotHW):
    """A robot whose mode is its own."""

    def mode(self):
        return "dozing"


class There(Dozing):
    """A real robot that says where it is."""

    def address(self):
        return "172.16.0.2"


class Simulated(There):
    """A robot that knows an address and is simulated all the same."""

    def simulated_world(self):
        return object()


@pytest.mark.parametrize(
    ("robot", "label"),
    [
        (Dozing(), "REAL ROBOT"),
        (There(), "REAL ARM 172.16.0.2"),
        (Simulated(), "SIMULATION"),
    ],
)
def test_a_robot_is_real_unless_it_hands_out_a_simulated_world(robot, label):
    assert label_robot(robot) == label


@pytest.fixture
def station() -> Station:
    robot, clock, parameters = Dozing(), ManualClock(), Parameters()
    manager = ControllerManager(robot, parameters, [], clock)
    loop = ControlLoop(robot, manager, clock=clock, period=0.002)
    return Station(loop, manager, parameters, "test/Dozing")


def test_status_follows_the_cycles(station):
    assert station.status().robot_mode == "unknown"
    station.loop.step(3)
    status = station.status()
    assert (status.cycle, status.time) == (3, pytest.approx(0.006))
    assert (status.robot_type, status.robot_mode) == ("test/Dozing", "dozing")
    assert status.robot_label == "REAL ROBOT"
    assert status.boot_id == station.boot_id


def test_status_shows_a_stop_its_reason_and_the_new_epoch(station):
    before = station.status()
    station.stop("a visitor came near")
    after = station.status()
    assert (before.stop_state, after.stop_state) == (StopState.ARMED, StopState.STOPPED)
    assert after.stop_reason == "a visitor came near"
    assert after.epoch == before.epoch + 1
