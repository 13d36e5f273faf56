"""Checks of the addresses the station listens on, and of what they require."""

import socket
from ipaddress import ip_address

from station.core.errors import StationError


class ExposedHostError(StationError, ValueError):
    """The station would be reachable from elsewhere without a token of the user's."""

    code = "exposed_host"


def is_loopback(host: str) -> bool:
    """Say whether only programs on this machine can reach `host`."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"


def check_exposure(host: str, token: str | None) -> None:
    """Refuse to open the station to a network without an explicit token.

    Raises:
        ExposedHostError: `host` is not this machine's own and `token` is None.
    """
    # The station's own tokens lie in files that programs of this user read; other
    # machines need a token that somebody chose.
    if token is None and not is_loopback(host):
        raise ExposedHostError(
            f"api.host is '{host}', which other machines can reach, and there is no "
            "token of your own.",
            remedy="Give one: STATION_API__TOKEN=… station run --host …, `api.token` "
            "in the configuration, or --token. Or stay at 127.0.0.1.",
        )


def host_names(host: str) -> list[str]:
    """Return names under which others may call a station that listens at `host`."""
    if is_loopback(host):
        return []
    name = socket.gethostname()
    # The last one is the name in mDNS.
    return [host, name, f"{name.partition('.')[0]}.local"]
