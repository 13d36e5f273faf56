"""Verbs `run` and `fci`, which run until Ctrl-C, and `fetch_robot`."""

import json
import logging
import os
import sys
import threading
from argparse import ArgumentTypeError, Namespace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from typing_extensions import override

from station.cli.output import answer, say_now, say_now_json, say_progress
from station.cli.parser import ROBOT, add_base, add_controllers
from station.cli.verbs.fci_check import (
    CHECK,
    add_check,
    check,
    port_number,
    refuse_other_options,
)

if TYPE_CHECKING:
    from station.app.addresses import Announcement
    from station.cli.parser import Parser

_log = logging.getLogger("station")

# Command line options and the keys of the configuration that they set.
_FLAGS = {
    "rate": "station.rate",
    "real_time_factor": "station.real_time_factor",
    "host": "api.host",
    "port": "api.port",
    "token": "api.token",
    "allowed_origins": "api.allowed_origins",
    "tls_cert": "api.tls.certificate",
    "tls_key": "api.tls.key",
    "ui_port": "ui.port",
}
ENDED_BY_WATCHDOG = 3
"""Exit code of a station that the watchdog has ended; 137 when it had to be killed."""
LONGEST_PATIENCE = 10.0
"""Longest wait for a late command of a program of libfranka [s]."""
_JSON = "json"


def add_run(parser: "Parser") -> None:
    """Add the arguments of `run`."""
    add = parser.add_argument
    add("config", nargs="?", type=Path, metavar="CONFIG.yaml")
    add_controllers(
        parser,
        "parameter files written for ROS, unchanged; their controllers are loaded",
    )
    add(
        "--arg",
        nargs="+",
        action="extend",
        default=[],
        type=_argument,
        metavar="NAME:=VALUE",
        help="what $(var NAME) stands for in these files",
    )
    add(
        "--robot",
        metavar="ROBOT",
        help=f"simulate this robot with controllers made for it: {ROBOT}",
    )
    add_base(parser)
    add("--rate", type=float, metavar="HZ", help="control loop rate")
    _add_servers(parser)
    add(
        "--real-time-factor",
        type=float,
        metavar="X",
        help="station over wall time, 0.01 to 100",
    )
    add(
        "--log-format",
        choices=("text", "json"),
        default="text",
        help="json: one object per line, requests that change something among them",
    )


def add_fci(parser: "Parser") -> None:
    """Add the arguments of `fci`, and of its `check`."""
    add = parser.add_argument
    add(
        "config",
        nargs="?",
        type=Path,
        metavar="CONFIG.yaml | check",
        help="the arm to serve; `check ADDRESS` checks the arm at an address",
    )
    add_check(parser)
    add(
        "--host",
        default="127.0.0.1",
        help="address to listen at, ports 1337 and 1338; there are no tokens: whoever "
        "reaches them may do all",
    )
    add(
        "--patience",
        type=_patience,
        default=0.0,
        metavar="S",
        help="how long the simulated time waits for a late command, 0 to 10 s; a real "
        "arm does not wait",
    )
    add(
        "--version",
        type=int,
        choices=range(5, 11),
        metavar="N",
        help="the only version of the protocol that is spoken, 5 to 10; all by "
        "default. Of `check`: the client's; the newest by default",
    )
    add(
        "--desk",
        nargs="?",
        type=port_number,
        const=443,
        metavar="PORT",
        help="serve what programs call of Franka Desk to unlock the arm, over https; "
        "until they do, the brakes are closed and FCI is off. Default port 443, which "
        "clients need that take the robot's address alone",
    )


def _add_servers(parser: "Parser") -> None:
    """Add the addresses, ports and access options of API, dashboard and tools."""
    add = parser.add_argument
    add("--host", help="address to listen at; others need --token")
    add("--port", type=int, help="port of the API; 0: any free one")
    add("--ui-port", type=int, help="port of the dashboard; 0: likewise")
    add(
        "--foxglove",
        nargs="?",
        type=int,
        const=8765,
        metavar="PORT",
        help="serve the channels of a recording live to Foxglove, at the loopback "
        "address unless the configuration says another; default port 8765",
    )
    add(
        "--rosbridge",
        nargs="?",
        type=int,
        const=9090,
        metavar="PORT",
        help="serve clients of ROS, such as roslibpy and roslibjs, at the loopback "
        "address unless the configuration says another; default port 9090",
    )
    add("--no-ui", action="store_true", help="run without dashboard")
    add(
        "--token",
        help="the operator's token; random if left out. Others on this machine can "
        "read it in the list of processes: STATION_API__TOKEN is more private",
    )
    add(
        "--allowed-origin",
        action="append",
        dest="allowed_origins",
        metavar="ORIGIN",
        help="a web page elsewhere that may use the API, e.g. https://lab.example; may "
        "be repeated",
    )
    add("--tls-cert", metavar="FILE", help="serve https and wss with this certificate")
    add("--tls-key", metavar="FILE", help="the key of --tls-cert")


def _patience(text: str) -> float:
    """Return the longest wait for a command [s].

    Raises:
        ArgumentTypeError: The text is not a number from 0 to 10.
    """
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= LONGEST_PATIENCE:
        raise ArgumentTypeError(f"{text!r} is no number of seconds, 0 to 10")
    return value


def _argument(text: str) -> tuple[str, str]:
    """Return a name and its value, which may be empty.

    Raises:
        ArgumentTypeError: The text is malformed.
    """
    name, sign, value = text.partition(":=")
    if not (name and sign):
        raise ArgumentTypeError(f"{text!r} is not NAME:=VALUE, such as prefix:=left_")
    return name, value


def run(options: Namespace) -> int:
    """Run a station until Ctrl-C; return 3 when the watchdog has ended it."""
    from station.app.lifecycle import StationRun
    from station.app.panda_fetch import fetch_what_is_missing
    from station.app.station_watchdog import EndedByWatchdogError
    from station.config import load_config
    from station.hw.robot_loader import find_robot

    set_up_log(options.log_format)
    flags = {
        key: value
        for option, key in _FLAGS.items()
        if (value := getattr(options, option)) is not None
    }
    if options.no_ui:
        flags["ui.enabled"] = False
    flags |= {f"arguments.{name}": value for name, value in options.arg}
    for tool in ("foxglove", "rosbridge"):
        if (port := getattr(options, tool)) is not None:
            flags |= {f"{tool}.enabled": True, f"{tool}.port": port}
    config = load_config(
        options.config if options.robot is None else _robot_of(options),
        controller_files=options.controllers,
        flags=flags,
    )
    find_robot(config.robot.type)  # fail before a useless download
    fetch_what_is_missing(config.robot_parameters(), say_progress)

    station = StationRun(
        config,
        tell=_tell_json if options.json else _tell,
        tell_dashboard=_tell_dashboard_json if options.json else _tell_dashboard,
        warn=_log.warning if options.log_format == _JSON else _warn,
    )
    try:
        station.run()
    except EndedByWatchdogError as error:
        sys.stderr.write(f"error: {error}\n{error.remedy}\n")
        return _leave(ENDED_BY_WATCHDOG)
    return _leave(0)


def _robot_of(options: Namespace) -> dict[str, object]:
    """Return the configuration of `--robot`; fetch the robot's files if necessary.

    Raises:
        ConfigError: A configuration was given, too.
        RobotDescriptionError: The robot is unknown or cannot be simulated.
    """
    from station.app.any_robot import configure_robot
    from station.app.panda_fetch import fetch_what_is_missing
    from station.config import ConfigError

    if options.config is not None:
        raise ConfigError(
            [f"{options.config} and --robot {options.robot} both name a robot."],
            remedy="Give one of them; robot.robot_description of the file may name it.",
        )
    fetch_what_is_missing({"robot_description": options.robot}, say_progress)
    return configure_robot(options.robot, options.base)


def _leave(code: int) -> int:
    """Return the exit code, or exit at once if a thread would delay the exit.

    Python waits at exit for all threads, even for that of a request that never returns.
    """
    main = threading.main_thread()
    if any(not t.daemon and t is not main for t in threading.enumerate()):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    return code


def _tell(announcement: "Announcement") -> None:
    say_now("\n".join(announcement.lines()))


def _tell_dashboard(announcement: "Announcement") -> None:
    say_now(announcement.dashboard_line())


def _tell_json(announcement: "Announcement") -> None:
    say_now_json(announcement.as_json())


def _tell_dashboard_json(announcement: "Announcement") -> None:
    say_now_json({"ui_ready": announcement.ui_url})


def _warn(line: str) -> None:
    sys.stderr.write(f"warning: {line}\n")
    sys.stderr.flush()


def fci(options: Namespace) -> int:
    """Serve a simulated Franka arm over the Franka Control Interface until Ctrl-C.

    With `check` in place of the configuration, check the arm at an address.
    """
    refuse_other_options(options)
    if options.config == CHECK:
        return check(options)
    from station.app.fci_run import FciRun
    from station.app.panda_fetch import fetch_what_is_missing
    from station.config import load_config
    from station.hw.franka.fci.server.fci_server import FciSettings

    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    config = load_config(options.config, controller_files=[], flags={})
    fetch_what_is_missing(config.robot_parameters(), say_progress)
    settings = FciSettings(options.host, options.patience)
    tell = _tell_line_json if options.json else say_now
    version, desk = options.version, options.desk
    run = FciRun(config, settings, version, desk_port=desk, tell=tell, warn=_warn)
    run.run()
    return 0


def _tell_line_json(line: str) -> None:
    say_now_json({"message": line})


def fetch_robot(options: Namespace) -> int:
    """Fetch the Panda's description and print its folder."""
    from station.app.panda_fetch import fetch_panda

    directory = fetch_panda(say_progress)
    return answer(options, {"directory": str(directory)}, str(directory))


class JsonFormatter(logging.Formatter):
    """Writes a record with `time`, `level`, `logger`, `message`.

    A record may also have `request_id` and `exception` (the traceback).
    """

    @override
    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, object] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        request_id = getattr(record, "request_id", None)
        if request_id is not None:
            line["request_id"] = request_id
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line, default=str)


def set_up_log(form: str) -> None:
    """Make the process log to stderr.

    Args:
        form: `text` is for people and has warnings only; `json` is for programs and
            also has the requests that changed something or were refused.
    """
    handler = logging.StreamHandler()
    if form == _JSON:
        from station.web.request_id import RequestIdFilter

        handler.setFormatter(JsonFormatter())
        handler.addFilter(RequestIdFilter())
        logging.getLogger("station").setLevel(logging.INFO)
    else:
        handler.setFormatter(logging.Formatter("%(levelname)s: %(message)s"))
    logging.getLogger().addHandler(handler)
