"""Check the addresses at which a station listens, and the token that they require."""

import socket
from ipaddress import ip_address

from station.core.errors import StationError


class ExposedHostError(StationError, ValueError):
    """Other machines could reach the station without a token chosen by the user."""

    code = "exposed_host"


def is_loopback(host: str) -> bool:
    """Return whether only programs on this machine can reach `host`."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host.lower() == "localhost"


def check_exposure(host: str, token: str | None) -> None:
    """Refuse to open the station to a network without an explicit token.

    Raises:
        ExposedHostError: `host` is not this machine's own and `token` is None.
    """
    # Programs of this user read the station's own tokens from files; programs on other
    # machines need a token that the user has chosen.
    if token is None and not is_loopback(host):
        raise ExposedHostError(
            f"api.host is '{host}', which other machines can reach, and there is no "
            "token of your own.",
            remedy="Give one: STATION_API__TOKEN=… station run --host …, `api.token` "
            "in the configuration, or --token. Or stay at 127.0.0.1.",
        )


def host_names(host: str) -> list[str]:
    """Return the names by which clients may address a station at `host`."""
    if is_loopback(host):
        return []
    name = socket.gethostname()
    # The last name is the one in mDNS.
    return [host, name, f"{name.partition('.')[0]}.local"]
