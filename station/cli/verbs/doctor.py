"""Verb `doctor`: check this machine, or examine the description of a robot."""

from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.machine_checks import CHECKS
from station.cli.output import answer_table, say, say_progress
from station.cli.parser import ROBOT, add_base

if TYPE_CHECKING:
    from station.cli.parser import Parser


def add_doctor(parser: "Parser") -> None:
    """Add the arguments of `doctor`."""
    parser.add_argument(
        "robot", nargs="?", metavar="ROBOT", help=f"look at this robot: {ROBOT}"
    )
    add_base(parser)


def doctor(options: Namespace) -> int:
    """Print findings and advice; return 1 when a station cannot run here."""
    if options.robot is not None:
        return _examine(options)
    findings = [check() for check in CHECKS]
    rows = [[f.check, f.state, f.finding] for f in findings]
    answer_table(options, findings, ["check", "state", "finding"], rows)
    for finding in () if options.json else findings:
        if finding.advice:
            say(f"{finding.check}: {finding.advice}")
    return int(any(finding.state == "problem" for finding in findings))


def _examine(options: Namespace) -> int:
    """Print the differences of a simulated robot from its description.

    Raises:
        RobotDescriptionError: The robot is unknown or cannot be simulated.
    """
    from station.app.any_robot import examine_robot
    from station.app.panda_fetch import fetch_what_is_missing

    fetch_what_is_missing({"robot_description": options.robot}, say_progress)
    repairs = examine_robot(options.robot, options.base)
    headers = ["element", "what is wrong", "was", "now"]
    rows = [[r.element, r.problem, r.old or "-", r.new] for r in repairs]
    nothing = "This robot is simulated as it is described."
    return answer_table(options, repairs, headers, rows, nothing)
