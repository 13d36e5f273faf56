"""The verbs about who did what, and who may."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.cli.arguments import Verbs


def add_access_verbs(verbs: "Verbs") -> None:
    """Add `events`."""
    events = verbs.add(
        "events", "events:events", "print what happened: who did what, with what result"
    )
    events.add_argument("-f", "--follow", action="store_true", help="until Ctrl-C")
    events.add_argument(
        "--kind",
        action="append",
        default=[],
        metavar="KIND",
        help="only this kind, e.g. stop, fault, request; may be repeated",
    )
    events.add_argument(
        "--since", type=int, metavar="ID", help="only events after this number"
    )
    events.add_argument(
        "--severity", choices=("info", "warning", "error"), default="info"
    )
    events.add_argument(
        "-n", "--count", type=int, default=50, help="most events; 50 unless told"
    )
