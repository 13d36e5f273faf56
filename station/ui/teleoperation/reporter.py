"""Show failures of widget callbacks on the screen and in the log."""

import logging
from collections.abc import Awaitable, Callable, Coroutine
from typing import Any, TypeVar

import viser
from pydantic import ValidationError

from station.client import ApiError

_logger = logging.getLogger(__name__)

_Handle = TypeVar("_Handle")
Event = viser.GuiEvent[_Handle]

_MESSAGE_LIFETIME = 20.0
_NOTIFICATION_SECONDS = 12.0


class Reporter:
    """Shows a refusal to its caller, and the last refusal in the status bar.

    Args:
        now: Monotonic clock [s].
    """

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now
        self._message = ""
        self._said_at = float("-inf")

    @property
    def message(self) -> str:
        """The last refusal or failure while it is recent, otherwise an empty text."""
        fresh = self._now() - self._said_at < _MESSAGE_LIFETIME
        return self._message if fresh else ""

    def guarded(
        self, callback: Callable[[Event[Any]], Awaitable[None]]
    ) -> Callable[[Event[Any]], Coroutine[None, None, None]]:
        """Return a callback that reports every exception of `callback`.

        The callback is called only for the actions of a person. Viser calls callbacks
        as well when the dashboard itself sets the value of a widget.
        """

        async def run(event: Event[Any]) -> None:
            if event.client is None:
                return
            try:
                await callback(event)
            except ApiError as error:
                self.refused(error, event.client)
            except ValidationError as error:
                first = error.errors()[0]
                place = ".".join([error.title, *(str(part) for part in first["loc"])])
                self.say("Not valid", f"{place}: {first['msg']}.", event.client)
            except Exception as error:  # the boundary of UI callbacks
                _logger.exception("a dashboard callback failed")
                text = f"{type(error).__name__}: {error}"
                self.say("The dashboard failed", text, event.client)

        return run

    def refused(self, error: ApiError, client: viser.ClientHandle | None) -> None:
        """Show a refusal of the station in the words of the station."""
        lines = [error.detail, error.remedy]
        lines += [f"{e.field}: {e.message}" for e in error.errors[:3]]
        self.say(error.code, " ".join(line for line in lines if line), client)

    def say(self, title: str, text: str, client: viser.ClientHandle | None) -> None:
        """Show a message to one browser, and to all in the status bar."""
        _logger.info("%s: %s", title, text)
        self._message = f"{title}: {text}"
        self._said_at = self._now()
        if client is not None:
            client.add_notification(
                title, text, color="red", auto_close_seconds=_NOTIFICATION_SECONDS
            )
