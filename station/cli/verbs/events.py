"""Verb `events`: print what happened, and with `--follow` what happens."""

import sys
from argparse import Namespace
from datetime import datetime
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from station.client import StationClient
    from station.wire import Event


def events(options: Namespace) -> int:
    """Print events, oldest first; with `--follow` until Ctrl-C."""
    with open_client(options) as client:
        if options.follow:
            _follow(client, options)
            return 0
        for event in _listed(client, options):
            _show(event, as_json=options.json)
    return 0


def _listed(client: "StationClient", options: Namespace) -> "list[Event]":
    return client.events(
        options.since,
        kinds=options.kind,
        severity=options.severity,
        limit=options.count,
    )


def _follow(client: "StationClient", options: Namespace) -> None:
    from station.wire import Event

    # Connected first, so that nothing is missed between the list and the stream.
    with client.stream("events", reconnect=False) as stream:
        last = options.since or 0
        for event in _listed(client, options):
            _show(event, as_json=options.json)
            last = event.id
        for frame in stream:
            event = frame.read(Event)
            if event.id > last and _is_wanted(event, options):
                _show(event, as_json=options.json)


def _is_wanted(event: "Event", options: Namespace) -> bool:
    order = ("info", "warning", "error")
    is_of_kind = not options.kind or event.kind in options.kind
    return is_of_kind and order.index(event.severity) >= order.index(options.severity)


def _show(event: "Event", *, as_json: bool) -> None:
    if as_json:
        say_model(event)
    else:
        when = datetime.fromtimestamp(event.time).astimezone()
        by = " ".join(filter(None, (event.who, event.where and f"({event.where})")))
        clock = f"{when:%Y-%m-%d %H:%M:%S}.{when.microsecond // 1000:03d}"
        say(
            f"{event.id:>6}  {clock}  {event.severity:<7}  {event.kind:<12}  "
            f"{event.text}{f' [{by}]' if by else ''}"
        )
    sys.stdout.flush()
