"""Verb `echo`: print what a topic says."""

import itertools
import sys
from argparse import Namespace
from typing import TYPE_CHECKING, Literal

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from station.wire import StreamFrame


def echo(options: Namespace) -> int:
    """Print the frames of a topic until there were enough, or Ctrl-C."""
    rate = _rate(options.rate)
    with (
        open_client(options) as client,
        client.stream(
            options.topic, rate=rate, fields=_fields(options.fields), reconnect=False
        ) as stream,
    ):
        for frame in itertools.islice(stream, options.count):
            if options.json:
                say_model(frame)
            else:
                _show(frame)
            sys.stdout.flush()
    return 0


def _rate(text: str | None) -> float | Literal["full"] | None:
    """Return the rate of the option `--rate`.

    Raises:
        UsageError: It is neither a positive number nor `full`.
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


def _show(frame: "StreamFrame") -> None:
    say(f"stamp: {frame.stamp:.3f}")
    for key, value in frame.data.items():
        say(f"{key}: {_text(value)}")
    say("---")


def _text(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_text(item) for item in value)}]"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
