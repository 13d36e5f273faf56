"""Parse the command line, run the verb, turn what went wrong into an exit code.

Modules that take long to import are imported when a verb needs them, so that
`station --help` answers at once.
"""

import importlib
import json
import os
import re
import sys
from argparse import Namespace
from collections.abc import Callable, Sequence
from decimal import Decimal
from typing import Any

from station.cli.arguments import build_parser
from station.cli.errors import Failure, failure_of

DONE, REFUSED, WRONG_USAGE, INTERRUPTED = 0, 1, 2, 130
_NEGATIVE_NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code.

    Args:
        argv: The arguments after the program's name; the process's own when None.

    Returns:
        0 done, 1 refused, 2 wrong usage, 130 interrupted.
    """
    arguments = normalise(sys.argv[1:] if argv is None else argv)
    parser = build_parser()
    try:
        options = parser.parse_args(arguments)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else WRONG_USAGE
    try:
        return _handler(options.handler)(options)
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of the output is gone; without this, Python would report the
        # broken pipe once more when it flushes at its exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        failure = failure_of(error)
        if failure is None:
            raise
        report(failure, as_json=options.json)
        return WRONG_USAGE if failure.is_usage else REFUSED


def normalise(argv: Sequence[str]) -> list[str]:
    """Return the arguments in the form that the parser expects.

    A verb may be written with dashes; negative numbers lose the exponent, which
    argparse takes for an option.
    """
    arguments = [
        f"{Decimal(a):f}" if _NEGATIVE_NUMBER.fullmatch(a) else a for a in argv
    ]
    if arguments and not arguments[0].startswith("-"):
        arguments[0] = arguments[0].replace("-", "_")
    return arguments


def report(failure: Failure, *, as_json: bool) -> None:
    """Write to stderr what went wrong and what to do."""
    if as_json:
        sys.stderr.write(json.dumps(failure.as_problem()) + "\n")
        return
    sys.stderr.write(f"error: {failure.detail}\n")
    if failure.remedy:
        sys.stderr.write(f"{failure.remedy}\n")


def _handler(name: str) -> Callable[[Namespace], int]:
    module, _, function = name.partition(":")
    handler: Any = getattr(importlib.import_module(module), function)
    return handler  # type: ignore[no-any-return]  # the table in arguments.py
