"""Refuse a change that comes later than its sender wanted it to begin.

A process that stood still finds requests in its sockets that were sent long before.
"""

import time
from collections.abc import Callable, Mapping

from station.api.errors import ProblemError
from station.wire.protocol import CLOCK_HEADER, NOT_AFTER_HEADER


def refuse_late(
    headers: Mapping[str, str], now: Callable[[], float] = time.time
) -> None:
    """Refuse a request that comes too late to be begun.

    Args:
        headers: Those of the request; without `X-Not-After` it is never too late.
        now: Wall clock [s since 1970].

    Raises:
        ProblemError: It comes too late, or the header is no number.
    """
    told = headers.get(NOT_AFTER_HEADER)
    if told is None:
        return
    try:
        late = now() - float(told)
    except ValueError as error:
        raise ProblemError(
            422,
            "invalid_request",
            f"{NOT_AFTER_HEADER} is {told!r:.40}; it is seconds since 1970.",
            f"Add to {CLOCK_HEADER} of the last answer, or leave it out.",
        ) from error
    if not late <= 0.0:
        raise ProblemError(
            412,
            "expired",
            f"The request came {late:.1f} s too late to be begun, for example because "
            "the station stood still. Nothing was done.",
            "Look at the robot, then ask again.",
        )
