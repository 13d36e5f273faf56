"""Verb `fci check`: check a robot's side of the Franka Control Interface.

The checks are tests of pytest, which runs as a process of its own. Their results are
the matrix on the terminal and the report.
"""

import json
import os
import subprocess
import sys
import tempfile
from argparse import ArgumentTypeError, Namespace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.errors import UsageError
from station.cli.output import say_json

if TYPE_CHECKING:
    from station.cli.parser import Parser

CHECK = Path("check")
"""Word in the place of a configuration; write a file of this name as `./check`."""
_SUITE = "station.testing.fci_conformance"
_NO_ENDPOINT = 4  # pytest's code for wrong usage: no answer, or no known version
_HIGHEST_PORT = 65_535
# Words and options that only the check, or only the server has.
_OF_CHECK = ("address", "move", "port", "report")
_OF_SERVER = ("host", "patience", "desk")


def add_check(parser: "Parser") -> None:
    """Add the arguments of `fci check`."""
    parser.add_argument("address", nargs="?", metavar="ADDRESS", help="of the arm")
    group = parser.add_argument_group("of `check ADDRESS`")
    group.add_argument(
        "--move",
        action="store_true",
        help="THE ARM MOVES AND IS STOPPED BY ERRORS ON PURPOSE: it turns joint 7 into "
        "its end, folds until it nearly touches itself, and jerks. On a real arm "
        "clear its whole reach, take the user stop in your hand, and take off what it "
        "carries. Without this the checks read, and move nothing",
    )
    group.add_argument("--port", type=port_number, help="TCP port; default 1337")
    group.add_argument(
        "--report", type=Path, metavar="FILE.json", help="write the matrix as JSON, too"
    )


def port_number(text: str) -> int:
    """Return a TCP port.

    Raises:
        ArgumentTypeError: The text is not a number from 0 to 65535.
    """
    if not text.isdecimal() or int(text) > _HIGHEST_PORT:
        raise ArgumentTypeError(f"{text!r} is no port, 0 to {_HIGHEST_PORT}")
    return int(text)


def refuse_other_options(options: Namespace) -> None:
    """Refuse options of the server in a check, and options of a check for the server.

    Raises:
        UsageError: Such an option was given.
    """
    is_check = options.config == CHECK
    verbs = "station fci", "station fci check ADDRESS"
    for name in _OF_SERVER if is_check else _OF_CHECK:
        if getattr(options, name) != options.default_of(name):
            word = "ADDRESS" if name == "address" else f"--{name}"
            raise UsageError(
                f"`{verbs[is_check]}` has no {word}.",
                remedy=f"{word} belongs to `{verbs[not is_check]}`.",
            )


def check(options: Namespace) -> int:
    """Run the checks; return 0 if none has failed.

    Raises:
        UsageError: No address was given, the report has no folder, or pytest is not
            installed.
    """
    if options.address is None:
        raise UsageError(
            "`station fci check` needs the address of an arm.",
            remedy="station fci check 127.0.0.1",
        )
    if options.report is not None and not options.report.absolute().parent.is_dir():
        raise UsageError(
            f"The report {options.report} has no folder.", remedy="Make it first."
        )
    if find_spec("pytest") is None:
        raise UsageError(
            "The checks are tests of pytest, which is not installed.",
            remedy="Install it: pip install pytest.",
        )
    # A configuration of pytest in the present folder is meant for other tests, so the
    # checks run in a folder of their own.
    with tempfile.TemporaryDirectory() as folder:
        report = (options.report or Path(folder, "report.json")).absolute()
        output = subprocess.DEVNULL if options.json else None
        command = _command(options, report)
        run = subprocess.run(command, cwd=folder, stdout=output, check=False)
        if run.returncode == _NO_ENDPOINT:
            return 1
        if options.json:
            say_json(json.loads(report.read_text(encoding="utf-8")))
    return run.returncode


def _command(options: Namespace, report: Path) -> list[str]:
    values = {"--fci-port": options.port, "--fci-version": options.version}
    given = [f"{key}={value}" for key, value in values.items() if value is not None]
    return [
        *(sys.executable, "-m", "pytest", "-c", os.devnull, "-p", "no:cacheprovider"),
        *("-p", f"{_SUITE}.plugin", "--pyargs", _SUITE),
        # Not --no-summary: up to pytest 9.0 it keeps the matrix back as well.
        *("-q", "--no-header", "--tb=no", "-rN", "--disable-warnings"),
        *("--fci", options.address, f"--fci-report={report}", *given),
        *(["--fci-move"] if options.move else []),
    ]
