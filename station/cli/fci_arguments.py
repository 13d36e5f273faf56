"""The verb that serves a simulated arm to programs of libfranka."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.cli.arguments import Verbs

LONGEST_PATIENCE = 10.0
"""Longest wait for a late command [s]."""


def add_fci_verb(verbs: "Verbs") -> None:
    """Add `fci`."""
    fci = verbs.add(
        "fci",
        "fci:fci",
        "serve a simulated Franka arm to programs that use libfranka",
        is_client=False,
    )
    fci.add_argument("config", nargs="?", type=Path, metavar="CONFIG.yaml")
    fci.add_argument(
        "--host",
        default="127.0.0.1",
        help="address to listen at, ports 1337 and 1338; there are no tokens: whoever "
        "reaches them may do all",
    )
    fci.add_argument(
        "--patience",
        type=_patience,
        default=0.0,
        metavar="S",
        help="how long the simulated time waits for a late command, 0 to 10 s; a real "
        "arm does not wait",
    )


def _patience(text: str) -> float:
    """Return how long to wait for a command [s].

    Raises:
        ArgumentTypeError: The text is no number from 0 to 10.
    """
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= LONGEST_PATIENCE:
        raise argparse.ArgumentTypeError(f"{text!r} is no number of seconds, 0 to 10")
    return value
