"""Limit of a request's body, checked before it is read and while it is."""

from starlette.datastructures import Headers
from starlette.types import Message, Receive, Scope


def announces_more_than(scope: Scope, most: int) -> bool:
    """Return whether a request announces a body of more than `most` bytes.

    A length that is not a number counts as one that is too large.
    """
    lengths = Headers(scope=scope).getlist("content-length")
    # Of several headers each counts. Longer numbers would take time to convert.
    return any(not n.isdecimal() or len(n) > 18 or int(n) > most for n in lengths)


def limited(receive: Receive, most: int, too_large: Exception) -> Receive:
    """Return a `receive` that raises when a body without a length grows too large.

    Args:
        receive: Channel by which the server hands the body over.
        most: Largest body [bytes].
        too_large: Error of a body that is too large.
    """
    size = 0

    async def receive_limited() -> Message:
        nonlocal size
        message = await receive()
        size += len(message.get("body", b""))
        # A body may be longer than announced, or come in chunks without a length.
        if size > most:
            raise too_large
        return message

    return receive_limited
