"""Which hosts and origins are allowed."""

import pytest

from station.web.host_policy import HostPolicy


@pytest.mark.parametrize(
    ("host", "allowed"),
    [
        ("localhost", True),
        ("localhost:8000", True),
        ("LocalHost:8000", True),
        ("127.0.0.1:8000", True),
        ("192.168.1.7", True),
        ("[::1]:8000", True),
        ("robot.lab:8000", True),
        ("evil.example:8000", False),
        ("localhost.evil.example", False),
        ("127.0.0.1.evil.example", False),
        ("user@localhost", False),
        ("localhost:8000@evil.example", False),
        ("localhost:", False),
        ("", False),
        (None, False),
    ],
)
def test_hosts(host, allowed):
    assert HostPolicy(hosts=["Robot.lab"]).allows_host(host) is allowed


@pytest.mark.parametrize(
    ("origin", "allowed"),
    [
        (None, True),
        ("http://localhost:8000", True),
        ("https://localhost:8000", True),
        ("HTTP://LOCALHOST:8000", True),
        ("http://dash.lab", True),
        ("http://localhost:9999", False),
        ("http://localhost", False),
        ("http://evil.example", False),
        ("http://localhost:8000.evil.example", False),
        ("file://", False),
        ("null", False),
        ("http://[::1", False),
        ("http://[x]", False),
        ("", False),
    ],
)
def test_origins(origin, allowed):
    policy = HostPolicy(origins=["http://dash.lab/"])

    assert policy.allows_origin(origin, "localhost:8000") is allowed


def test_an_origin_without_host_is_never_ones_own():
    assert not HostPolicy().allows_origin("http://", None)
