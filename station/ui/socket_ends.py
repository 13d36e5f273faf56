"""Serve a socket until the first of several things ends it."""

import asyncio


async def until_first(*ends: "asyncio.Future[None]") -> None:
    """Wait for the first of these, and cancel the others.

    Args:
        ends: What may end the socket; all are over when this returns.

    Raises:
        BaseException: Whatever one of them raised: an end that is expected returns.
    """
    try:
        await asyncio.wait(ends, return_when=asyncio.FIRST_COMPLETED)
    finally:
        over = {end for end in ends if end.done()}
        for end in ends:
            end.cancel()
        await asyncio.gather(*ends, return_exceptions=True)
    for end in over:
        if not end.cancelled() and (error := end.exception()) is not None:
            raise error
