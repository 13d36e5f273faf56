"""The addresses of a station: checked, named for clients, and announced to the user."""

import socket
from dataclasses import dataclass
from ipaddress import ip_address
from urllib.parse import urlencode

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


@dataclass(frozen=True, slots=True)
class Announcement:
    """The addresses of a station that has just started.

    Attributes:
        api_url: URL of the API.
        ui_url: URL of the dashboard; empty without a dashboard.
        token: The operator's token.
        runtime_file: File with the tokens.
        scheduler: Scheduling class that the control thread was granted.
        robot: `SIMULATION` or `REAL ARM`, as at the top of the dashboard.
        kernel: Whether the cycle's arithmetic runs interpreted or compiled, and why.
    """

    api_url: str
    ui_url: str
    token: str
    runtime_file: str
    scheduler: str
    robot: str
    kernel: str

    def lines(self) -> list[str]:
        """Return the lines to print when the API answers."""
        return [
            f"API        {self.api_url}/docs",
            f"Token      {self.token} (also in {self.runtime_file})",
            f"Robot      {self.robot}",
            f"Cycle      {self.kernel}",
        ]

    def dashboard_line(self) -> str:
        """Return the line for an answering dashboard, with an address that logs in."""
        return f"Dashboard  {self.ui_url}/login?{urlencode({'token': self.token})}"

    def as_json(self) -> dict[str, str]:
        """Return JSON-compatible data; the token is only in the runtime file."""
        return {
            "api_url": self.api_url,
            "ui_url": self.ui_url,
            "runtime_file": self.runtime_file,
            "scheduler": self.scheduler,
            "robot": self.robot,
            "kernel": self.kernel,
        }
