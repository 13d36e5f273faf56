"""Verb `parameters`: the tree from which controllers are loaded, like rosparam."""

from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, say_json
from station.cli.parser import read_json

if TYPE_CHECKING:
    from pydantic import JsonValue

    from station.cli.parser import Parser


def add_parameters(parser: "Parser") -> None:
    """Add the arguments of `parameters`."""
    add = parser.add_argument
    add("action", choices=("get", "set", "delete"))
    add("path", nargs="?", default="", metavar="PATH", help="e.g. arm/gains/j1/p")
    add("value", nargs="?", metavar="VALUE", help="JSON, such as 0.5 or [1,2], or text")


def parameters(options: Namespace) -> int:
    """Print, set or delete a parameter.

    Raises:
        UsageError: There are too few or too many words.
    """
    takes_value = options.action == "set"
    is_named = bool(options.path.strip("/")) or options.action == "get"
    if takes_value != (options.value is not None) or not is_named:
        raise UsageError(
            f"The words after `parameters {options.action}` are too few or too many.",
            remedy="station parameters get [PATH], set PATH VALUE, delete PATH.",
        )
    with open_client(options) as client:
        if options.action == "set":
            value: JsonValue = read_json(options.value)
            client.set_parameter(options.path, value)
            answer(options, value, "Done.")
        elif options.action == "delete":
            say_json(client.delete_parameter(options.path))
        else:
            say_json(client.parameter(options.path))
    return 0
