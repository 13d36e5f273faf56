"""The hand runs into a table: the arm stops, says what to do, recovers, goes on."""

import gc
import threading

import mujoco
import numpy as np
import pytest

from station.core.control.controller import ControllerState
from station.core.control.switching import SwitchRequest
from station.core.errors import SwitchRefusedError
from station.core.facade.station import Station
from station.core.franka import RobotMode
from station.core.franka.arms import Arms
from station.hw.franka.franka_hw import FrankaHW
from tests.franka_station import JOINTS, make_franka_station

pytestmark = pytest.mark.long

# The tip of the hand starts at 0.487 m, the table's top is just below.
TABLE = {
    "name": "table",
    "type": "table",
    "size": [0.6, 0.6, 0.1],
    "position": [0.35, 0.0, 0.46],
}
THRESHOLD = 20.0
DOWN = [0.0, 0.15, 0.0, 0.0, 0.0, 0.0, 0.0]
UP = [-speed for speed in DOWN]


@pytest.fixture
def station() -> Station:
    station = make_franka_station(objects=[TABLE])
    group = "velocity_controllers/JointGroupVelocityController"
    station.load_controller("speed", group, {"joints": JOINTS})
    return station


def touch(station: Station) -> float:
    """Return the largest component of the force of the table on the hand [N]."""
    hw = station.loop.hw
    assert isinstance(hw, FrankaHW)
    assert hw.simulated_world() is not None
    model, data = hw.simulated_world().world.model, hw.simulated_world().world.data
    total, wrench = np.zeros(3), np.zeros(6)
    for number in range(data.ncon):
        mujoco.mj_contactForce(model, data, number, wrench)
        axes = data.contact[number].frame.reshape(3, 3)
        total += axes.T @ wrench[:3]
    return float(np.abs(total).max())


def drive_into_table(station: Station) -> tuple[int, int]:
    """Return when the force crossed the threshold and when the arm stopped [cycle]."""
    station.switch_controllers(SwitchRequest(("speed",), ()))
    station.motion.set_command("speed", DOWN)
    crossed = 0
    for _ in range(2_000):
        station.loop.step()
        if not crossed and touch(station) > THRESHOLD:
            crossed = station.loop.cycle
        if station.latest().mode != "move":
            return crossed, station.loop.cycle
    raise AssertionError("the table was not felt")


def move_away(station: Station) -> None:
    station.switch_controllers(SwitchRequest(("speed",), ()))
    station.motion.set_command("speed", UP)
    station.loop.step(300)
    assert station.latest().mode == "move", Arms(station.robots).report("panda")
    station.switch_controllers(SwitchRequest((), ("speed",)))
    station.loop.step(100)


def run_into_table_and_recover(station: Station) -> int:
    """Return how many cycles after the crossing the arm stopped."""
    crossed, stopped = drive_into_table(station)
    report = Arms(station.robots).report("panda")
    assert report.robot_mode is RobotMode.REFLEX
    assert "cartesian_reflex" in {error.name for error in report.errors}
    assert "recover" in report.remedy
    assert station.controller("speed").state is ControllerState.STOPPED
    station.loop.step(200)
    held = Arms(station.robots).state("panda").q
    with pytest.raises(SwitchRefusedError, match="mode reflex"):
        station.switch_controllers(SwitchRequest(("speed",), ()))
    station.loop.step(100)
    assert Arms(station.robots).state("panda").q == pytest.approx(held, abs=2e-4)
    station.robots.recover("panda")
    station.loop.step(50)
    assert station.latest().mode == "idle"  # although it still touches the table
    move_away(station)
    return stopped - crossed


def test_arm_stops_within_five_milliseconds_and_recovers(station: Station) -> None:
    assert 0 <= run_into_table_and_recover(station) <= 5


def count_objects(station: Station) -> int:
    """Return how many objects there are besides the inputs that a recorder takes."""
    station.inputs.take_inputs()
    gc.collect()
    return len(gc.get_objects())


def test_hundred_times_in_a_row_nothing_leaks(station: Station) -> None:
    delays = [run_into_table_and_recover(station) for _ in range(10)]
    objects, threads = count_objects(station), threading.active_count()
    delays += [run_into_table_and_recover(station) for _ in range(90)]
    assert max(delays) <= 5
    assert count_objects(station) - objects < 50
    assert threading.active_count() == threads
