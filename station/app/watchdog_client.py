"""Ask a watchdog for a stop, without a package that may be missing or broken."""

import json
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPException
from urllib.parse import urlsplit

from station.core.errors import StationError

TIMEOUT = 2.0
"""Longest wait for the watchdog [s]."""


class WatchdogError(StationError, ConnectionError):
    """The watchdog does not answer, or refuses the request."""

    code = "watchdog"


@dataclass(frozen=True, slots=True)
class WatchdogStop:
    """A stop that the watchdog has latched.

    Attributes:
        carried_out: Whether the control loop has already carried out the stop.
        detail: Explanation by the watchdog, for people.
    """

    carried_out: bool
    detail: str


def stop_through_watchdog(url: str, token: str, reason: str) -> WatchdogStop:
    """Latch a stop for the control loop, and make real arms hold.

    Args:
        url: URL of the watchdog.
        token: A token of the station, with any role.
        reason: Reason of the stop, for people.

    Raises:
        WatchdogError: The watchdog does not answer, or refuses the token.
    """
    connection = HTTPConnection(urlsplit(url).netloc, timeout=TIMEOUT)
    try:
        connection.request(
            "POST",
            "/stop",
            body=json.dumps({"reason": reason}),
            headers={"Authorization": f"Bearer {token}"},
        )
        answer = connection.getresponse()
        told = json.loads(answer.read())
    # A ValueError means that another program has the port and does not answer in JSON.
    except (OSError, HTTPException, ValueError) as error:
        raise WatchdogError(
            f"The watchdog at {url} does not answer: {error}.",
            remedy="Use the emergency stop of the robot.",
        ) from error
    finally:
        connection.close()
    if answer.status != 200:
        raise WatchdogError(
            f"The watchdog at {url} refuses: {told.get('detail')}",
            remedy="Give a token of the station: --token, or STATION_TOKEN.",
        )
    return WatchdogStop(told["carried_out"], told["detail"])
