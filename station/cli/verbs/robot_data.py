"""Verb `fetch_robot`: the Panda's description, for a machine without a network."""

from argparse import Namespace

from station.app.panda_fetch import fetch_panda
from station.cli.output import say, say_json, say_progress


def fetch_robot(options: Namespace) -> int:
    """Fetch the Panda's description and say where it is."""
    directory = fetch_panda(say_progress)
    if options.json:
        say_json({"directory": str(directory)})
    else:
        say(str(directory))
    return 0
