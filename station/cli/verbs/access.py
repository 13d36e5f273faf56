"""Verbs about rights: `control` of the station and named tokens."""

import sys
import time
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import LEASE_VARIABLE, open_client
from station.cli.errors import UsageError
from station.cli.output import answer, answer_table, say
from station.cli.parser import check_words

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import ControlState

LOOK_PERIOD = 0.2
"""Time between two checks whether control was lost [s]."""


_CONTROL = {"show": "", "take": "owner ttl force", "release": ""}
_TOKEN = {"create": "name role expires", "list": "", "revoke": "name"}


def add_control(parser: "Parser") -> None:
    """Add the arguments of `control`."""
    add = parser.add_argument
    add("action", nargs="?", choices=("show", "take", "release"), default="show")
    add("--owner", metavar="NAME", help="name that others are told")
    add("--ttl", type=float, default=10.0, metavar="S", help="longest silence [s]")
    add("--force", action="store_true", help="take it from whoever holds it")


def add_token(parser: "Parser") -> None:
    """Add the arguments of `token`."""
    add = parser.add_argument
    add("action", choices=("create", "list", "revoke"))
    add("name", nargs="?", metavar="NAME", help="whose token")
    add("--role", choices=("operator", "viewer", "agent"), default="operator")
    add("--expires", type=float, metavar="S", help="how long it is valid [s]")


def control(options: Namespace) -> int:
    """Show the holder of control, take control until Ctrl-C, or give it back."""
    check_words(options, _CONTROL)
    with open_client(options) as client:
        if options.action == "take":
            _take(client, options)
        elif options.action == "release":
            client.lease.release()
            answer(options, {"owner": None}, "Control is given back.")
        else:
            _show(client.lease.state(), options)
    return 0


def _take(client: "StationClient", options: Namespace) -> None:
    with client.control(options.owner, ttl=options.ttl, force=options.force) as lease:
        state = lease.renew()
        _show(state, options)
        if not options.json:
            say("Ctrl-C gives it back. Other shells act under this lease with")
            say(f"export {LEASE_VARIABLE}={state.lease}")
        sys.stdout.flush()
        while lease.lost is None:
            time.sleep(LOOK_PERIOD)
        raise lease.lost


def _show(state: "ControlState", options: Namespace) -> None:
    line = "Nobody holds control; every operator may change things."
    if state.owner is not None:
        offer = f" It is offered to {state.hand_over_to}." if state.hand_over_to else ""
        line = f"{state.owner} holds control since {_time(state.since)}.{offer}"
    answer(options, state, line)


def token(options: Namespace) -> int:
    """Make, list or revoke named tokens.

    Raises:
        UsageError: `create` or `revoke` was given without a name.
    """
    check_words(options, _TOKEN)
    if options.action != "list" and options.name is None:
        raise UsageError(
            f"Whose token? `{options.action}` needs a name.",
            remedy=f"station token {options.action} NAME",
        )
    with open_client(options) as client:
        if options.action == "list":
            found = client.tokens.list()
            rows = [(t.name, t.role, _time(t.expires_at)) for t in found]
            return answer_table(options, found, ("name", "role", "expires"), rows)
        if options.action == "create":
            made = client.tokens.create(
                options.name, options.role, expires=options.expires
            )
            return answer(options, made, made.token)
        gone = client.tokens.revoke(options.name)
    return answer(options, gone, f"{gone.name} has no token now.")


def _time(stamp: float | None) -> str:
    if stamp is None:
        return "never"
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(stamp))
