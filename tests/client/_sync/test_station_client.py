"""The synchronous client; its methods are tested with the routes."""

import httpx
import pytest

from station.client import (
    ApiError,
    StationClient,
    StationUnreachableError,
)
from station.reports import examples_of
from station.wire import SwitchResult
from tests.api.conftest import OPERATOR


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
        (example,) = examples_of(SwitchResult.__doc__)
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


def test_requests_and_streams_are_encrypted_for_whoever_trusts_the_station(
    encrypted, tls
):
    with StationClient(encrypted.url, OPERATOR, ca=str(tls.certificate)) as client:
        client.load_controller("spring", "test/Spring", {"joint": "j"})
        client.switch_controllers(start=["spring"])
        with client.stream("joint_states") as stream:
            assert stream.progress.connected
        with client.command_stream("spring") as commands:
            commands.send([0.5])
        assert "running: spring" in client._repr_html_()


def test_a_station_that_is_not_trusted_is_told_nothing(encrypted, monkeypatch):
    monkeypatch.delenv("STATION_CA", raising=False)
    with StationClient(encrypted.url, OPERATOR) as client:
        with pytest.raises(StationUnreachableError, match="CERTIFICATE_VERIFY") as no:
            client.session()
        with pytest.raises(StationUnreachableError), client.stream("loop"):
            pass
    assert "--ca" in no.value.remedy


def test_a_key_of_a_request_reaches_the_station(served):
    with StationClient(served.url, OPERATOR) as client:
        client.load_controller("spring", "test/Spring", {"joint": "j"})
        for _ in range(2):
            state = client.unload_controller("spring", idempotency_key="once")
            assert state.name == "spring"
        assert client.controllers() == []
