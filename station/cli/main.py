"""Parse the command line, run the verb, turn an error into an exit code.

Slow imports are made by the function of the verb that needs them, so that
help and wrong usage are answered at once.
"""

import json
import os
import re
import sys
from collections.abc import Sequence
from decimal import Decimal

from station.cli.errors import Failure, failure_of
from station.cli.parser import parse

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
    try:
        options = parse(arguments)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else WRONG_USAGE
    try:
        code: int = options.run(options)
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
    return code


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
    """Write an error and its remedy to stderr."""
    if as_json:
        sys.stderr.write(json.dumps(failure.as_problem()) + "\n")
        return
    sys.stderr.write(f"error: {failure.detail}\n")
    if failure.remedy:
        sys.stderr.write(f"{failure.remedy}\n")
