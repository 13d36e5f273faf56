"""Stop the robot for the button of the page: ask the station, then the watchdog."""

import asyncio

import httpx

from station.client import AsyncStationClient, StationUnreachableError
from station.wire import StopState

ANSWER_TIME = 0.5
"""Longest time for an answer of the station before the watchdog is asked [s]."""
_WATCHDOG_TIME = 2.0
_REASON = "stop button of the dashboard"


class StopButton:
    """Stops the robot, even if the station's interpreter hangs.

    Args:
        api: The station.
        token: Its token, which the watchdog accepts as well.
        watchdog_url: The listener of the station's watchdog; empty when there is none.
    """

    def __init__(self, api: AsyncStationClient, token: str, watchdog_url: str) -> None:
        self._api = api
        self._token = token
        self._watchdog_url = watchdog_url

    def move_to(self, token: str, watchdog_url: str) -> None:
        """Ask the watchdog of another station from now on."""
        self._token, self._watchdog_url = token, watchdog_url

    async def press(self) -> StopState:
        """Stop the robot.

        Raises:
            ApiError: Neither the station nor its watchdog confirms the stop.
        """
        if not self._watchdog_url:
            return await self._api.stop(_REASON)
        try:
            async with asyncio.timeout(ANSWER_TIME):
                state = await self._api.stop(_REASON)
        except (TimeoutError, StationUnreachableError) as error:
            return await self._ask_watchdog(error)
        if not state.pending:
            return state
        # The station answers, and its control loop does not: the watchdog tells a real
        # arm to hold.
        return await self._ask_watchdog(LookupError("the control loop does not answer"))

    async def _ask_watchdog(self, cause: Exception) -> StopState:
        """Latch the stop through the watchdog.

        Raises:
            StationUnreachableError: The watchdog does not answer either.
        """
        headers = {"Authorization": f"Bearer {self._token}"}
        try:
            async with httpx.AsyncClient(trust_env=False) as http:
                answer = await http.post(
                    f"{self._watchdog_url}/stop",
                    json={"reason": _REASON},
                    headers=headers,
                    timeout=_WATCHDOG_TIME,
                )
                answer.raise_for_status()
                report = answer.json()
        except httpx.HTTPError as error:
            raise StationUnreachableError(self._api.url, cause) from error
        return StopState(
            state="stopped",
            reason=report["detail"],
            epoch=0,  # only the station knows it
            pending=not report["carried_out"],
        )
