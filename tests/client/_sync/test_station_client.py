"""The synchronous client; its methods are tested with the routes."""

import httpx
import pytest

from station.client import (
    ApiError,
    StationClient,
    StationUnreachableError,
)
from station.wire import SwitchResult


def test_nobody_there_is_said_plainly():
    with (
        StationClient("http://127.0.0.1:9", timeout=1.0) as client,
        pytest.raises(StationUnreachableError, match=r"127\.0\.0\.1:9"),
    ):
        client.health()


def test_a_silent_server_is_given_up():
    def wait(request):
        raise httpx.ReadTimeout("timed out", request=request)

    with (
        StationClient("http://a", "t", transport=httpx.MockTransport(wait)) as client,
        pytest.raises(StationUnreachableError, match="timed out"),
    ):
        client.status()


def test_a_switch_waits_for_its_own_timeout_too():
    seen = []

    def answer(request):
        seen.append(request.extensions["timeout"]["read"])
        (example,) = SwitchResult.model_config["json_schema_extra"]["examples"]
        return httpx.Response(200, json=example)

    with StationClient(
        "http://a", "t", transport=httpx.MockTransport(answer), timeout=3.0
    ) as client:
        client.switch_controllers(start=["a"], timeout=5.0)
        client.switch_controllers(start=["a"])
        client.switch_controllers(start=["a"], bound=20.0)
        client.switch_controllers(start=["a"], bound=None)

    assert seen == [8.0, 8.0, 23.0, None]


def test_keys_of_a_newer_station_are_ignored():
    def answer(_):
        return httpx.Response(200, json={"status": "ok", "boot_id": "b", "new": 1})

    with StationClient(
        "http://a", "t", transport=httpx.MockTransport(answer)
    ) as client:
        assert client.health().boot_id == "b"


def test_proxies_of_the_environment_are_not_used(monkeypatch, served):
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    monkeypatch.setenv("ALL_PROXY", "http://127.0.0.1:9")

    with StationClient(served.url) as client:
        assert client.health().status == "ok"
        with pytest.raises(ApiError) as caught:
            client.status()
    assert caught.value.status == 401
