"""A goal that was given to a controller: wait for its end, or cancel it."""

import asyncio
import time
from typing import TYPE_CHECKING

from station.client.errors import MotionError
from station.wire import Goal

if TYPE_CHECKING:
    from station.client._async.station_client import AsyncStationClient

POLL = 0.05
"""How often a goal is looked at [s]."""
_FINAL = {"succeeded", "aborted", "preempted"}


class AsyncGoalHandle:
    """A goal of a controller: `station.start_goal(…)`, `station.start_move(…)`.

    Args:
        client: The client that gave the goal.
        controller: The controller that has it.
        latest: The answer to it.

    Attributes:
        controller: The controller that has the goal.
        latest: How far it was when it was last looked at.
    """

    def __init__(
        self, client: "AsyncStationClient", controller: str, latest: Goal
    ) -> None:
        self._client = client
        self.controller = controller
        self.latest = latest

    @property
    def is_final(self) -> bool:
        """Whether the goal had ended when it was last looked at."""
        return self.latest.status in _FINAL

    async def refresh(self) -> Goal:
        """Return how far the goal is."""
        self.latest = await self._client.goal(self.controller, self.latest.id)
        return self.latest

    async def cancel(self) -> None:
        """Cancel the goal; the joints hold from the next cycle on."""
        await self._client.cancel_goal(self.controller, self.latest.id)

    async def ended(self, timeout: float | None = None) -> Goal:
        """Wait until the goal has ended, however, and return it.

        Args:
            timeout: Longest wait [s]; None waits for ever. The goal goes on after it.

        Raises:
            MotionError: It did not end in time.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self.is_final:
            if deadline is not None and time.monotonic() > deadline:
                raise MotionError(
                    f"The goal of '{self.controller}' did not end within {timeout} s.",
                    "Wait longer, or cancel the goal.",
                )
            await asyncio.sleep(POLL)
            await self.refresh()
        return self.latest

    async def wait(self, timeout: float | None = None) -> Goal:
        """Wait until the goal has succeeded and return it.

        Args:
            timeout: Longest wait [s]; None waits for ever. The goal goes on after it.

        Raises:
            MotionError: It was aborted or preempted, or did not end in time.
        """
        goal = await self.ended(timeout)
        if goal.status != "succeeded":
            why = goal.result.message if goal.result else ""
            raise MotionError(
                f"The goal of '{self.controller}' was {goal.status}. {why}".rstrip(),
                "See GET /status for a stop and /robots for errors of the arm.",
            )
        return goal
