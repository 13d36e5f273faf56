"""The verbs about who did what, and who may."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.cli.arguments import Verbs


def add_access_verbs(verbs: "Verbs") -> None:
    """Add `events`, `control` and `token`."""
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
    control = verbs.add(
        "control", "control:control", "show who holds control, take it, or give it back"
    )
    control.add_argument(
        "action", nargs="?", choices=("show", "take", "release"), default="show"
    )
    control.add_argument("--owner", metavar="NAME", help="name that others are told")
    control.add_argument(
        "--ttl", type=float, default=10.0, metavar="S", help="longest silence [s]"
    )
    control.add_argument(
        "--force", action="store_true", help="take it from whoever holds it"
    )
    token = verbs.add("token", "token:token", "make, list or revoke named tokens")
    token.add_argument("action", choices=("create", "list", "revoke"))
    token.add_argument("name", nargs="?", metavar="NAME", help="whose token")
    token.add_argument("--role", choices=("operator", "viewer"), default="operator")
    token.add_argument(
        "--expires", type=float, metavar="S", help="how long it is valid [s]"
    )
