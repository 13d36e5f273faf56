"""A fake station and a dashboard's gateway in front of nothing."""

import pytest

from tests.ui.fake_station import FakeStation


@pytest.fixture
def fake_station():
    with FakeStation() as station:
        yield station
