"""A served station of one joint."""

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.spring import make_station
from tests.certificates import make_certificate


@pytest.fixture
def station():
    """Return a station that has run one cycle."""
    station = make_station()
    station.loop.step()
    return station


@pytest.fixture
def served(station):
    """Serve the station on a free port."""
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with ApiServer(app, port=0) as server:
        yield server


@pytest.fixture
def tls(tmp_path):
    """Return a certificate for this machine, and its key."""
    return make_certificate(tmp_path)


@pytest.fixture
def encrypted(station, tls):
    """Serve the station with TLS."""
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with ApiServer(app, port=0, tls=tls) as server:
        yield server
