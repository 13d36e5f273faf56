"""Verb `gains`: look at and change run-time parameters."""

from argparse import Namespace

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_model, say_table


def gains(options: Namespace) -> int:
    """Show a controller's gains, or set some.

    Raises:
        UsageError: `set` has no changes, or `show` has some.
    """
    if (options.action == "set") != bool(options.changes):
        raise UsageError(
            f"`gains {options.action}` takes "
            f"{'at least one' if options.action == 'set' else 'no'} NAME=VALUE.",
            remedy="station gains set arm panda_joint1/p=500, or station gains show "
            "arm to see the names.",
        )
    return _set(options) if options.action == "set" else _show(options)


def _show(options: Namespace) -> int:
    with open_client(options) as client:
        found = client.gains(options.controller)
    if options.json:
        say_model(found)
        return 0
    rows = []
    for name, value in found.values.items():
        tunable = found.tunables[name]
        low, high = _bound(tunable.minimum), _bound(tunable.maximum)
        rows.append([name, f"{value:g}", tunable.unit or "-", f"{low} … {high}"])
    if rows:
        say_table(["gain", "value", "unit", "allowed"], rows)
    else:
        say(f"{options.controller} has no gains.")
    return 0


def _set(options: Namespace) -> int:
    changes = dict(_parse(change) for change in options.changes)
    with open_client(options) as client:
        change = client.set_gains(options.controller, changes)
    if options.json:
        say_model(change)
        return 0
    rows = [
        [name, f"{change.previous[name]:g}", f"{change.values[name]:g}"]
        for name in changes
    ]
    say_table(["gain", "before", "now"], rows)
    return 0


def _parse(change: str) -> tuple[str, float]:
    """Return name and value of `NAME=VALUE`.

    Raises:
        UsageError: The text has another form.
    """
    name, equals, text = change.rpartition("=")
    try:
        return name, float(text if equals and name else "no number")
    except ValueError as error:
        raise UsageError(
            f"{change!r} is not NAME=VALUE with a number.",
            remedy="Write it like panda_joint1/p=500.",
        ) from error


def _bound(value: float | None) -> str:
    return "∞" if value is None else f"{value:g}"
