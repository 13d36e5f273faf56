"""The command line `station`: run a verb, and turn an error into an exit code.

The function of a verb makes its own slow imports, so that help and errors of usage
appear at once.
"""

import gc
import os
import re
import sys
from collections.abc import Sequence
from decimal import Decimal

from station.cli.errors import failure_of, report
from station.cli.parser import parse
from station.core.scheduling import GC_THRESHOLDS

DONE, REFUSED, WRONG_USAGE, INTERRUPTED = 0, 1, 2, 130
_NEGATIVE_NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code.

    Args:
        argv: The arguments after the program's name; None for those of the process.

    Returns:
        0 done, 1 refused, 2 wrong usage, 130 interrupted.
    """
    arguments = normalise(sys.argv[1:] if argv is None else argv)
    try:
        options = parse(arguments)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else WRONG_USAGE
    # Imported modules stay, and searching them for garbage takes a tenth of the start.
    gc.set_threshold(*GC_THRESHOLDS)
    try:
        code: int = options.run(options)
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        # The reader of the output has closed it. Without this line Python would report
        # the broken pipe once more when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
    except Exception as error:
        failure = failure_of(error, options.typed)
        if failure is None:
            raise
        report(failure, as_json=options.json)
        return WRONG_USAGE if failure.is_usage else REFUSED
    return code


def normalise(argv: Sequence[str]) -> list[str]:
    """Return the arguments in the form that the parser expects.

    A verb may be written with dashes. Negative numbers are written without an exponent,
    because argparse would take them for options.
    """
    arguments = [
        f"{Decimal(a):f}" if _NEGATIVE_NUMBER.fullmatch(a) else a for a in argv
    ]
    if arguments and not arguments[0].startswith("-"):
        arguments[0] = arguments[0].replace("-", "_")
    return arguments
