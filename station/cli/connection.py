"""Find the station that a verb talks to, and its token."""

import os
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.errors import UsageError
from station.local import station_locator

if TYPE_CHECKING:
    from station.client import StationClient

LEASE_VARIABLE = "STATION_CONTROL_LEASE"
"""Environment variable: the lease of control under which verbs make changes."""


def open_client(options: Namespace) -> "StationClient":
    """Return a client for the station in the options, or for the one on this machine.

    Raises:
        NoStationError: No station was found, or more than one.
        UsageError: The URL is not an http or https URL with a host.
    """
    from station.client import StationClient

    url, token = locate(options.url, options.token)
    client = StationClient(url, token, ca=options.ca)
    client.lease.act_under(os.environ.get(LEASE_VARIABLE))
    return client


def locate(url: str | None, token: str | None) -> tuple[str, str | None]:
    """Return URL and token of the station to talk to, see `station_locator.locate`.

    Raises:
        NoStationError: No station was found, or more than one.
        UsageError: The URL is not an http or https URL with a host.
    """
    try:
        return station_locator.locate(url, token)
    except station_locator.StationAddressError as error:
        raise UsageError(error.message, remedy=error.remedy) from error
