"""How a dashboard learns which station it belongs to. Imports nothing heavy."""

from dataclasses import dataclass, field
from typing import Protocol


@dataclass(frozen=True, slots=True)
class StationAccess:
    """How to reach a station.

    Attributes:
        url: The API.
        token: The operator's token.
        watchdog_url: The listener of its watchdog; empty when there is none.
        viewer_token: The viewer's token; empty when it is not known.
    """

    url: str
    token: str
    watchdog_url: str
    viewer_token: str = field(default="", repr=False)


class StationFollower(Protocol):
    """Tells a dashboard which station it belongs to, and when it has to end.

    Attributes:
        access: How to reach the station; None once it has ended, until another station
            takes its place. Whoever answers at its address meanwhile must not be sent
            its tokens, and does not know them.
        is_over: The dashboard has to end.
        is_serving: Set by the dashboard once it answers.
    """

    access: StationAccess | None
    is_over: bool
    is_serving: bool
