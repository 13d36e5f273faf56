"""One event: its time, kind, author, origin and result."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

MAX_TEXT = 500
"""Longest text that an event keeps [characters]; the rest is cut off."""
MAX_DETAILS = 4000
"""Longest details as JSON [characters]; longer ones become one text that is cut off."""


@dataclass(frozen=True, slots=True)
class Origin:
    """The origin of an event.

    Attributes:
        who: Name of the token or person; empty for the station itself.
        where: Address that the request came from; empty for the station itself.
        request_id: Name of the request, as in its answer; empty without a request.
    """

    who: str = ""
    where: str = ""
    request_id: str = ""


STATION = Origin()
"""The station itself."""


def written_details(details: Mapping[str, object]) -> str:
    """Return details as JSON of at most `MAX_DETAILS` characters.

    Args:
        details: Anything; values of types that JSON does not have are written as text,
            and numbers that are not finite as null.
    """
    if not details:
        return "{}"
    # JSON has no NaN: `_plain` has replaced it by null.
    text = json.dumps(_plain(details), allow_nan=False)
    if len(text) <= MAX_DETAILS:
        return text
    return json.dumps({"shortened": text[: MAX_DETAILS // 2]})


def _plain(value: object) -> object:
    """Return a value with only the types that JSON has."""
    if isinstance(value, float):
        # The difference is 0 unless the value is NaN or infinite.
        return value if value - value == 0.0 else None
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [_plain(each) for each in value]
    if isinstance(value, Enum):
        return _plain(value.value)
    return value if value is None or isinstance(value, (bool, int)) else str(value)
