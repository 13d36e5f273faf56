"""A stepped station of one joint and its recorder, in a folder of the test."""

import pytest

from station.records.record_store import Quota, RecordStore
from station.records.recorder import Recorder
from tests.api.spring import make_station


@pytest.fixture
def station():
    """Return a station that has run no cycle."""
    return make_station()


@pytest.fixture
def store(tmp_path):
    """Return the store of the recordings."""
    return RecordStore(tmp_path / "recordings")


@pytest.fixture
def incidents(tmp_path):
    """Return the store of the incidents."""
    return RecordStore(tmp_path / "incidents", Quota(count=3))


@pytest.fixture
def recorder(station, store, incidents):
    """Return a recorder without a thread; tests drain by themselves."""
    recorder = Recorder(station, store, incidents, wall_time=lambda: 10**18)
    yield recorder
    recorder.close()
