"""A station without threads, sockets and files repeats a trial bit for bit."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from station.app.composition import compose
from station.config import load_config
from station.core import SnapshotRing, SwitchRequest
from station.core.clock import ManualClock
from station.core.franka.arms import Arms

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "experiments.md"
EXAMPLE = re.search(r"^```python\n(.*?)^```", PAGE.read_text(), re.M | re.S)[1]
ARM = "effort_group_position_controller"
TARGET = [0.3, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]

WATCH = """
import sys, threading

def watch(event, arguments):
    is_written = event == "open" and set(str(arguments[1])) & set("wax+")
    if event.startswith("socket.") or is_written:
        print("unwanted:", event, arguments)

import mujoco  # whose import asks another program for its version, through a pipe
sys.addaudithook(watch)
"""
COUNT_THREADS = "\nprint('threads:', threading.active_count())\n"


def make_station():
    # Set-points expire by the clock, and a busy machine may take long for a trial.
    return compose(load_config(), ManualClock(), snapshots=SnapshotRing(16)).station


@pytest.fixture(scope="module")
def station():
    """The station of the default configuration, in this thread alone."""
    return make_station()


def run_trial(station, *, controller=ARM, cycles=200):
    """Reset the world, step to the target, and return all positions."""
    station.simulation.reset()
    station.switch_controllers(SwitchRequest(start=(controller,)))
    station.motion.set_command(controller, TARGET)
    positions = []
    for _ in range(cycles):
        station.loop.step()
        positions.append(tuple(station.latest().position))
    station.switch_controllers(SwitchRequest(stop=(controller,)))
    return positions


@pytest.mark.parametrize("controller", [ARM, "position_streaming_controller"])
def test_a_trial_after_a_reset_is_the_same_bit_for_bit(station, controller):
    first = run_trial(station, controller=controller)

    assert first[-1][0] > 0.01
    assert run_trial(station, controller=controller) == first


def test_a_trial_that_ended_in_a_reflex_leaves_nothing_behind(station):
    quiet = run_trial(station)

    arms = Arms(station.robots)
    arms.apply_force("panda", "panda_link7", [0.0, 40.0, 0.0], [0.0] * 3, 5.0)
    station.switch_controllers(SwitchRequest(start=(ARM,)))
    station.loop.step(200)
    assert station.latest().mode == "reflex"
    station.robots.recover_all()

    assert run_trial(station) == quiet


def test_stations_of_one_process_know_nothing_of_each_other(station):
    alone = run_trial(station)
    other = make_station()
    run_trial(other, cycles=50)

    assert run_trial(station) == alone
    other.simulation.reset({"panda_joint1": 1.0})
    other.loop.step()
    assert other.latest().position[0] == pytest.approx(1.0, abs=1e-3)
    assert abs(station.latest().position[0] - 1.0) > 0.5


def test_the_example_uses_no_thread_no_socket_and_writes_no_file(tmp_path):
    result = subprocess.run(
        [sys.executable, "-c", WATCH + EXAMPLE + COUNT_THREADS],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=True,
    )

    overshoot, threads = result.stdout.splitlines()
    assert threads == "threads: 1"
    assert overshoot.startswith("{100.0: ")
    assert list(tmp_path.iterdir()) == []
