"""The access of a dashboard to its station. Imports nothing heavy."""

from dataclasses import dataclass, field
from typing import Protocol


@dataclass(frozen=True, slots=True)
class StationAccess:
    """The address of a station and its tokens.

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
    """Says to which station a dashboard belongs, and when the dashboard has to end.

    Attributes:
        access: The access to the station; None once it has ended, until another station
            takes its place. Its tokens must not be sent to another program that answers
            at its address meanwhile.
        is_over: Whether the dashboard has to end.
        is_serving: Set by the dashboard once it answers.
    """

    access: StationAccess | None
    is_over: bool
    is_serving: bool
