"""Verb `control`: show who holds control, hold it, or give it back."""

import sys
import time
from argparse import Namespace
from datetime import datetime
from typing import TYPE_CHECKING

from station.cli.connection import LEASE_VARIABLE, open_client
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from station.client import StationClient
    from station.wire import ControlState

LOOK_PERIOD = 0.2
"""How often it looks whether control was lost [s]."""


def control(options: Namespace) -> int:
    """Show who holds control, take it until Ctrl-C, or give it back."""
    with open_client(options) as client:
        if options.action == "take":
            _take(client, options)
        elif options.action == "release":
            client.lease.release()
            say("Control is given back.")
        else:
            _show(client.lease.state(), as_json=options.json)
    return 0


def _take(client: "StationClient", options: Namespace) -> None:
    with client.control(options.owner, ttl=options.ttl, force=options.force) as lease:
        state = lease.renew()
        _show(state, as_json=options.json)
        if not options.json:
            say("Ctrl-C gives it back. Other shells act under this lease with")
            say(f"export {LEASE_VARIABLE}={state.lease}")
        sys.stdout.flush()
        while lease.lost is None:
            time.sleep(LOOK_PERIOD)
        raise lease.lost


def _show(state: "ControlState", *, as_json: bool) -> None:
    if as_json:
        say_model(state)
    elif state.owner is None or state.since is None:
        say("Nobody holds control; every operator may change things.")
    else:
        since = datetime.fromtimestamp(state.since).astimezone()
        offer = f" It is offered to {state.hand_over_to}." if state.hand_over_to else ""
        say(f"{state.owner} holds control since {since:%Y-%m-%d %H:%M:%S}.{offer}")
