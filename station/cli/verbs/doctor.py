"""Verbs `doctor` and `validate`: check this machine, and a robot."""

from argparse import Namespace
from pathlib import Path
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


CONFIGURATIONS = frozenset({".yaml", ".yml"})
"""Endings of files that configure a station; everything else names a robot."""


def add_validate(parser: "Parser") -> None:
    """Add the arguments of `validate`."""
    add = parser.add_argument
    add(
        "robot",
        metavar="ROBOT",
        help="example-robot-data:NAME, a URDF, or the configuration of a station",
    )
    add_base(parser)
    add(
        "controllers",
        nargs="*",
        default=[],
        type=Path,
        metavar="ROS_PARAMS.yaml",
        help="parameter files written for ROS",
    )
    add("--page", type=Path, metavar="FILE.html", help="write the scorecard as a page")


def validate(options: Namespace) -> int:
    """Check a robot and its controllers."""
    from station.experiments.validation import validate as check_robot
    from station.trials.trial import Setup

    config = Path(options.robot)
    if config.suffix in CONFIGURATIONS:
        setup = Setup.load(config, controllers=options.controllers)
    else:
        setup = Setup.load(_robot_of(options), controllers=options.controllers)
    card = check_robot(setup, config.name)
    if options.page is not None:
        options.page.write_text(card.to_html(), encoding="utf-8")
    rows = [[check.name, check.outcome, check.detail] for check in card.checks]
    answer_table(options, card.checks, ["check", "outcome", "what was seen"], rows)
    return 0 if card.is_good else 1


def _robot_of(options: Namespace) -> dict[str, object]:
    """Return the configuration of a robot that is given by its URDF only.

    It has the controllers of `run --robot`, unless files of controllers are given.

    Raises:
        RobotDescriptionError: The robot is unknown or cannot be simulated.
    """
    from station.app.any_robot import configure_robot
    from station.app.panda_fetch import fetch_what_is_missing
    from station.core.description.robot_files import PACKAGE_SCHEME

    reference = options.robot
    if not reference.startswith(PACKAGE_SCHEME):
        reference = str(Path(reference).resolve())
    fetch_what_is_missing({"robot_description": reference}, say_progress)
    found = configure_robot(reference, options.base)
    return {"robot": found["robot"]} if options.controllers else found
