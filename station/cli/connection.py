"""Which station a verb talks to, and with which token."""

import os
from argparse import Namespace
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from station.app.runtime_file import RunningStation, find_running
from station.cli.errors import NoStationError, UsageError

if TYPE_CHECKING:
    from station.client import StationClient

_START_ONE = "Start one with `station run`, or name another machine's with --url."


def open_client(options: Namespace) -> "StationClient":
    """Return a client for the station that the options, or the machine, name.

    Raises:
        NoStationError: No station was found, or more than one.
        UsageError: The URL is not that of a web server.
    """
    from station.client import StationClient

    url, token = locate(options.url, options.token)
    return StationClient(url, token)


def locate(url: str | None, token: str | None) -> tuple[str, str | None]:
    """Return URL and token of the station to talk to.

    Options come first, then `STATION_URL` and `STATION_TOKEN`, then the runtime file
    of a station on this machine.

    Raises:
        NoStationError: No station was found, or more than one.
        UsageError: The URL is not that of a web server.
    """
    url = url or os.environ.get("STATION_URL")
    token = token or os.environ.get("STATION_TOKEN")
    if url is None:
        found = _only(find_running())
        return found.url, token or found.token
    address = urlsplit(url)
    if address.scheme not in {"http", "https"} or not address.hostname:
        raise UsageError(
            f"{url!r} is not the URL of a station.",
            remedy="Write it like http://127.0.0.1:8000.",
        )
    if token is None:
        netlocs = {urlsplit(s.url).netloc: s.token for s in find_running()}
        token = netlocs.get(address.netloc.replace("localhost", "127.0.0.1"))
    return url, token


def watchdog_of(url: str) -> str:
    """Return where the watchdog of a station on this machine answers; empty if none."""
    wanted = urlsplit(url).netloc.replace("localhost", "127.0.0.1")
    found = {urlsplit(s.url).netloc: s.watchdog_url for s in find_running()}
    return found.get(wanted, "")


def _only(stations: list[RunningStation]) -> RunningStation:
    """Return the one station.

    Raises:
        NoStationError: There is no station, or more than one.
    """
    if not stations:
        raise NoStationError("No station runs on this machine.", remedy=_START_ONE)
    if len(stations) > 1:
        urls = ", ".join(station.url for station in stations)
        raise NoStationError(
            f"{len(stations)} stations run on this machine: {urls}.",
            remedy=f"Choose one: --url {stations[-1].url}.",
        )
    return stations[0]
