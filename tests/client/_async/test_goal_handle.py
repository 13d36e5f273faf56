"""A goal is waited for, and its end is told."""

import asyncio

import pytest

from station.client import AsyncStationClient, MotionError
from station.client._async import goal_handle
from station.wire import Goal, GoalResult


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

    async def submit_goal(self, name, goal, epoch=None):
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

    monkeypatch.setattr(goal_handle.asyncio, "sleep", sleep)
    monkeypatch.setattr(goal_handle.time, "monotonic", lambda: now[0])


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
