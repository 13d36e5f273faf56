"""Two stations of one user, side by side in the same folders, each recording."""

import signal

import numpy as np
import pytest

from station.client import ApiError, StationClient
from station.records.mcap_recovery import recover_file
from station.records.recording_reader import read_trajectory
from tests.system.station_process import PATIENCE, StationProcess
from tests.waiting import wait_until

pytestmark = pytest.mark.long


@pytest.fixture
def start(tmp_path):
    """Return what starts a station; all have the same folders."""
    stations, clients = [], []
    shared = {"XDG_RUNTIME_DIR": str(tmp_path), "XDG_DATA_HOME": str(tmp_path / "data")}

    def start(name):
        folder = tmp_path / name
        folder.mkdir()
        station = StationProcess(folder, "--no-ui", environment=shared)
        stations.append(station)
        access = station.access()
        client = StationClient(access["url"], access["token"])
        clients.append(client)
        return station, client

    yield start
    for client in clients:
        client.close()
    for station in stations:
        station.clean_up()


def _wait(what, condition):
    assert wait_until(condition, PATIENCE), f"{what} does not come"


def test_one_is_killed_and_started_again_and_both_files_are_whole(start, tmp_path):
    first, one = start("first")
    mine = one.recordings.start("mine").identifier
    second, other = start("second")
    # It has looked at the folder, and left alone what is being recorded.
    theirs = other.recordings.start("theirs").identifier
    states = {r.identifier: r.state for r in other.recordings.list()}
    assert states == {mine: "recording", theirs: "recording"}
    with pytest.raises(ApiError, match="is being recorded"):
        other.recordings.delete(mine)
    for client, name in ((one, mine), (other, theirs)):
        _wait("a second", lambda c=client, n=name: c.recordings.get(n).cycles > 1000)

    first.end(signal.SIGKILL)
    _, again = start("again")
    _wait("recovery", lambda: again.recordings.get(mine).state == "recovered")
    assert other.recordings.get(theirs).state == "recording"
    cycles = other.recordings.get(theirs).cycles
    _wait("more", lambda: other.recordings.get(theirs).cycles > cycles + 100)
    stopped = other.recordings.stop()

    folder = tmp_path / "data" / "control-station" / "recordings"
    assert folder.stat().st_mode & 0o777 == 0o700
    recovered = again.recordings.get(mine)
    assert recovered.cycles > 1000
    assert "Recording" in start_text(tmp_path, "again")
    assert "is recovered" in start_text(tmp_path, "again")
    assert "Recording" not in second.errors
    for info in (recovered, stopped):
        path = folder / f"{info.identifier}.mcap"
        found = read_trajectory(path)
        assert not recover_file(path).is_changed
        assert len(found.cycle) == info.cycles
        assert found.cycle[0] == info.first_cycle
        assert np.sum(np.diff(found.cycle) - 1) == info.lost


def start_text(tmp_path, name):
    return (tmp_path / name / "stderr").read_text()
