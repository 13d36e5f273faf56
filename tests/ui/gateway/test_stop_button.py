"""The gateway's stop button reaches the station, or its watchdog."""

import asyncio

import pytest
from starlette.applications import Starlette
from starlette.responses import JSONResponse
from starlette.routing import Route

from station.client import AsyncStationClient, StationUnreachableError
from station.ui.gateway.gateway import StopButton
from station.wire import StopState
from tests.ui.served import Served

NOBODY = "http://127.0.0.1:9"


class FakeApi:
    """A station that answers a stop as it is told to."""

    url = NOBODY

    def __init__(self, *, pending=False, hangs=False):
        self._pending, self._hangs = pending, hangs

    async def stop(self, _):
        if self._hangs:
            await asyncio.sleep(600.0)
        return StopState(state="stopped", reason="", epoch=7, pending=self._pending)


@pytest.fixture
def watchdog():
    """Return a served watchdog that keeps the tokens it was shown."""
    tokens = []

    async def stop(request):
        tokens.append(request.headers["authorization"])
        return JSONResponse({"state": "stopped", "carried_out": False, "detail": "Ok."})

    with Served(Starlette(routes=[Route("/stop", stop, methods=["POST"])])) as served:
        served.tokens = tokens
        yield served


def press(api, url):
    return asyncio.run(StopButton(api, "secret", url).press())


def test_a_station_that_answers_is_believed(watchdog):
    assert press(FakeApi(), watchdog.url).epoch == 7
    assert watchdog.tokens == []


@pytest.mark.parametrize("trouble", [{"hangs": True}, {"pending": True}])
def test_a_station_that_hangs_is_stopped_through_the_watchdog(watchdog, trouble):
    state = press(FakeApi(**trouble), watchdog.url)

    assert (state.state, state.pending, state.reason) == ("stopped", True, "Ok.")
    assert watchdog.tokens == ["Bearer secret"]


def test_a_station_that_is_gone_is_stopped_through_the_watchdog(watchdog):
    async def run():
        async with AsyncStationClient(NOBODY, "secret") as api:
            button = StopButton(api, "old", NOBODY)
            button.move_to("new", watchdog.url)
            return await button.press()

    assert asyncio.run(run()).state == "stopped"
    assert watchdog.tokens == ["Bearer new"]


def test_an_unconfirmed_stop_is_an_error():
    with pytest.raises(StationUnreachableError):
        press(FakeApi(hangs=True), NOBODY)


def test_without_a_watchdog_the_stations_answer_counts():
    assert press(FakeApi(pending=True), "").pending
