"""Requests about controllers: patience, keys, and goals that are waited for."""

import asyncio

import httpx
import pytest

from station.client import AsyncStationClient, MotionError, controllers
from station.client.errors import StationUnreachableError
from station.wire import Goal, GoalResult
from station.wire.controllers import LOAD_TIMEOUT
from station.wire.protocol import KEY_HEADER


def goal(status: str, message: str = "") -> Goal:
    result = GoalResult(code=0, message=message, details={}) if message else None
    return Goal(
        id="7", status=status, progress=0.0, cancel_requested=False, result=result
    )


class FakeStation(AsyncStationClient):
    """A station with a list of answers."""

    def __init__(self, *answers):
        super().__init__("http://a", "t")
        self.answers = list(answers)
        self.cancelled = []

    async def submit_goal(self, name, goal, epoch=None, certificate=None):
        """Take the goal."""
        return self.answers.pop(0)

    async def goal(self, name, goal_id):
        """Return the next answer, the last one for ever."""
        return self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]

    async def cancel_goal(self, name, goal_id):
        """Keep what was cancelled."""
        self.cancelled.append((name, goal_id))


@pytest.fixture(autouse=True)
def clock(monkeypatch):
    """Let waiting pass time at once."""
    now = [100.0]

    async def sleep(seconds):
        now[0] += seconds

    monkeypatch.setattr(asyncio, "sleep", sleep)
    monkeypatch.setattr(controllers.time, "monotonic", lambda: now[0])


async def given(*answers):
    station = FakeStation(*answers)
    return station, await station.start_goal("arm", {})


def test_waiting_ends_with_the_goal():
    async def run():
        _, handle = await given(goal("pending"), goal("active"), goal("succeeded"))
        assert not handle.is_final
        return await handle.wait()

    assert asyncio.run(run()).status == "succeeded"


def test_goal_that_does_not_succeed_is_an_error_with_the_reason():
    async def run():
        _, handle = await given(goal("pending"), goal("aborted", "Joint 'a' is off."))
        await handle.wait()

    with pytest.raises(MotionError, match=r"'arm' was aborted\. Joint 'a' is off\."):
        asyncio.run(run())


def test_waiting_can_be_bounded_and_the_goal_cancelled():
    async def run():
        station, handle = await given(goal("pending"), goal("active"))
        with pytest.raises(MotionError, match="did not end within 2 s"):
            await handle.wait(2)
        await handle.cancel()
        return station.cancelled

    assert asyncio.run(run()) == [("arm", "7")]


class Refusing(httpx.AsyncBaseTransport):
    """Keeps each request and answers that nothing is there."""

    def __init__(self):
        self.requests = []

    async def handle_async_request(self, request):
        self.requests.append(request)
        raise httpx.ConnectError("nobody is there")


def asked(change, *arguments, **options):
    """Return the request that a method of the client sends."""
    transport = Refusing()

    async def run():
        client = AsyncStationClient("http://a", "t", transport=transport)
        await getattr(client, change)(*arguments, **options)

    with pytest.raises(StationUnreachableError, match="nobody is there"):
        asyncio.run(run())
    return transport.requests[0]


@pytest.mark.parametrize(
    ("change", "arguments", "options", "patience"),
    [
        ("load_controller", "a", {}, LOAD_TIMEOUT),
        ("load_controller", "a", {"timeout": 5.0}, 5.0),
        ("unload_controller", "a", {}, 0.0),
        ("switch_controllers", "", {"start": ["a"], "bound": 7.0}, 7.0),
        ("switch_controllers", "", {"start": ["a"], "timeout": 3.0}, 3.0),
        ("switch_controllers", "", {"start": ["a"], "bound": None}, None),
    ],
)
def test_a_change_waits_as_long_as_it_may_take(change, arguments, options, patience):
    request = asked(change, *arguments, **options)

    expected = None if patience is None else 10.0 + patience
    assert request.extensions["timeout"]["read"] == expected
    assert KEY_HEADER not in request.headers


@pytest.mark.parametrize(
    ("change", "arguments", "options"),
    [
        ("load_controller", "a", {}),
        ("unload_controller", "a", {}),
        ("switch_controllers", "", {"start": ["a"]}),
    ],
)
def test_a_key_goes_with_the_request(change, arguments, options):
    request = asked(change, *arguments, **options, idempotency_key="mine")

    assert request.headers[KEY_HEADER] == "mine"
