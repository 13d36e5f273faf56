"""Host and Origin headers that the gateway answers."""

import pytest

from station.ui.gateway.guard import origin_policy


@pytest.mark.parametrize(
    "host", ["127.0.0.1:8080", "localhost:8080", "localhost", "[::1]:8080"]
)
def test_loopback_names_are_answered(host):
    assert origin_policy("127.0.0.1").allows_host(host)


@pytest.mark.parametrize("host", ["evil.example:8080", "192.168.0.7", "", "[::2]"])
def test_other_names_are_not_answered_on_loopback(host):
    assert not origin_policy("127.0.0.1").allows_host(host)


def test_addresses_are_answered_when_listening_everywhere_but_names_are_not():
    policy = origin_policy("0.0.0.0", extra_names=["Robot-Lab"])
    assert policy.allows_host("192.168.0.7:8080")
    assert policy.allows_host("robot-lab:8080")
    assert not policy.allows_host("evil.example:8080")


@pytest.mark.parametrize(
    ("origin", "allowed"),
    [
        ("http://127.0.0.1:8080", True),
        ("https://127.0.0.1:8080", True),
        ("http://127.0.0.1:8081", False),
        ("http://evil.example", False),
        ("null", False),
        ("file://127.0.0.1:8080", False),
        (None, False),
    ],
)
def test_only_the_servers_own_pages_may_act(origin, allowed):
    policy = origin_policy("127.0.0.1")
    assert policy.allows_origin(origin, "127.0.0.1:8080") is allowed
