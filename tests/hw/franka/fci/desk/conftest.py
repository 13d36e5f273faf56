"""A Desk that is served over TLS, and clients of both of its interfaces."""

import pytest

from station.hw.franka.fci.desk.desk_server import DeskServer
from tests.hw.franka.fci.desk.desk_bench import client_of, new_desk


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Where the certificate is kept, which takes a while to make."""
    return tmp_path_factory.mktemp("desk")


@pytest.fixture
def desk():
    return new_desk()


@pytest.fixture
def url(desk, folder):
    """The address of the served Desk."""
    server = DeskServer(desk, "127.0.0.1", 0, folder)
    yield f"https://127.0.0.1:{server.port}"
    server.close()


@pytest.fixture
def client(url):
    """A client of the present interface."""
    with client_of(url) as made:
        yield made


@pytest.fixture
def stranger(url):
    """A client that has not logged in."""
    with client_of(url, auth=None) as made:
        yield made


@pytest.fixture
def old(stranger):
    """A client of the old interface, which keeps the cookie of its login."""
    login = {"login": "ada", "password": "MTIz\n"}
    token = stranger.post("/admin/api/login", json=login).text
    stranger.cookies.set("authorization", token)
    return stranger
