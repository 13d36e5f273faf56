"""The verbs of experiments: many trials of a simulated station of their own."""

from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.robot_arguments import add_base

if TYPE_CHECKING:
    from station.cli.arguments import Verbs
    from station.cli.parser import Parser

METRIC = "a metric such as rms_error, effort_rms or settling_time"


def add_experiment_verbs(verbs: "Verbs") -> None:
    """Add `sweep`, `robustness`, `tune`, `identify`, `validate` and `experiments`."""
    _add_sweep(verbs)
    _add_tune(verbs)
    _add_identify(verbs)
    validate = verbs.add(
        "validate",
        "validate:validate",
        "check a robot and its controllers; exit code 1 when a check fails",
        is_client=False,
    )
    validate.add_argument(
        "robot",
        metavar="ROBOT",
        help="example-robot-data:NAME, a URDF, or the configuration of a station",
    )
    add_base(validate)
    _add_controllers(validate, "*")
    validate.add_argument(
        "--page", type=Path, metavar="FILE.html", help="write the scorecard as a page"
    )
    _add_experiments(verbs)


def _add_controllers(parser: "Parser", count: str) -> None:
    parser.add_argument(
        "controllers",
        nargs=count,
        default=[],
        type=Path,
        metavar="ROS_PARAMS.yaml",
        help="parameter files written for ROS",
    )


def _add_setup(parser: "Parser") -> None:
    """Add what says which station the trials have, and what they do."""
    parser.add_argument(
        "--config", type=Path, metavar="CONFIG.yaml", help="a station's configuration"
    )
    parser.add_argument(
        "--controllers",
        nargs="+",
        action="extend",
        default=[],
        type=Path,
        metavar="ROS_PARAMS.yaml",
        help="parameter files written for ROS",
    )
    parser.add_argument(
        "--script",
        type=Path,
        metavar="SCRIPT.yaml",
        help="what happens in a trial, or a recording (.mcap) whose set-points are "
        "given again; without it all joints move to and fro for 2 s",
    )
    parser.add_argument(
        "--with",
        dest="parameters",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME=VALUE",
        help="parameters of every trial, e.g. load=1.5 scale/CONTROLLER/p=0.2",
    )


def _add_running(parser: "Parser") -> None:
    """Add what says where trials run and where their results go."""
    parser.add_argument("--name", help="name of the experiment; without it: a new one")
    parser.add_argument(
        "--workers", type=int, metavar="N", help="processes; one per processor"
    )
    parser.add_argument(
        "--cluster", metavar="tcp://HOST:8786", help="a scheduler of Dask instead"
    )
    parser.add_argument("--seed", type=int, default=1, help="seed of all chance")
    parser.add_argument(
        "--background",
        action="store_true",
        help="let the running station do it, and come back at once",
    )


def _add_sweep(verbs: "Verbs") -> None:
    for name, summary, count in (
        ("sweep", "run a trial for each of many values of parameters", 100),
        ("robustness", "run trials under chance loads, friction and delays", 500),
    ):
        parser = verbs.add(name, f"experiments:{name}", summary)
        parser.add_argument("controller", metavar="CONTROLLER")
        parser.add_argument(
            "ranges",
            nargs="+" if name == "sweep" else "*",
            metavar="NAME=LOW:HIGH",
            help="or NAME=LOW:HIGH:COUNT, or NAME=A,B,C"
            + ("" if name == "sweep" else "; load=0:3 friction=0.25:0.75 delay=0:3"),
        )
        parser.add_argument("--trials", type=int, default=count, metavar="N")
        if name == "sweep":
            parser.add_argument(
                "--method",
                choices=("grid", "random", "halton", "sobol"),
                default="halton",
                help="how the values are spread",
            )
        else:
            parser.add_argument(
                "--keep-worst", type=int, default=3, metavar="N", help="recordings"
            )
        parser.add_argument("--metric", default="rms_error", help=METRIC)
        _add_setup(parser)
        _add_running(parser)


def _add_tune(verbs: "Verbs") -> None:
    tune = verbs.add("tune", "experiments:tune", "search for better gains with CMA-ES")
    tune.add_argument("controller", metavar="CONTROLLER")
    tune.add_argument("--trials", type=int, default=300, metavar="N")
    tune.add_argument(
        "--gains",
        nargs="+",
        default=["p", "i", "d"],
        metavar="SUFFIX",
        help="which gains may change: p i d, or panda_joint1/p",
    )
    tune.add_argument(
        "--weight",
        nargs="+",
        action="extend",
        default=[],
        metavar="METRIC=W",
        help="what is to become small, relative to the first trial; rms_error=1",
    )
    tune.add_argument(
        "--at-most",
        nargs="+",
        action="extend",
        default=[],
        metavar="METRIC=B",
        help="hard bounds, 1.1x: of the first trial; effort_rms=1x effort_peak=1x "
        "violations=0",
    )
    tune.add_argument(
        "--live", action="store_true", help="begin with the gains of a running station"
    )
    _add_setup(tune)
    _add_running(tune)


def _add_identify(verbs: "Verbs") -> None:
    identify = verbs.add(
        "identify",
        "identification:identify",
        "fit friction and inertia of a joint to a motion",
        is_client=False,
    )
    identify.add_argument("joint", metavar="JOINT")
    identify.add_argument(
        "--recording",
        type=Path,
        metavar="FILE.mcap",
        help="a recording of a station, or FILE.npz of --record",
    )
    identify.add_argument(
        "--controller",
        default="effort_group_position_controller",
        help="what moves the joint in a simulation, when there is no recording",
    )
    identify.add_argument(
        "--amplitude", type=float, default=0.2, metavar="A", help="[rad or m]"
    )
    identify.add_argument(
        "--record", type=Path, metavar="FILE.npz", help="keep the simulated motion"
    )
    _add_setup(identify)


def _add_experiments(verbs: "Verbs") -> None:
    experiments = verbs.add(
        "experiments",
        "experiment_results:experiments",
        "look at, watch, cancel, draw, compare, replay, export and apply experiments",
    )
    experiments.add_argument(
        "action",
        choices=(
            *("list", "show", "plot", "best", "apply", "export", "compare"),
            *("replay", "watch", "cancel"),
        ),
    )
    experiments.add_argument("name", nargs="?", metavar="NAME", help="the experiment")
    experiments.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="plot, export: a file; apply: a trial's hash, the best when left out; "
        "replay: one likewise, the worst when left out; compare: another experiment",
    )
    experiments.add_argument(
        "--metric", nargs="+", action="extend", default=[], help=METRIC
    )
    experiments.add_argument(
        "--kind", choices=("parallel", "pareto", "responses"), default="pareto"
    )
    experiments.add_argument(
        "--yes", action="store_true", help="apply: do it; without it: only show it"
    )
    experiments.add_argument(
        "--yaml", type=Path, metavar="FILE", help="apply: write the gains to a file"
    )
    experiments.add_argument(
        "--count", type=int, default=5, help="best: how many trials"
    )
