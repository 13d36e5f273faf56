"""Nothing but this machine reaches a station without a token of the user's."""

import socket

import pytest

from station.app.addresses import (
    Announcement,
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


ANNOUNCEMENT = Announcement(
    api_url="http://127.0.0.1:8000",
    ui_url="http://127.0.0.1:8080",
    token="a+b/c",
    runtime_file="/run/station/1.json",
    scheduler="SCHED_FIFO 50",
    robot="REAL ARM 172.16.0.2",
    kernel="interpreted: There is no compiled kernel.",
)


def test_api_and_token_have_a_line_each():
    api, token, robot, _ = ANNOUNCEMENT.lines()

    assert "http://127.0.0.1:8000/docs" in api
    assert "a+b/c" in token
    assert "/run/station/1.json" in token
    assert robot.split(maxsplit=1) == ["Robot", "REAL ARM 172.16.0.2"]


def test_user_is_told_which_kernel_runs_and_why():
    *_, kernel = ANNOUNCEMENT.lines()

    assert kernel.split(maxsplit=1) == ["Cycle", ANNOUNCEMENT.kernel]
    assert ANNOUNCEMENT.as_json()["kernel"] == ANNOUNCEMENT.kernel


def test_dashboard_address_logs_in():
    line = ANNOUNCEMENT.dashboard_line()

    assert "http://127.0.0.1:8080/login?token=a%2Bb%2Fc" in line


def test_json_has_no_token():
    assert "a+b/c" not in str(ANNOUNCEMENT.as_json())
    assert ANNOUNCEMENT.as_json()["api_url"] == "http://127.0.0.1:8000"
