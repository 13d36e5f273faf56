"""Verb `run`: a station until Ctrl-C."""

import logging
import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.output import say, say_json

if TYPE_CHECKING:
    from station.app.announcement import Announcement

# Command line options and the keys of the configuration that they set.
_FLAGS = {
    "rate": "station.rate",
    "real_time_factor": "station.real_time_factor",
    "host": "api.host",
    "port": "api.port",
    "token": "api.token",
    "ui_port": "ui.port",
}


def run(options: Namespace) -> int:
    """Run a station until Ctrl-C."""
    from station.app.lifecycle import StationRun
    from station.config import load_config

    logging.basicConfig(level=logging.WARNING, format="%(levelname)s: %(message)s")
    flags = {
        key: value
        for option, key in _FLAGS.items()
        if (value := getattr(options, option)) is not None
    }
    if options.no_ui:
        flags["ui.enabled"] = False
    config = load_config(
        options.config, controller_files=options.controllers, flags=flags
    )

    station = StationRun(
        config,
        tell=_tell_json if options.json else _tell,
        tell_dashboard=_tell_dashboard_json if options.json else _tell_dashboard,
        warn=_warn,
    )
    station.run()
    return 0


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
