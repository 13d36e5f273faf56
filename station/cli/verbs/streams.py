"""Verbs `echo` and `events`: print the messages of a topic, and events."""

import itertools
import sys
from argparse import Namespace
from datetime import datetime
from typing import TYPE_CHECKING, Literal

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_json
from station.cli.parser import read_count

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import Event, StreamFrame


def add_echo(parser: "Parser") -> None:
    """Add the arguments of `echo`."""
    add = parser.add_argument
    add("topic", help="joint_states, robot_state, controllers, loop, …")
    add("--rate", metavar="HZ", help="samples per second, or `full`")
    add("--fields", metavar="A,B", help="only these fields")
    add("-n", "--count", type=read_count, help="stop after so many")


def add_events(parser: "Parser") -> None:
    """Add the arguments of `events`."""
    add = parser.add_argument
    add("-f", "--follow", action="store_true", help="until Ctrl-C")
    add(
        "--kind",
        action="append",
        default=[],
        metavar="KIND",
        help="only this kind, e.g. stop, fault, request; may be repeated",
    )
    add("--since", type=int, metavar="ID", help="only events after this number")
    add("--severity", choices=("info", "warning", "error"), default="info")
    add(
        "-n",
        "--count",
        type=int,
        dest="limit",
        default=50,
        help="most events; 50 unless told",
    )


def echo(options: Namespace) -> int:
    """Print the frames of a topic until the wanted number or Ctrl-C."""
    rate = _rate(options.rate)
    with (
        open_client(options) as client,
        client.stream(
            options.topic, rate=rate, fields=_fields(options.fields), reconnect=False
        ) as stream,
    ):
        for frame in itertools.islice(stream, options.count):
            if options.json:
                say_json(frame)
            else:
                _show_frame(frame)
            sys.stdout.flush()
    return 0


def _rate(text: str | None) -> float | Literal["full"] | None:
    """Return the rate of the option `--rate`.

    Raises:
        UsageError: The rate is neither a positive number nor `full`.
    """
    if text is None:
        return None
    if text == "full":
        return "full"
    try:
        rate = float(text)
    except ValueError:
        rate = 0.0
    if not 0.0 < rate < float("inf"):
        raise UsageError(
            f"{text!r} is not a rate.", remedy="Use a number of Hz, or `full`."
        )
    return rate


def _fields(text: str | None) -> list[str]:
    return [] if text is None else text.split(",")


def _show_frame(frame: "StreamFrame") -> None:
    say(f"stamp: {frame.stamp:.3f}")
    for key, value in frame.data.items():
        say(f"{key}: {_text(value)}")
    say("---")


def _text(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_text(item) for item in value)}]"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def events(options: Namespace) -> int:
    """Print events, oldest first; with `--follow` until Ctrl-C."""
    with open_client(options) as client:
        if options.follow:
            _follow(client, options)
            return 0
        for event in _listed(client, options):
            _show_event(event, as_json=options.json)
    return 0


def _listed(client: "StationClient", options: Namespace) -> "list[Event]":
    return client.events(
        options.since,
        kinds=options.kind,
        severity=options.severity,
        limit=options.limit,
    )


def _follow(client: "StationClient", options: Namespace) -> None:
    from station.wire import Event

    # Connect before listing, so that no event is missed between list and stream.
    with client.stream("events", reconnect=False) as stream:
        last = options.since or 0
        for event in _listed(client, options):
            _show_event(event, as_json=options.json)
            last = event.id
        for frame in stream:
            event = frame.read(Event)
            if event.id > last and _is_wanted(event, options):
                _show_event(event, as_json=options.json)


def _is_wanted(event: "Event", options: Namespace) -> bool:
    order = ("info", "warning", "error")
    is_of_kind = not options.kind or event.kind in options.kind
    return is_of_kind and order.index(event.severity) >= order.index(options.severity)


def _show_event(event: "Event", *, as_json: bool) -> None:
    if as_json:
        say_json(event)
    else:
        when = datetime.fromtimestamp(event.time).astimezone()
        by = " ".join(filter(None, (event.who, event.where and f"({event.where})")))
        clock = f"{when:%Y-%m-%d %H:%M:%S}.{when.microsecond // 1000:03d}"
        say(
            f"{event.id:>6}  {clock}  {event.severity:<7}  {event.kind:<12}  "
            f"{event.text}{f' [{by}]' if by else ''}"
        )
    sys.stdout.flush()
