"""Parts of both kinds of command stream: the address and the messages."""

import json
import math
import ssl
from collections.abc import Sequence
from dataclasses import dataclass
from urllib.parse import quote, urlencode

from station.client.routes import LEASE_HEADER, PREFIX
from station.client.stream_options import bearer


@dataclass(frozen=True, slots=True)
class CommandOptions:
    """Where set-points go, and when they expire.

    Attributes:
        base_url: The station, http or https.
        token: Operator token.
        lease: The lease of control that the stream acts under; None without one.
        controller: The controller.
        timeout: Silence after which the last set-point expires [s], > 0.
        patience: Longest wait for a connection [s].
        tls: How the station's certificate is checked; None for plain HTTP.
    """

    base_url: str
    token: str | None
    lease: str | None
    controller: str
    timeout: float = 0.2
    patience: float = 10.0
    tls: ssl.SSLContext | None = None

    def url(self) -> str:
        """Return the WebSocket URL."""
        base = "ws" + self.base_url.removeprefix("http")
        path = f"{PREFIX}/streams/command/{quote(self.controller, safe='')}"
        return f"{base}{path}?{urlencode({'timeout': self.timeout})}"

    def headers(self) -> dict[str, str]:
        """Return the headers that prove access and the lease of control."""
        lease = {} if self.lease is None else {LEASE_HEADER: self.lease}
        return {**bearer(self.token), **lease}


def written(
    values: Sequence[float], epoch: int | None, rates: Sequence[float] | None
) -> str:
    """Return the message with a set-point.

    Args:
        values: The set-point.
        epoch: The epoch that it is made for; None for the present one.
        rates: How fast it changes; None when that is not known.

    Raises:
        ValueError: A number is not finite.
    """
    numbers = [*values, *(rates or [])]
    if not all(map(math.isfinite, numbers)):
        raise ValueError(f"A set-point has finite numbers alone; these are {numbers}.")
    message: dict[str, object] = {"command": list(values)}
    if epoch is not None:
        message["epoch"] = epoch
    if rates is not None:
        message["rates"] = list(rates)
    return json.dumps(message)
