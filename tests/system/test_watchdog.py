"""The watchdog beside a real station whose controllers do not return."""

import json
import os
import signal
import time
from http.client import HTTPConnection
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from station.client import StationClient
from tests.app.mass_hw import TYPE
from tests.system import hung_controllers, watched_hw
from tests.system.station_process import StationProcess, is_alive, wait_for_end
from tests.waiting import wait_until

MODULE = hung_controllers.__name__
SOON = 0.2
"""What is promised for a stop through the watchdog [s]."""
LOAD = 0.4
"""What a busy machine may add [s]."""
END = 3.0
"""What is promised for an orderly end [s]."""


@pytest.fixture
def start(tmp_path):
    """Return a function that starts a station with one controller that hangs."""
    stations = []

    def start_station(
        kind="EndlessController", *, robot=TYPE, end_after=60.0, **params
    ):
        path = tmp_path / "station.yaml"
        controller = json.dumps({"type": f"{MODULE}:{kind}", **params})
        path.write_text(
            f"robot: {{type: '{robot}', folder: '{tmp_path}'}}\n"
            f"controllers: {{hung: {controller}}}\nstart: []\n"
            f"watchdog: {{end_after: {end_after}}}\n"
        )
        station = StationProcess(tmp_path, str(path), "--no-ui")
        stations.append(station)
        return station

    yield start_station
    for station in stations:
        station.clean_up()


def ask(url, method, path, token=None, body=None):
    """Return status and body of an answer, and how long it took [s]."""
    began = time.monotonic()
    connection = HTTPConnection(urlsplit(url).netloc, timeout=10.0)
    headers = {"Content-Type": "application/json"}
    if token is not None:
        headers["Authorization"] = f"Bearer {token}"
    connection.request(method, path, body=body, headers=headers)
    answer = connection.getresponse()
    content = json.loads(answer.read())
    connection.close()
    return answer.status, content, time.monotonic() - began


def watchdog_ready(access):
    return ask(access["watchdog_url"], "GET", "/ready")[0] == 200


def start_hung(station, access):
    """Start the controller that will hang; its switch is over when this returns."""
    switch = json.dumps({"start": ["hung"]})
    path = "/api/v1/controllers/switch"
    status, answer, _ = ask(access["url"], "POST", path, access["token"], switch)
    assert status == 200, answer
    assert wait_until(lambda: not watchdog_ready(access))
    assert station.process.poll() is None


@pytest.mark.long
@pytest.mark.parametrize(
    "kind", ["EndlessController", "LockedController", "BacktrackingController"]
)
def test_a_hung_station_is_stopped_through_the_watchdog_which_says_where_it_hangs(
    start, kind, tmp_path
):
    station = start(kind)
    access = station.access()
    assert wait_until(lambda: watchdog_ready(access))
    start_hung(station, access)

    def incident():
        return ask(access["watchdog_url"], "GET", "/incident", access["token"])

    status, answer, duration = ask(
        access["watchdog_url"], "POST", "/stop", access["viewer_token"]
    )
    found, first, _ = incident()
    outcome = station.command("stop", "--reason", "smoke")

    assert (status, answer["state"], answer["carried_out"]) == (200, "stopped", False)
    assert duration < SOON + LOAD
    assert found == 200
    assert first["last_published"]["robot_mode"]
    assert "stood still" in station.errors
    files = sorted((tmp_path / "station" / "incidents").glob("*.json"))
    assert json.loads(files[-1].read_text())["station_pid"] == station.process.pid
    assert outcome.returncode == 0, outcome.stderr
    assert "through the watchdog" in outcome.stdout
    stacks = wait_until(lambda: incident()[1]["stacks"])
    assert any("hung_controllers.py" in line for line in stacks)


@pytest.mark.long
def test_a_loop_that_comes_back_sees_the_stop_before_it_writes(start):
    station = start("DeepController", seconds=2.0, after=0.2)
    access = station.access()
    assert wait_until(lambda: watchdog_ready(access))
    start_hung(station, access)
    ask(access["watchdog_url"], "POST", "/stop", access["token"], '{"reason": "smoke"}')
    assert wait_until(lambda: watchdog_ready(access))

    _, stop, _ = ask(access["url"], "GET", "/api/v1/stop", access["token"])
    _, joints, _ = ask(access["url"], "GET", "/api/v1/joint_states", access["token"])
    incident = ask(access["watchdog_url"], "GET", "/incident", access["token"])[1]

    assert stop["state"] == "stopped"
    assert "smoke" in stop["reason"]
    assert joints["position"] == [0.0]
    assert incident["recovered_after"] == pytest.approx(2.0, abs=1.0)


@pytest.mark.long
def test_a_standstill_makes_a_real_arm_hold_and_latches_the_stop(start, tmp_path):
    station = start("DeepController", robot=watched_hw.TYPE, seconds=1.0, after=0.2)
    access = station.access()
    assert wait_until(lambda: watchdog_ready(access))
    start_hung(station, access)

    assert wait_until((tmp_path / "held").exists)
    assert wait_until(lambda: watchdog_ready(access))
    _, stop, _ = ask(access["url"], "GET", "/api/v1/stop", access["token"])
    incident = ask(access["watchdog_url"], "GET", "/incident", access["token"])[1]

    assert stop["state"] == "stopped"
    outcomes = [one["outcome"] for one in incident["hold_commands"]]
    assert "ended with exit code 0" in outcomes
    assert any("could not be started" in outcome for outcome in outcomes)


@pytest.mark.long
@pytest.mark.parametrize(
    ("kind", "code"), [("EndlessController", 3), ("LockedController", -signal.SIGKILL)]
)
def test_a_station_that_does_not_come_back_is_ended(start, kind, code):
    station = start(kind, end_after=1.0)
    access = station.access()
    assert wait_until(lambda: watchdog_ready(access))
    start_hung(station, access)

    station.process.wait(30.0)

    assert station.process.returncode == code
    assert "the watchdog ends the station" in station.errors
    assert "Traceback" not in station.errors


@pytest.mark.slow
def test_a_small_watchdog_carries_a_stop_out_and_ends_with_a_killed_station(start):
    station = start()
    access = station.access()
    assert wait_until(lambda: watchdog_ready(access))
    watchdog = station.child("watchdog")
    lines = Path(f"/proc/{watchdog}/status").read_text().splitlines()

    resident = next(line.split()[1] for line in lines if line.startswith("VmRSS"))
    status, answer, _ = ask(access["watchdog_url"], "POST", "/stop", access["token"])
    _, stop, _ = ask(access["url"], "GET", "/api/v1/stop", access["token"])
    station.end(signal.SIGKILL)

    assert int(resident) < 25_000  # kB
    assert (status, answer["carried_out"]) == (200, True)
    assert stop["state"] == "stopped"
    assert wait_for_end(watchdog, 5.0)


@pytest.mark.long
def test_a_watchdog_that_dies_is_started_again_and_an_orderly_end_leaves_nothing(
    start, tmp_path
):
    station = start()
    access = station.access()
    assert wait_until(lambda: watchdog_ready(access))
    watchdog = station.child("watchdog")

    os.kill(watchdog, signal.SIGKILL)
    assert wait_until(lambda: not is_alive(watchdog))
    assert wait_until(lambda: watchdog_ready(access))
    following = station.child("watchdog")
    duration = station.end(signal.SIGINT)

    assert "The watchdog ended (exit code -9). It is started again." in station.errors
    assert following != watchdog
    assert station.process.returncode == 0, station.errors
    assert duration < END
    assert not is_alive(following)
    assert [p.name for p in (tmp_path / "station").iterdir() if p.is_file()] == []


@pytest.mark.long
def test_a_stop_takes_effect_at_the_smallest_real_time_factor_and_in_a_pause(tmp_path):
    station = StationProcess(tmp_path, "--no-ui", "--real-time-factor", "0.01")

    def stop(client):
        state = client.stop("test")
        return state.state, state.pending, client.status().stop_state

    try:
        access = station.access()
        with StationClient(access["url"], access["token"]) as client:
            running = stop(client)
            client.release_stop()
            client.simulation.pause()
            paused = stop(client)
            client.simulation.set_real_time_factor(1.0)
    finally:
        station.clean_up()

    # The answer comes after the loop has carried the stop out, or after 0.1 s.
    assert running == paused == ("stopped", False, "stopped")


@pytest.mark.long
def test_a_start_that_hangs_says_what_it_waits_for_and_can_be_interrupted(start):
    station = start("NeverLoadedController")

    assert wait_until(lambda: "Loading the controller 'hung'" in station.errors)
    duration = station.end(signal.SIGINT)

    assert "The station still starts" in station.errors
    assert station.process.returncode == 0, station.errors
    assert duration < END
    assert "Traceback" not in station.errors
