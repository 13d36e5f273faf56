"""Nothing but this machine reaches a station without a token of the user's."""

import socket

import pytest

from station.app.addresses import (
    ExposedHostError,
    check_exposure,
    host_names,
    is_loopback,
)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.1.2.3", "::1", "localhost"])
def test_loopback_needs_no_token(host):
    assert is_loopback(host)
    assert host_names(host) == []
    check_exposure(host, None)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.2", "robot.local"])
def test_other_hosts_need_a_token(host):
    with pytest.raises(ExposedHostError, match=host.replace(".", r"\.")) as caught:
        check_exposure(host, None)

    assert "--token" in caught.value.remedy
    check_exposure(host, "a token")


def test_exposed_station_is_called_by_its_names():
    assert socket.gethostname() in host_names("0.0.0.0")
