"""Decide which Host and Origin headers a localhost service may answer."""

import ipaddress
from collections.abc import Collection

LOOPBACK_NAMES = frozenset({"localhost", "127.0.0.1", "::1"})


class OriginPolicy:
    """Answers only requests that really are meant for this server.

    A web page elsewhere can make a browser send requests here, under its own name
    (DNS rebinding: a foreign Host) or from its own page (a foreign Origin). A literal
    IP address cannot be rebound, so it is allowed when the server listens beyond
    loopback.

    Args:
        host: Address the server is bound to.
        extra_names: Further host names under which users reach the server.
    """

    def __init__(self, host: str, extra_names: Collection[str] = ()) -> None:
        self._names = LOOPBACK_NAMES | {host.lower()}
        self._names |= {name.lower() for name in extra_names}
        self._any_address = host not in LOOPBACK_NAMES

    def allows_host(self, host_header: str) -> bool:
        """Return whether a request with this Host header may be answered."""
        name = _host_name(host_header)
        if name in self._names:
            return True
        return self._any_address and _is_address(name)

    def allows_origin(self, origin: str | None, host_header: str) -> bool:
        """Return whether a changing request or a WebSocket may come from `origin`.

        Args:
            origin: The Origin header; browsers always send it on such requests.
            host_header: The Host header of the same request.
        """
        if origin is None:
            return False
        scheme, separator, rest = origin.partition("://")
        return (
            bool(separator)
            and scheme in {"http", "https"}
            and rest.lower() == host_header.lower()
        )


def _host_name(host_header: str) -> str:
    """Return the name in `name`, `name:port`, `[v6]` or `[v6]:port`, lower case."""
    value = host_header.strip().lower()
    if value.startswith("["):
        return value[1:].partition("]")[0]
    return value.partition(":")[0]


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
