"""Parse the command line, with the arguments of the chosen verb only."""

import argparse
import importlib
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any

from typing_extensions import override

import station
from station.cli.errors import UsageError
from station.cli.verbs import VERBS, Verb
from station.core.errors import suggest

DESCRIPTION = """\
Run a control station and talk to one. A verb may be written with dashes or underscores.
Exit codes: 0 done, 1 refused, 2 wrong usage.
"""
EPILOG = """\
A station on this machine is found by itself, with its token. For another one give --url
and --token, or set STATION_URL and STATION_TOKEN; for https, --ca or STATION_CA.
ROS 1 names work too: list, list-types, load, unload, start, spawn, kill; and stop NAME.
"""
ROBOT = "example-robot-data:NAME or a URDF"
"""Help of an argument that names a robot by its URDF only."""


class Parser(argparse.ArgumentParser):
    """An `ArgumentParser` that suggests a name for an unknown verb or choice.

    Attributes:
        typed: What a user types for each argument, by its `dest`: the long option, or
            the word in the usage. An argument for a field of a request has the name of
            the field as its `dest`.
    """

    def __init__(self, **settings: Any) -> None:  # noqa: ANN401 - those of argparse
        self.typed: dict[str, str] = {}
        super().__init__(**settings)

    @override
    def add_argument(self, *names: str, **settings: Any) -> argparse.Action:
        action = super().add_argument(*names, **settings)
        word = action.metavar if isinstance(action.metavar, str) else action.dest
        self.typed[action.dest] = max(action.option_strings, key=len, default=word)
        return action

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
    for verb in VERBS:
        found = parsers.add_parser(
            verb.name,
            help=verb.summary,
            description=verb.summary,
            aliases=list(verb.aliases),
        )
        if arguments and arguments[0] in {verb.name, *verb.aliases}:
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
    parser.set_defaults(typed=parser.typed)


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
