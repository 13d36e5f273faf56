"""All verbs of the command line, with the function that does each."""

import argparse
from pathlib import Path

import station
from station.cli.access_arguments import add_access_verbs
from station.cli.experiment_arguments import add_experiment_verbs
from station.cli.fci_arguments import add_fci_verb
from station.cli.gripper_arguments import add_gripper_verb
from station.cli.parser import Parser
from station.cli.record_arguments import add_foxglove_option, add_record_verbs
from station.cli.robot_arguments import add_robot_options, add_robot_verbs
from station.cli.tuning_arguments import add_tuning_verbs

DESCRIPTION = """\
Run a control station and talk to one. A verb may be written with dashes or underscores.
Exit codes: 0 done, 1 refused, 2 wrong usage.
"""
EPILOG = """\
A station on this machine is found by itself, with its token. For another one give --url
and --token, or set STATION_URL and STATION_TOKEN; for https, --ca or STATION_CA.
ROS 1 names work too: list, list-types, load, unload, start, spawn, kill; and stop NAME.
"""
VERBS = "station.cli.verbs"


def build_parser() -> Parser:
    """Return the parser of the whole command line."""
    parser = Parser(
        prog="station",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--version", action="version", version=f"station {station.__version__}"
    )
    verbs = Verbs(parser)
    _add_station_verbs(verbs)
    _add_controller_verbs(verbs)
    _add_switch_verbs(verbs)
    add_tuning_verbs(verbs)
    _add_motion_verbs(verbs)
    add_gripper_verb(verbs)
    _add_simulation_verbs(verbs)
    add_record_verbs(verbs)
    _add_robot(verbs)
    add_access_verbs(verbs)
    add_experiment_verbs(verbs)
    return parser


class Verbs:
    """Adds verbs to a parser."""

    def __init__(self, parser: Parser) -> None:
        self._parsers = parser.add_subparsers(metavar="VERB", required=True)

    def add(
        self,
        name: str,
        handler: str,
        summary: str,
        *,
        aliases: tuple[str, ...] = (),
        is_client: bool = True,
    ) -> Parser:
        """Add one verb.

        Args:
            name: The verb.
            handler: `module:function` below `station.cli.verbs`.
            summary: What it does, in the imperative.
            aliases: Other names.
            is_client: Whether it talks to a running station.
        """
        parser = self._parsers.add_parser(
            name, help=summary, description=summary, aliases=list(aliases)
        )
        parser.set_defaults(handler=f"{VERBS}.{handler}")
        parser.add_argument("--json", action="store_true", help="print JSON")
        if is_client:
            parser.add_argument("--url", help="the station, e.g. http://127.0.0.1:8000")
            parser.add_argument("--token", help="its operator or viewer token")
            parser.add_argument(
                "--ca", metavar="FILE", help="the certificates to trust, for https"
            )
        return parser


def _add_station_verbs(verbs: Verbs) -> None:
    run = verbs.add("run", "run:run", "run a station until Ctrl-C", is_client=False)
    run.add_argument("config", nargs="?", type=Path, metavar="CONFIG.yaml")
    run.add_argument(
        "--controllers",
        nargs="+",
        action="extend",
        default=[],
        type=Path,
        metavar="ROS_PARAMS.yaml",
        help="parameter files written for ROS, unchanged; their controllers are loaded",
    )
    add_robot_options(run)
    run.add_argument("--rate", type=float, metavar="HZ", help="control loop rate")
    run.add_argument("--host", help="address to listen at; others need --token")
    run.add_argument("--port", type=int, help="port of the API; 0: any free one")
    run.add_argument("--ui-port", type=int, help="port of the dashboard; 0: likewise")
    add_foxglove_option(run)
    run.add_argument("--no-ui", action="store_true", help="run without dashboard")
    run.add_argument(
        "--token",
        help="the operator's token; random if left out. Others on this machine can "
        "read it in the list of processes: STATION_API__TOKEN is more private",
    )
    run.add_argument(
        "--allowed-origin",
        action="append",
        dest="allowed_origins",
        metavar="ORIGIN",
        help="a web page elsewhere that may use the API, e.g. https://lab.example; may "
        "be repeated",
    )
    run.add_argument(
        "--tls-cert", metavar="FILE", help="serve https and wss with this certificate"
    )
    run.add_argument("--tls-key", metavar="FILE", help="the key of --tls-cert")
    run.add_argument(
        "--real-time-factor",
        type=float,
        metavar="X",
        help="station over wall time, 0.01 to 100",
    )
    run.add_argument(
        "--log-format",
        choices=("text", "json"),
        default="text",
        help="json: one object per line, requests that change something among them",
    )
    add_fci_verb(verbs)
    ui = verbs.add("ui", "ui:ui", "run the dashboard alone, for any station")
    ui.add_argument("--connect", metavar="URL", help="the same as --url")
    ui.add_argument("--host", default="127.0.0.1", help="address to listen at")
    ui.add_argument("--port", type=int, default=8080, help="0: any free one")
    ui.add_argument(
        "--robot-description",
        default="example-robot-data:panda",
        help="what to draw: example-robot-data:NAME or a URDF",
    )
    ui.add_argument("--arm-id", default="panda", help="prefix of the joint names")
    ui.add_argument(
        "--base",
        type=float,
        nargs=6,
        default=(0.0,) * 6,
        metavar=("X", "Y", "Z", "ROLL", "PITCH", "YAW"),
        help="where the robot stands [m], [rad]",
    )
    # Given by `station run`: whom the dashboard follows, and how long without one.
    hidden = argparse.SUPPRESS
    ui.add_argument("--parent-pid", type=int, help=hidden)
    ui.add_argument("--watchdog", default="", help=hidden)
    ui.add_argument("--base-moves", action="store_true", help=hidden)
    ui.add_argument("--beside", default="[]", help=hidden)
    ui.add_argument("--reconnect-window", type=float, default=60.0, help=hidden)
    add_robot_verbs(verbs)


def _add_controller_verbs(verbs: Verbs) -> None:
    listing = verbs.add(
        "list_controllers",
        "controllers:list_controllers",
        "list the loaded controllers",
        aliases=("list",),
    )
    listing.add_argument(
        "--claimed-interfaces", action="store_true", help="what each claims"
    )
    listing.add_argument(
        "-v", "--verbose", action="store_true", help="claims, loop time and faults"
    )
    types = verbs.add(
        "list_controller_types",
        "controllers:list_controller_types",
        "list what can be loaded, or the parameters of one type",
        aliases=("list_types",),
    )
    types.add_argument(
        "type", nargs="?", metavar="TYPE", help="list the parameters of this type"
    )
    hardware = verbs.add(
        "list_hardware_interfaces",
        "hardware:list_hardware_interfaces",
        "list what can be claimed and who claims it",
    )
    hardware.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="limits, repairs, clamps and more",
    )
    load = verbs.add(
        "load_controller",
        "controllers:load_controller",
        "load a controller, without starting it",
        aliases=("load",),
    )
    load.add_argument("name")
    source = "ROS parameter file with its parameters; else the station's configuration"
    load.add_argument(
        "param_file", nargs="?", type=Path, metavar="PARAM_FILE", help=source
    )
    load.add_argument("--type", help="its type, when no parameters say it")
    load.add_argument(
        "--load-timeout", type=float, metavar="S", help="longest init [s]"
    )
    unload = verbs.add(
        "unload_controller",
        "controllers:unload_controller",
        "unload a controller that is not running",
        aliases=("unload",),
    )
    unload.add_argument("name")


def _add_switch_verbs(verbs: Verbs) -> None:
    switch = verbs.add(
        "switch_controllers",
        "switching:switch_controllers",
        "start and stop controllers in one cycle",
    )
    switch.add_argument("--activate", nargs="+", action="extend", default=[])
    switch.add_argument("--deactivate", nargs="+", action="extend", default=[])
    strictness = switch.add_mutually_exclusive_group()
    strictness.add_argument("--strict", action="store_true", help="all or nothing")
    strictness.add_argument(
        "--best-effort", action="store_true", help="do what is possible"
    )
    switch.add_argument("--activate-asap", action="store_true")
    switch.add_argument("--switch-timeout", type=float, default=0.0, metavar="S")
    bound = "longest switch without a timeout, s; inf: no limit"
    switch.add_argument("--switch-bound", type=float, metavar="S", help=bound)
    switch.add_argument("--dry-run", action="store_true", help="only say what would be")
    for name, summary, aliases in (
        ("start", "start loaded controllers", ()),
        (
            "spawn",
            "load and start controllers of the station's configuration",
            ("spawner",),
        ),
        ("kill", "stop and unload controllers", ()),
    ):
        verb = verbs.add(name, f"switching:{name}", summary, aliases=aliases)
        verb.add_argument("names", nargs="+", metavar="NAME")


def _add_simulation_verbs(verbs: Verbs) -> None:
    verbs.add("pause", "simulation:pause", "let simulated time stand still")
    verbs.add("resume", "simulation:resume", "let simulated time pass again")
    step = verbs.add("step", "simulation:step", "run some cycles while paused")
    step.add_argument("n", nargs="?", type=int, default=1, metavar="N")
    reset = verbs.add(
        "reset",
        "simulation:reset",
        "put the simulated world back to its start; running controllers start anew",
    )
    reset.add_argument(
        "positions",
        nargs="*",
        type=_joint_position,
        metavar="JOINT=POSITION",
        help="where a joint goes [rad or m], e.g. panda_joint1=0.5",
    )
    reset.add_argument("--keyframe", metavar="POSE", help="a pose to start at")


def _joint_position(text: str) -> tuple[str, float]:
    """Return a joint and its position.

    Raises:
        ArgumentTypeError: The text has another form.
    """
    name, _, number = text.partition("=")
    try:
        return name, float(number)
    except ValueError as error:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not JOINT=POSITION, such as panda_joint1=0.5."
        ) from error


def _add_motion_verbs(verbs: Verbs) -> None:
    echo = verbs.add("echo", "streams:echo", "print what a topic says, until Ctrl-C")
    echo.add_argument("topic", help="joint_states, robot_state, controllers, loop, …")
    echo.add_argument("--rate", metavar="HZ", help="samples per second, or `full`")
    echo.add_argument("--fields", metavar="A,B", help="only these fields")
    echo.add_argument("-n", "--count", type=int, help="stop after so many")
    command = verbs.add("command", "motion:command", "send a controller a set-point")
    command.add_argument("controller")
    command.add_argument("values", nargs="+", type=float, metavar="V")
    goto = verbs.add(
        "goto", "goto:goto", "move to a pose, or a controller's joints, and wait"
    )
    goto.add_argument("name", help="a pose, e.g. `ready`, or a trajectory controller")
    goto.add_argument(
        "values", nargs="*", type=float, metavar="V", help="positions [rad or m]"
    )
    goto.add_argument(
        "--duration", type=float, metavar="S", help="without it: a calm one"
    )
    stop = verbs.add(
        "stop",
        "motion:stop",
        "stop the robot and let nothing move until released. With the names of loaded "
        "controllers: stop these alone. Any other word stops the robot",
    )
    stop.add_argument("names", nargs="*", metavar="NAME")
    stop.add_argument("--reason", default="", help="for the record")
    recover = verbs.add(
        "recover", "motion:recover", "clear the errors of an arm in reflex"
    )
    recover.add_argument("arm_id", nargs="?", help="default: all arms")
    recover.add_argument(
        "--restart",
        action="store_true",
        help="start the controllers again that the error stopped",
    )
    release = verbs.add(
        "release", "motion:release", "take back a stop; nothing resumes by itself"
    )
    release.add_argument(
        "--arm", action="store_true", help="second step: allow motion again"
    )


def _add_robot(verbs: Verbs) -> None:
    robot = verbs.add(
        "robot", "robot:robot", "list the services of a robot, or call one of them"
    )
    robot.add_argument("arm_id", metavar="ROBOT", help="name of the robot, e.g. panda")
    robot.add_argument(
        "service", nargs="?", metavar="SERVICE", help="without it: list the services"
    )
    robot.add_argument(
        "arguments",
        nargs="*",
        metavar="NAME=VALUE",
        help="arguments of the service; VALUE is JSON or text, e.g. mass=0.5",
    )
