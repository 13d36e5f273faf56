"""Arguments that name a robot of which only the URDF is known."""

from typing import TYPE_CHECKING

from station.cli.parser import Parser

if TYPE_CHECKING:
    from station.cli.arguments import Verbs

_ROBOT = "example-robot-data:NAME or a URDF"


def add_robot_options(run: Parser) -> None:
    """Let `run` take a robot instead of a configuration."""
    run.add_argument(
        "--robot",
        metavar="ROBOT",
        help=f"simulate this robot with controllers made for it: {_ROBOT}",
    )
    add_base(run)


def add_base(parser: Parser) -> None:
    """Add how the root link of a robot is held of which only the URDF is known."""
    parser.add_argument(
        "--base",
        choices=("fixed", "floating", "planar"),
        default="fixed",
        help="how the root link of the robot is held, if its file does not say it",
    )


def add_robot_verbs(verbs: "Verbs") -> None:
    """Add `doctor` and `fetch_robot`."""
    doctor = verbs.add(
        "doctor",
        "doctor:doctor",
        "say whether this machine is fit for a station, or what a robot needs",
        is_client=False,
    )
    doctor.add_argument(
        "robot", nargs="?", metavar="ROBOT", help=f"look at this robot: {_ROBOT}"
    )
    add_base(doctor)
    summary = "fetch the Panda, as `run` does"
    verbs.add("fetch_robot", "robot_data:fetch_robot", summary, is_client=False)
