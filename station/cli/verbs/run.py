"""Verb `run`: a station until Ctrl-C."""

import logging
import os
import sys
import threading
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.output import say, say_json, say_progress

if TYPE_CHECKING:
    from station.app.announcement import Announcement

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


def run(options: Namespace) -> int:
    """Run a station until Ctrl-C; return 3 when the watchdog has ended it."""
    from station.app.json_log import JSON, set_up_log
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
    if options.foxglove is not None:
        flags |= {"foxglove.enabled": True, "foxglove.port": options.foxglove}
    config = load_config(
        options.config if options.robot is None else _robot_of(options),
        controller_files=options.controllers,
        flags=flags,
    )
    find_robot(config.robot.type)  # before a download that would be of no use
    fetch_what_is_missing(config.robot_parameters(), say_progress)

    station = StationRun(
        config,
        tell=_tell_json if options.json else _tell,
        tell_dashboard=_tell_dashboard_json if options.json else _tell_dashboard,
        warn=_log.warning if options.log_format == JSON else _warn,
    )
    try:
        station.run()
    except EndedByWatchdogError as error:
        sys.stderr.write(f"error: {error}\n{error.remedy}\n")
        return _leave(ENDED_BY_WATCHDOG)
    return _leave(0)


def _robot_of(options: Namespace) -> dict[str, object]:
    """Return the configuration of `--robot`, whose file is fetched if need be.

    Raises:
        ConfigError: A configuration is given, too, or the base is of no use.
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
    """Return the exit code, or end at once when a thread would hold the end up.

    A request that never comes back has a thread which Python waits for at its exit.
    """
    main = threading.main_thread()
    if any(not t.daemon and t is not main for t in threading.enumerate()):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    return code


def _tell(announcement: "Announcement") -> None:
    for line in announcement.lines():
        say(line)
    sys.stdout.flush()


def _tell_dashboard(announcement: "Announcement") -> None:
    say(announcement.dashboard_line())
    sys.stdout.flush()


def _tell_json(announcement: "Announcement") -> None:
    say_json(announcement.as_json())
    sys.stdout.flush()


def _tell_dashboard_json(announcement: "Announcement") -> None:
    say_json({"ui_ready": announcement.ui_url})
    sys.stdout.flush()


def _warn(line: str) -> None:
    sys.stderr.write(f"warning: {line}\n")
    sys.stderr.flush()
