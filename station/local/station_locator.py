"""Find the station that a program means, and the token for it."""

import os
from urllib.parse import urlsplit

from station.core.errors import StationError
from station.local.runtime_file import RunningStation, find_running


class NoStationError(StationError, LookupError):
    """No running station was found, or more than one."""

    code = "no_station"


class StationAddressError(StationError, ValueError):
    """The address of a station is not that of a web server."""

    code = "usage"


def locate(url: str | None, token: str | None) -> tuple[str, str | None]:
    """Return URL and token of the station to talk to.

    Arguments come first, then `STATION_URL` and `STATION_TOKEN`, then the runtime file
    of a station on this machine.

    Args:
        url: The station; None finds it.
        token: Its operator or viewer token; None finds it.

    Raises:
        NoStationError: No station was found, or more than one.
        StationAddressError: The URL is not that of a web server.
    """
    url = url or os.environ.get("STATION_URL")
    token = token or os.environ.get("STATION_TOKEN")
    if url is None:
        found = _only(find_running())
        return found.url, token or found.token
    address = urlsplit(url)
    if address.scheme not in {"http", "https"} or not address.hostname:
        raise StationAddressError(
            f"{url!r} is not the URL of a station.",
            remedy="Write it like http://127.0.0.1:8000.",
        )
    if token is None:
        netlocs = {urlsplit(s.url).netloc: s.token for s in find_running()}
        token = netlocs.get(_netloc(url))
    return url, token


def watchdog_of(url: str) -> str:
    """Return where the watchdog of a station on this machine answers; empty if none."""
    found = {urlsplit(s.url).netloc: s.watchdog_url for s in find_running()}
    return found.get(_netloc(url), "")


def certificate_of(url: str) -> str:
    """Return the certificate's file of a station on this machine; empty if none."""
    found = {urlsplit(s.url).netloc: s.certificate for s in find_running()}
    return found.get(_netloc(url), "")


def viewer_token_of(url: str) -> str:
    """Return the viewer's token of a station on this machine; empty if unknown."""
    found = {urlsplit(s.url).netloc: s.viewer_token for s in find_running()}
    return found.get(_netloc(url), "")


def _netloc(url: str) -> str:
    return urlsplit(url).netloc.replace("localhost", "127.0.0.1")


def _only(stations: list[RunningStation]) -> RunningStation:
    """Return the one station.

    Raises:
        NoStationError: There is no station, or more than one.
    """
    if not stations:
        raise NoStationError(
            "No station runs on this machine.",
            remedy="Start one with `station run`, or give the URL of another one.",
        )
    if len(stations) > 1:
        urls = ", ".join(station.url for station in stations)
        raise NoStationError(
            f"{len(stations)} stations run on this machine: {urls}.",
            remedy=f"Choose one by its URL, e.g. {stations[-1].url}.",
        )
    return stations[0]
