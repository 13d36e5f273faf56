"""Decide which addresses and web pages may talk to a server of the station.

A foreign web page must not drive a robot on this machine. The requests of a page carry
its Origin. A page can also give its own domain name the address of this machine (DNS
rebinding); its requests then carry that name in their Host header. A numeric Host is
safe, because it was not looked up by DNS.
"""

import re
from collections.abc import Iterable
from ipaddress import ip_address
from urllib.parse import urlsplit

_HOST = re.compile(r"(?P<name>\[[0-9a-f:.]+\]|[a-z0-9._-]+)(:\d{1,5})?", re.ASCII)


def _is_numeric(name: str) -> bool:
    try:
        ip_address(name)
    except ValueError:
        return False
    return True


class HostPolicy:
    """Decides on the Host and Origin headers of requests.

    Args:
        hosts: Names of the server that are allowed besides localhost and numeric
            addresses.
        origins: Origins of web pages that may use the server, besides its own.
        any_address: Whether every numeric address is allowed.
        programs: Whether to allow a request without Origin, which comes from a program,
            or from a page that reads from its own server.
    """

    def __init__(
        self,
        hosts: Iterable[str] = (),
        origins: Iterable[str] = (),
        *,
        any_address: bool = True,
        programs: bool = True,
    ) -> None:
        self._any_address = any_address
        self._programs = programs
        self.hosts = {"localhost", *(host.lower() for host in hosts)}
        self.origins = {origin.lower().rstrip("/") for origin in origins}

    def allows_host(self, host: str | None) -> bool:
        """Return whether a request may name `host` in its Host header."""
        match = _HOST.fullmatch((host or "").lower())
        if match is None:
            return False
        name = match["name"].strip("[]")
        return name in self.hosts or (self._any_address and _is_numeric(name))

    def allows_origin(self, origin: str | None, host: str | None) -> bool:
        """Return whether a page of `origin` may use the server at `host`."""
        if origin is None:
            return self._programs
        if origin.lower().rstrip("/") in self.origins:
            return True
        try:
            parts = urlsplit(origin.lower())
        except ValueError:
            return False
        own = parts.scheme in {"http", "https"} and parts.netloc != ""
        return own and parts.netloc == (host or "").lower()
