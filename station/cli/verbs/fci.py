"""Verb `fci`: a simulated arm for programs that use libfranka."""

import logging
import sys
from argparse import Namespace

from station.cli.output import say, say_json, say_progress


def fci(options: Namespace) -> int:
    """Serve a simulated Franka arm over the Franka Control Interface until Ctrl-C."""
    from station.app.fci_run import FciRun
    from station.app.panda_fetch import fetch_what_is_missing
    from station.config import load_config
    from station.hw.franka.fci.server.fci_server import FciSettings

    logging.basicConfig(level=logging.INFO, format="%(message)s", stream=sys.stderr)
    config = load_config(options.config, controller_files=[], flags={})
    fetch_what_is_missing(config.robot_parameters(), say_progress)
    settings = FciSettings(options.host, options.patience)
    tell = _tell_json if options.json else _tell
    FciRun(config, settings, tell=tell, warn=_warn).run()
    return 0


def _tell(line: str) -> None:
    say(line)
    sys.stdout.flush()


def _tell_json(line: str) -> None:
    say_json({"message": line})
    sys.stdout.flush()


def _warn(line: str) -> None:
    sys.stderr.write(f"warning: {line}\n")
    sys.stderr.flush()
