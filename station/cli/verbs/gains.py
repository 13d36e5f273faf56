"""Verb `gains`: look at and change run-time parameters, and sets of them."""

from argparse import Namespace
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_json, say_model, say_models, say_table

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import GainsChange


Action = Callable[["StationClient", Namespace], int]


def add_gains(parser: "Parser") -> None:
    """Add the arguments of `gains`."""
    parser.add_argument("action", choices=_ACTIONS)
    parser.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="a controller to show or set; a gain set to save, load, diff or delete",
    )
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="set: NAME=VALUE, e.g. panda_joint1/p=500; save and load: controllers, "
        "all when left out",
    )


def gains(options: Namespace) -> int:
    """Show or set the gains of a controller, or save, compare or apply a gain set.

    Raises:
        UsageError: A word is missing or too much.
    """
    action, needs_name, words = _ACTIONS[options.action]
    is_wrong = (
        (options.name is not None) != needs_name
        or (words == "some" and not options.words)
        or (words == "none" and options.words)
    )
    if is_wrong:
        raise UsageError(
            f"The words after `gains {options.action}` are too few or too many.",
            remedy="station gains show arm, station gains set arm panda_joint1/p=500, "
            "station gains save|load|diff|delete SET, station gains list|undo.",
        )
    changes = options.action == "set" and dict(_parse(each) for each in options.words)
    options.changes = changes or {}
    with open_client(options) as client:
        return action(client, options)


def _show(client: "StationClient", options: Namespace) -> int:
    found = client.gains(options.name)
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
        say(f"{options.name} has no gains.")
    return 0


def _set(client: "StationClient", options: Namespace) -> int:
    change = client.set_gains(options.name, options.changes)
    if options.json:
        say_model(change)
        return 0
    rows = [
        [name, f"{change.previous[name]:g}", f"{change.values[name]:g}"]
        for name in options.changes
    ]
    say_table(["gain", "before", "now"], rows)
    for note in change.notes:
        say(f"Note: {note}")
    return 0


def _list(client: "StationClient", options: Namespace) -> int:
    names = client.gain_sets.names()
    if options.json:
        say_json(names)
    elif names:
        for name in names:
            say(name)
    else:
        say("No gain sets are saved.")
    return 0


def _save(client: "StationClient", options: Namespace) -> int:
    saved = client.gain_sets.save(options.name, options.words or None)
    if options.json:
        say_model(saved)
        return 0
    count = sum(len(values) for values in saved.gains.values())
    say(f"Saved {count} gains of {', '.join(saved.gains) or 'no controller'}.")
    return 0


def _diff(client: "StationClient", options: Namespace) -> int:
    found = client.gain_sets.get(options.name)
    if options.json:
        say_models(found.differences)
        return 0
    rows = [
        [one.controller, one.name, _number(one.saved), _number(one.present)]
        for one in found.differences
    ]
    if rows:
        say_table(["controller", "gain", "saved", "present"], rows)
    else:
        say(f"The gain set {options.name} is in force.")
    return 0


def _delete(client: "StationClient", options: Namespace) -> int:
    found = client.gain_sets.delete(options.name)
    if options.json:
        say_model(found)
    else:
        say(f"Deleted the gain set {options.name}.")
    return 0


def _load(client: "StationClient", options: Namespace) -> int:
    return _tell(client.gain_sets.apply(options.name, options.words or None), options)


def _undo(client: "StationClient", options: Namespace) -> int:
    return _tell(client.gain_sets.undo(), options)


def _tell(changes: Mapping[str, "GainsChange"], options: Namespace) -> int:
    """Print the changes of several controllers."""
    if options.json:
        say_json({name: asdict(change) for name, change in changes.items()})
        return 0
    rows = [
        [controller, name, _number(change.previous.get(name)), f"{value:g}"]
        for controller, change in changes.items()
        for name, value in change.values.items()
        if change.previous.get(name) != value
    ]
    if rows:
        say_table(["controller", "gain", "before", "now"], rows)
    else:
        say("No gain has changed.")
    return 0


_ACTIONS: Mapping[str, tuple[Action, bool, str]] = {
    "show": (_show, True, "none"),
    "set": (_set, True, "some"),
    "list": (_list, False, "none"),
    "save": (_save, True, "any"),
    "load": (_load, True, "any"),
    "diff": (_diff, True, "none"),
    "delete": (_delete, True, "none"),
    "undo": (_undo, False, "none"),
}
"""What each action does, whether it needs a name, and whether it takes more words."""


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


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:g}"
