"""Log wrong tokens, and delay the answer longer with each one from the same source.

A right token is never held back, whatever was sent from the same address before:
no client can keep an operator from logging in or stopping the robot by sending wrong
tokens.
"""

import asyncio
import logging
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from ipaddress import IPv6Address, ip_address

from starlette.requests import HTTPConnection

FREE_FAILURES = 3
"""Number of failures of a source that are answered without delay: people mistype."""
FIRST_DELAY = 0.1
"""Delay of the answer to the next failure [s]; every further failure doubles it."""
LONGEST_DELAY = 1.0
"""Longest delay of an answer [s]."""
FORGET_AFTER = 60.0
"""Time without a failure after which a source has a clean record again [s]."""
MOST_SOURCES = 1024
"""Number of sources that are remembered; the longest quiet one is forgotten first."""
MOST_HELD = 16
"""Most answers that are delayed at the same time, since each keeps a connection."""

_log = logging.getLogger(__name__)


@dataclass(slots=True)
class _Record:
    count: int = 0
    last: float = 0.0


class FailedLogins:
    """The failed logins of one server. Use it in one event loop only.

    Args:
        now: Monotonic clock [s].
        sleep: Waits for a time [s].
    """

    def __init__(
        self,
        now: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], Awaitable[None]] = asyncio.sleep,
    ) -> None:
        self._now = now
        self._sleep = sleep
        self._records: dict[str, _Record] = {}
        self._held = 0

    async def slow_down(self, connection: HTTPConnection) -> None:
        """Count a wrong token, and return when it may be answered.

        Args:
            connection: The request or the WebSocket that brought the token.
        """
        client = connection.client
        delay = self.note(_network("" if client is None else client.host))
        # An attacker must not occupy all connections with delayed answers.
        if not delay or self._held >= MOST_HELD:
            return
        self._held += 1
        try:
            await self._sleep(delay)
        finally:
            self._held -= 1

    def note(self, source: str) -> float:
        """Count and log a failure; return the delay of its answer [s].

        Args:
            source: Network from which the failure came.
        """
        now = self._now()
        # Remove the record and insert it again, so that the dictionary has the order of
        # the last failures.
        record = self._records.pop(source, _Record())
        if now - record.last > FORGET_AFTER:
            record.count = 0
        record.count += 1
        record.last = now
        # The number is bounded, because an attacker has many addresses.
        while len(self._records) >= MOST_SOURCES:
            del self._records[next(iter(self._records))]
        self._records[source] = record
        # Log failure 1, 2, 4, 8, … only, so that an attacker cannot fill the disk.
        if record.count & (record.count - 1) == 0:
            _log.warning(
                "%s has sent %d wrong token(s) within a minute of each other.",
                source or "A client without an address",
                record.count,
            )
        late = record.count - FREE_FAILURES
        if late <= 0:
            return 0.0
        # The exponent is bounded, or many failures would overflow a float.
        return min(LONGEST_DELAY, FIRST_DELAY * 2.0 ** min(late - 1, 10))


def _network(host: str) -> str:
    """Return an address's network, because an IPv6 customer has 2**64 addresses."""
    try:
        address = ip_address(host)
    except ValueError:
        return host
    # A customer has a whole /64, and could use a new address for every attempt.
    if isinstance(address, IPv6Address) and address.ipv4_mapped is None:
        return f"{IPv6Address(int(address) >> 64 << 64)}/64"
    return str(getattr(address, "ipv4_mapped", None) or address)
