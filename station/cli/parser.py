"""Parse the command line, with the arguments of the chosen verb only."""

import argparse
import importlib
import json
from collections.abc import Iterable, Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from typing_extensions import override

import station
from station.cli.errors import UsageError, failure_of, report
from station.cli.verbs import VERBS, Verb
from station.core.errors import show, suggest

DESCRIPTION = """\
Run a control station and talk to one. A verb may be written with dashes or underscores.
Exit codes: 0 done, 1 refused, 2 wrong usage.
"""
EPILOG = """\
A station on this machine is found by itself, with its token. For another one give --url
and --token, or set STATION_URL and STATION_TOKEN; for https, --ca or STATION_CA.
ROS 1 names work too: list, list-types, load, unload, start, spawn, kill; and stop NAME.
"""
ValueT = TypeVar("ValueT")
ROBOT = "example-robot-data:NAME or a URDF"
"""Help of an argument that names a robot by its URDF only."""


class Parser(argparse.ArgumentParser):
    """An `ArgumentParser` that suggests a name for an unknown verb or choice.

    Attributes:
        typed: What a user types for each argument, by its `dest`: the long option, or
            the word in the usage. An argument for a field of a request has the name of
            the field as its `dest`.
        is_for_programs: Whether `--json` was given, also for errors.
    """

    def __init__(self, **settings: Any) -> None:  # noqa: ANN401 - those of argparse
        self.typed: dict[str, str] = {}
        self.is_for_programs = False
        super().__init__(**settings)

    @override
    def add_argument(self, *names: str, **settings: Any) -> argparse.Action:
        action = super().add_argument(*names, **settings)
        word = action.metavar if isinstance(action.metavar, str) else action.dest
        self.typed[action.dest] = max(action.option_strings, key=len, default=word)
        return action

    @override
    def error(self, message: str) -> NoReturn:
        if not self.is_for_programs:
            super().error(message)
        usage = " ".join(self.format_usage().split())
        failure = failure_of(UsageError(f"{message.rstrip('.')}.", remedy=usage))
        if failure is not None:
            report(failure, as_json=True)
        raise SystemExit(2)

    @override
    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            known = [str(each) for each in action.choices]
            message = f"there is no {value!r}. {suggest(str(value), known)}"
            raise argparse.ArgumentError(action, message)


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Return the parsed arguments, with `run`, the function that carries out the verb.

    It imports only the module of the chosen verb, so that `station --help` and a stop
    do not wait for the others.

    Raises:
        SystemExit: Help was asked for, or the arguments are wrong.
    """
    parser = Parser(
        prog="station",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--version", action="version", version=f"station {station.__version__}"
    )
    parsers = parser.add_subparsers(metavar="VERB", required=True)
    word = next(iter(arguments), "")
    asked_for = [verb for verb in VERBS if word in {verb.name, *verb.aliases}]
    # Only help and the error about an unknown verb name the others.
    for verb in asked_for or VERBS:
        found = parsers.add_parser(
            verb.name,
            help=verb.summary,
            description=verb.summary,
            aliases=list(verb.aliases),
        )
        if asked_for:
            parser.is_for_programs = found.is_for_programs = "--json" in arguments
            _fill(found, verb)
    return parser.parse_args(arguments)


def _fill(parser: Parser, verb: Verb) -> None:
    """Add the arguments of a verb, and the function that carries it out."""
    module = importlib.import_module(f"station.cli.verbs.{verb.module}")
    parser.set_defaults(run=getattr(module, verb.name))
    parser.add_argument("--json", action="store_true", help="print JSON")
    if verb.is_client:
        parser.add_argument("--url", help="the station, e.g. http://127.0.0.1:8000")
        parser.add_argument("--token", help="its operator or viewer token")
        parser.add_argument(
            "--ca", metavar="FILE", help="the certificates to trust, for https"
        )
    add = getattr(module, f"add_{verb.name}", None)
    if add is not None:
        add(parser)
    parser.set_defaults(
        verb=verb.name, typed=parser.typed, default_of=parser.get_default
    )


def check_words(options: argparse.Namespace, uses: Mapping[str, str]) -> None:
    """Refuse the words and options that the chosen action has no use for.

    Args:
        options: Options of the verb; `action` is the chosen action.
        uses: The arguments that each action uses: their `dest`s, with spaces between.

    Raises:
        UsageError: A word or an option without a use was given.
    """
    used = uses[options.action].split()
    known = dict.fromkeys(dest for each in uses.values() for dest in each.split())
    for dest in known:
        value = getattr(options, dest)
        if dest in used or value in (None, [], options.default_of(dest)):
            continue
        raise UsageError(
            f"`{options.verb} {options.action}` has no use for "
            f"{options.typed[dest]} ({show(value)}).",
            remedy="Leave it out.",
        )


def unique(pairs: Iterable[tuple[str, ValueT]]) -> dict[str, ValueT]:
    """Return pairs of names and values as a dictionary.

    Raises:
        UsageError: A name is given twice, so that one of its values would not count.
    """
    found: dict[str, ValueT] = {}
    for name, value in pairs:
        if name in found:
            raise UsageError(
                f"'{name}' is given twice: {show(found[name])} and {show(value)}.",
                remedy="Give it once.",
            )
        found[name] = value
    return found


def read_json(text: str) -> Any:  # noqa: ANN401 - whatever JSON has
    """Return the value of a word: read as JSON if it is JSON, otherwise the text.

    Raises:
        UsageError: An object of the JSON has a key twice.
    """
    try:
        return json.loads(text, object_pairs_hook=unique)
    except UsageError:
        raise
    except (ValueError, RecursionError):
        return text


def read_count(text: str) -> int:
    """Return a number of things.

    Raises:
        ArgumentTypeError: The text is not a whole number above 0.
    """
    if not text.isdecimal() or int(text) == 0:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a number of things; it must be a whole number above 0."
        )
    return int(text)


def read_duration(text: str) -> float:
    """Return a duration [s].

    Raises:
        ArgumentTypeError: The text is not a finite number, or it is negative.
    """
    try:
        duration = float(text)
    except ValueError:
        duration = -1.0
    if not 0.0 <= duration < inf:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a duration; it must be a finite number of seconds, not "
            "negative."
        )
    return duration


def read_number(word: str, example: str = "load=1.5") -> tuple[str, float]:
    """Return name and value of `NAME=VALUE`.

    Raises:
        UsageError: The text is malformed.
    """
    name, equals, text = word.rpartition("=")
    try:
        return name, float(text if equals and name else "no number")
    except ValueError as error:
        raise UsageError(
            f"{word!r} is not NAME=VALUE with a number.",
            remedy=f"Write it like {example}.",
        ) from error


def add_controllers(parser: Parser, text: str) -> None:
    """Add the option `--controllers` with files of parameters.

    Args:
        parser: Parser of the verb.
        text: Help.
    """
    parser.add_argument(
        "--controllers",
        nargs="+",
        action="extend",
        default=[],
        type=Path,
        metavar="ROS_PARAMS.yaml",
        help=text,
    )


def add_base(parser: Parser) -> None:
    """Add the option `--base`: how the root link of a robot is held."""
    parser.add_argument(
        "--base",
        choices=("fixed", "floating", "planar"),
        default="fixed",
        help="how the root link of the robot is held, if its file does not say it",
    )
