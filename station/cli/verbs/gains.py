"""Verb `gains`: show and change run-time parameters, and sets of them."""

import tempfile
from argparse import Namespace
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, answer_table, number, say
from station.cli.parser import read_number, unique
from station.core.errors import counted

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
        help="a controller to show, set or export; a gain set to save, load, diff or "
        "delete",
    )
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="set: NAME=VALUE, e.g. panda_joint1/p=500; save and load: controllers, "
        "all when left out; export: more controllers",
    )
    parser.add_argument(
        "--file",
        type=Path,
        metavar="FILE",
        help="export: the file to write; the present one is kept as FILE~",
    )


def gains(options: Namespace) -> int:
    """Show or set the gains of a controller, or save, compare or apply a gain set.

    Raises:
        UsageError: There are too few or too many words.
    """
    action, needs_name, words = _ACTIONS[options.action]
    is_wrong = (
        (options.name is not None) != needs_name
        or (words == "some" and not options.words)
        or (words == "none" and options.words)
        or (options.file is not None and options.action != "export")
    )
    if is_wrong:
        raise UsageError(
            f"The words after `gains {options.action}` are too few or too many.",
            remedy="station gains show arm, station gains set arm panda_joint1/p=500, "
            "station gains export arm [--file FILE], "
            "station gains save|load|diff|delete SET, station gains list|undo.",
        )
    is_set = options.action == "set"
    options.changes = unique(map(_change, options.words)) if is_set else {}
    with open_client(options) as client:
        return action(client, options)


def _show(client: "StationClient", options: Namespace) -> int:
    found = client.gains(options.name)
    rows = []
    for name, value in found.values.items():
        tunable = found.tunables[name]
        low, high = _bound(tunable.minimum), _bound(tunable.maximum)
        rows.append([name, f"{value:g}", tunable.unit or "-", f"{low} … {high}"])
    nothing = f"{options.name} has no gains."
    return answer_table(
        options, found, ["gain", "value", "unit", "allowed"], rows, nothing
    )


def _set(client: "StationClient", options: Namespace) -> int:
    options.typed["values"] = "NAME=VALUE"
    change = client.set_gains(options.name, options.changes)
    return answer_change(options, change, options.changes, change.notes)


def answer_change(
    options: Namespace,
    change: "GainsChange",
    names: Iterable[str],
    notes: Iterable[str],
) -> int:
    """Print the change of some gains of a controller."""
    rows = [
        [name, f"{change.previous[name]:g}", f"{change.values[name]:g}"]
        for name in names
    ]
    answer_table(options, change, ["gain", "before", "now"], rows)
    for note in () if options.json else notes:
        say(f"Note: {note}")
    return 0


def _export(client: "StationClient", options: Namespace) -> int:
    """Print or write the parameters of controllers, with their gains in force.

    Raises:
        UsageError: The file cannot be written.
    """
    text = ""
    with tempfile.TemporaryDirectory() as folder:
        for index, name in enumerate(dict.fromkeys([options.name, *options.words])):
            part = client.download_config(name, Path(folder) / f"{index}.yaml")
            text += part.read_text("utf-8")
    file = options.file
    if file is None:
        return answer(options, {"config": text}, text.rstrip("\n"))
    lines = [f"Wrote {file}."]
    try:
        # Written beside it first: a full disk must not cost the present file.
        draft = file.with_name(f"{file.name}.part")
        draft.write_text(text, "utf-8")
        if file.exists():
            file.replace(f"{file}~")
            lines.append(f"The file before is {file}~.")
        draft.replace(file)
    except OSError as error:
        raise UsageError(
            f"{file} cannot be written: {error.strerror}.", remedy="Name another file."
        ) from error
    return answer(options, {"file": str(file)}, *lines)


def _list(client: "StationClient", options: Namespace) -> int:
    names = client.gain_sets.names()
    return answer(options, names, *(names or ["No gain sets are saved."]))


def _save(client: "StationClient", options: Namespace) -> int:
    saved = client.gain_sets.save(options.name, options.words or None)
    count = sum(len(values) for values in saved.gains.values())
    names = ", ".join(saved.gains) or "no controller"
    return answer(options, saved, f"Saved {counted(count, 'gain')} of {names}.")


def _diff(client: "StationClient", options: Namespace) -> int:
    found = client.gain_sets.get(options.name)
    rows = [
        [one.controller, one.name, number(one.saved), number(one.present)]
        for one in found.differences
    ]
    headers = ["controller", "gain", "saved", "present"]
    nothing = f"The gain set {options.name} is in force."
    return answer_table(options, found.differences, headers, rows, nothing)


def _delete(client: "StationClient", options: Namespace) -> int:
    found = client.gain_sets.delete(options.name)
    return answer(options, found, f"Deleted the gain set {options.name}.")


def _load(client: "StationClient", options: Namespace) -> int:
    return _tell(client.gain_sets.apply(options.name, options.words or None), options)


def _undo(client: "StationClient", options: Namespace) -> int:
    return _tell(client.gain_sets.undo(), options)


def _tell(changes: Mapping[str, "GainsChange"], options: Namespace) -> int:
    """Print the changes of several controllers."""
    rows = [
        [controller, name, number(change.previous.get(name)), f"{value:g}"]
        for controller, change in changes.items()
        for name, value in change.values.items()
        if change.previous.get(name) != value
    ]
    headers = ["controller", "gain", "before", "now"]
    return answer_table(options, dict(changes), headers, rows, "No gain has changed.")


_ACTIONS: Mapping[str, tuple[Action, bool, str]] = {
    "show": (_show, True, "none"),
    "set": (_set, True, "some"),
    "list": (_list, False, "none"),
    "save": (_save, True, "any"),
    "load": (_load, True, "any"),
    "diff": (_diff, True, "none"),
    "export": (_export, True, "any"),
    "delete": (_delete, True, "none"),
    "undo": (_undo, False, "none"),
}
"""Function of each action, whether it needs a name, and which further words it takes.
"""


def _change(word: str) -> tuple[str, float]:
    return read_number(word, "panda_joint1/p=500")


def _bound(value: float | None) -> str:
    return number(value, "∞")
