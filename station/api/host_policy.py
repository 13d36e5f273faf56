"""Addresses and web pages that may talk to the station.

A web page elsewhere must not drive a robot on this machine: neither by a request of
its own (the Origin tells) nor under a name that its DNS server points here (the Host
tells). A numeric Host is safe: no DNS server had a say in it.
"""

import re
from collections.abc import Iterable
from ipaddress import ip_address
from urllib.parse import urlsplit

from station.web.request_id import HEADER as REQUEST_ID_HEADER
from station.wire.protocol import (
    CLOCK_HEADER,
    KEY_HEADER,
    LEASE_HEADER,
    NOT_AFTER_HEADER,
    REHEARSAL_HEADER,
    REPLAYED_HEADER,
)

METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE")
"""Methods that pages of an allowed origin may use."""
REQUEST_HEADERS = (
    "Authorization",
    "Content-Type",
    KEY_HEADER,
    "If-Match",
    "If-None-Match",
    "Last-Event-ID",
    LEASE_HEADER,
    NOT_AFTER_HEADER,
    REQUEST_ID_HEADER,
)
"""Headers that they may send. They have no cookie: they show a token."""
ANSWER_HEADERS = (
    "ETag", REPLAYED_HEADER, REQUEST_ID_HEADER, CLOCK_HEADER, REHEARSAL_HEADER
)  # fmt: skip
"""Headers that they may read."""
_HOST = re.compile(r"(?P<name>\[[0-9a-f:.]+\]|[a-z0-9._-]+)(:\d{1,5})?", re.ASCII)


def _is_numeric(name: str) -> bool:
    try:
        ip_address(name.strip("[]"))
    except ValueError:
        return False
    return True


class HostPolicy:
    """Judges Host and Origin headers.

    Args:
        hosts: Names under which the station is reached, besides localhost and
            numeric addresses.
        origins: Origins of web pages that may use the API, besides its own.
    """

    def __init__(self, hosts: Iterable[str] = (), origins: Iterable[str] = ()) -> None:
        self.hosts = {"localhost", *(host.lower() for host in hosts)}
        self.origins = {origin.lower().rstrip("/") for origin in origins}

    def allows_host(self, host: str | None) -> bool:
        """Return whether a request may name `host` in its Host header."""
        match = _HOST.fullmatch((host or "").lower())
        if match is None:
            return False
        name = match["name"]
        return name in self.hosts or _is_numeric(name)

    def allows_origin(self, origin: str | None, host: str | None) -> bool:
        """Return whether a page of `origin` may use the station at `host`.

        A request without Origin comes from a program, not from a web page.
        """
        if origin is None:
            return True
        if origin.lower().rstrip("/") in self.origins:
            return True
        try:
            parts = urlsplit(origin.lower())
        except ValueError:
            return False
        own = parts.scheme in {"http", "https"} and parts.netloc != ""
        return own and parts.netloc == (host or "").lower()
