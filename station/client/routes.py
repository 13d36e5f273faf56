"""How paths of the API are written, and names of what some of them take."""

from typing import Final, Literal
from urllib.parse import quote

PREFIX: Final = "/api/v1"
Strictness = Literal["strict", "best_effort"]
Restart = Literal["none", "previous"]


def segment(name: str) -> str:
    """Return `name` as one segment of a path."""
    return quote(name, safe="")
