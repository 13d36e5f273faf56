"""The watchdog notices, tells, holds and ends a station, on a clock of the test.

What the station tells its watchdog when it starts it.
"""

import json
import signal

import pytest

from station.app.watchdog.__main__ import _settings
from station.app.watchdog.watch import LOOK_PERIOD, NOTICE_AFTER, WatchdogSettings
from station.core.loop.heartbeat import LoopLife, Phase
from tests.app.watchdog.bench import NOW, Bench


@pytest.fixture
def bench(tmp_path):
    """Return a watched station without arms."""
    return Bench(tmp_path, stack_signal=40, end_after=10.0)


def test_a_loop_that_wakes_up_is_left_alone(bench):
    for step in range(100):
        bench.heartbeat.beats[0] = NOW + step
        bench.look(step + 0.079)

    assert (bench.told, bench.sent, bench.watch.incident) == ([], [], None)
    assert bench.watch.trouble(NOW + 99.05) is None


def test_a_standstill_is_told_within_a_tenth_of_a_second(bench):
    bench.watch.take_status({"running": "arm, hand", "cycle": 17})

    bench.look(0.07, 0.08, 0.09)

    (line,) = bench.told
    assert "arm, hand" in line
    assert "stood still for 0.09 s" in bench.watch.trouble(NOW + 0.09)
    assert bench.watch.incident.facts["last_published"]["cycle"] == 17


def test_a_standstill_is_told_once_and_its_end_too(bench):
    bench.look(0.1, 0.2, 0.3)
    bench.heartbeat.beats[0] = NOW + 0.39
    bench.look(0.4, 0.45)

    assert len(bench.told) == 2
    assert "runs again after 0.30 s" in bench.told[1]
    assert bench.watch.incident.facts["recovered_after"] == 0.3
    assert not bench.heartbeat.is_stop_asked


def test_stacks_are_asked_for_once_and_only_of_a_long_standstill(bench):
    bench.look(0.1, 0.9)
    assert bench.sent == []

    bench.look(1.2)
    bench.stacks = "File arm.py\n"
    bench.look(1.3, 1.5, 1.6)

    assert bench.sent == [40]
    assert bench.watch.incident.facts["stacks"] == ["File arm.py"]


def test_a_station_that_does_not_come_back_is_ended_and_then_killed(bench):
    bench.look(0.1, 10.0)
    assert signal.SIGTERM not in bench.sent

    bench.look(10.2, 11.0)
    assert bench.sent[-1] == signal.SIGTERM
    assert bench.heartbeat.is_ended_by_watchdog

    bench.look(12.5, 13.0)
    assert bench.sent[-2:] == [signal.SIGTERM, signal.SIGKILL]
    assert bench.watch.incident.facts["ended_by"] == "SIGKILL"


def test_a_station_may_be_kept_for_a_debugger(tmp_path):
    bench = Bench(tmp_path, end_after=None)

    bench.look(0.1, 1e6)

    assert bench.sent == []


def test_a_loop_that_died_is_told_and_the_station_left_alone(bench):
    bench.heartbeat.life = LoopLife.DIED

    bench.look(0.0, 1.0, 100.0)

    assert len(bench.told) == 1
    assert "died" in bench.told[0]
    assert bench.sent == []


def test_arms_are_told_to_hold_and_the_stop_is_latched(tmp_path):
    command = ("touch", str(tmp_path / "held"))
    bench = Bench(tmp_path, hold_commands=(command,))

    bench.look(0.1)

    assert bench.heartbeat.is_stop_asked
    assert "told the arms to hold" in bench.heartbeat.stop_reason()
    while not bench.watch.incident.facts["hold_commands"]:
        bench.look(0.2)
    (outcome,) = bench.watch.incident.facts["hold_commands"]
    assert outcome["outcome"] == "ended with exit code 0"
    assert (tmp_path / "held").exists()


def test_a_long_step_of_the_start_is_told_at_growing_intervals(bench):
    bench.heartbeat.phase = Phase.STARTING
    bench.watch.take_status({"step": "Loading the controller 'arm'"})

    bench.look(0.0, 2.9, 3.1, 5.0, 6.1)

    assert [line.rpartition(" (")[2] for line in bench.told] == ["3 s).", "6 s)."]
    assert "Loading the controller 'arm'" in bench.told[0]
    assert "Loading" in bench.watch.trouble(NOW)


def test_an_end_that_takes_too_long_is_cut_short(bench):
    bench.heartbeat.phase = Phase.ENDING

    bench.look(0.0, 4.9)
    assert bench.sent == []
    bench.look(5.1, 6.0)

    assert bench.sent == [signal.SIGKILL]
    assert bench.watch.trouble(NOW) == "The station ends."


def test_a_loop_without_a_thread_is_no_standstill(bench):
    bench.heartbeat.life = LoopLife.STOPPED

    assert bench.watch.trouble(NOW + 9.0) == "The control loop is not running."


def test_settings_can_be_replaced(bench):
    bench.watch.take_settings(bench.settings._replace(notice_after=1.0))

    bench.look(0.9)

    assert bench.told == []


def test_a_disk_that_takes_no_incident_keeps_nothing_from_being_done(tmp_path):
    (tmp_path / "incidents").write_text("")
    bench = Bench(tmp_path, end_after=1.0)

    bench.look(0.1, 0.2, 2.0)

    assert "cannot be written" in bench.told[0]
    assert bench.sent == [signal.SIGTERM]


def test_settings_survive_their_way_through_the_pipe():
    settings = WatchdogSettings(
        4711, "operator", "viewer", "/run/incidents", (("hold", "left"), ("hold",))
    )

    assert _settings(json.loads(json.dumps(settings._asdict()))) == settings


def test_a_standstill_is_noticed_within_a_tenth_of_a_second():
    assert NOTICE_AFTER + 2 * LOOK_PERIOD <= 0.1
