"""Find the stations of a user on this machine, each with its token.

One file per station, `<pid>.json`, in the user's runtime directory.
"""

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

from station.core.errors import StationError
from station.local.private_files import (
    check_private,
    is_alive,
    read_private,
    runtime_directory,
    write_private,
)


@dataclass(frozen=True, slots=True)
class RunningStation:
    """Addresses and tokens of a station that runs.

    Attributes:
        url: URL of the API.
        token: The operator's token.
        viewer_token: Token for watching only.
        ui_url: URL of the dashboard; empty without a dashboard.
        boot_id: Changes with every start.
        pid: Number of its process.
        started: When that process started, from `process_start`. It distinguishes the
            process from a later one with the same number. Empty if unknown.
        watchdog_url: URL of its watchdog; empty without a watchdog.
        certificate: File of the certificate with which it serves; empty without TLS.
    """

    url: str
    token: str
    viewer_token: str
    ui_url: str
    boot_id: str
    pid: int
    started: str
    watchdog_url: str = ""
    certificate: str = ""


def write_runtime_file(running: RunningStation) -> Path:
    """Write the runtime file of a station, which its user alone can read.

    Raises:
        RuntimeDirectoryError: The directory belongs to another user, or cannot be
            written.
    """
    return write_private(f"{running.pid}.json", running)


def find_running() -> list[RunningStation]:
    """Return the stations of this user that run, oldest first.

    Files whose process has ended are deleted; files of another kind are ignored.

    Raises:
        RuntimeDirectoryError: The directory belongs to another user.
    """
    directory = runtime_directory()
    if not directory.is_dir():
        return []
    check_private(directory)
    found: list[tuple[float, RunningStation]] = []
    for path in directory.glob("*.json"):
        running = read_private(path, RunningStation)
        if running is None:
            continue
        if is_alive(running.pid, running.started):
            # A station that ends meanwhile takes its file away.
            with suppress(FileNotFoundError):
                found.append((path.stat().st_mtime, running))
        else:
            path.unlink(missing_ok=True)
    return [running for _, running in sorted(found, key=lambda item: item[0])]


class NoStationError(StationError, LookupError):
    """No running station was found, or more than one."""

    code = "no_station"


class StationAddressError(StationError, ValueError):
    """The address of a station is not an http or https URL with a host."""

    code = "usage"


def locate(url: str | None, token: str | None) -> tuple[str, str | None]:
    """Return URL and token of the station to talk to.

    Arguments come first, then `STATION_URL` and `STATION_TOKEN`, then the runtime file
    of a station on this machine.

    Args:
        url: URL of the station; None looks for it.
        token: Its operator or viewer token; None looks for it.

    Raises:
        NoStationError: No station was found, or more than one.
        StationAddressError: The URL is not an http or https URL with a host.
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
    """Return the URL of the watchdog of a station on this machine; empty if unknown."""
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
    """Return the only station.

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
