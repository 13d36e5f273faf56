"""Verb `ui`: run only the dashboard, for any station."""

import json
import os
from argparse import SUPPRESS, Namespace
from typing import TYPE_CHECKING

from station.app.addresses import host_names
from station.app.orphaned_dashboard import StationWatch
from station.app.ui_process import VIEWER_VARIABLE, PortTakenError
from station.cli.connection import locate
from station.cli.output import say_now, say_now_json, say_progress
from station.local.station_locator import NoStationError, viewer_token_of, watchdog_of
from station.ui.link.station_access import StationAccess

if TYPE_CHECKING:
    from station.cli.parser import Parser


def add_ui(parser: "Parser") -> None:
    """Add the arguments of `ui`."""
    parser.add_argument("--connect", metavar="URL", help="the same as --url")
    parser.add_argument("--host", default="127.0.0.1", help="address to listen at")
    parser.add_argument("--port", type=int, default=8080, help="0: any free one")
    parser.add_argument(
        "--robot-description",
        default="example-robot-data:panda",
        help="what to draw: example-robot-data:NAME or a URDF",
    )
    parser.add_argument("--arm-id", default="panda", help="prefix of the joint names")
    parser.add_argument(
        "--base",
        type=float,
        nargs=6,
        default=(0.0,) * 6,
        metavar=("X", "Y", "Z", "ROLL", "PITCH", "YAW"),
        help="where the robot stands [m], [rad]",
    )
    # `station run` passes the process that the dashboard follows, and how long the
    # dashboard waits for a new station.
    parser.add_argument("--parent-pid", type=int, help=SUPPRESS)
    parser.add_argument("--watchdog", default="", help=SUPPRESS)
    parser.add_argument("--base-moves", action="store_true", help=SUPPRESS)
    parser.add_argument("--beside", default="[]", help=SUPPRESS)
    parser.add_argument("--reconnect-window", type=float, default=60.0, help=SUPPRESS)


def ui(options: Namespace) -> int:
    """Run the dashboard until Ctrl-C, or until the process that started it ends.

    Raises:
        NoStationError: No station was found, or no token for it is known.
        PortTakenError: The dashboard cannot listen at its port.
    """
    url, token = locate(options.connect or options.url, options.token)
    if token is None:
        raise NoStationError(
            f"No token is known for the station at {url}.",
            remedy="Set STATION_TOKEN, or give --token.",
        )
    watchdog_url = options.watchdog or watchdog_of(url)
    viewer_token = os.environ.get(VIEWER_VARIABLE) or viewer_token_of(url)
    follower = None
    if options.parent_pid is not None:
        access = StationAccess(url, token, watchdog_url, viewer_token)
        follower = StationWatch(options.parent_pid, access, options.reconnect_window)
        if not follower.start():
            return 0  # the station that started the dashboard has already ended
    # Imported after the watch has begun: importing Viser and the meshes takes seconds,
    # in which the station may be killed.
    from station.app.panda_fetch import fetch_what_is_missing
    from station.app.sessions_file import SessionsFile
    from station.ui.main import DashboardConfig, DrawnRobot, run_dashboard

    drawn = {"robot_description": options.robot_description}
    fetch_what_is_missing(drawn, say_progress)
    config = DashboardConfig(
        url,
        token,
        host=options.host,
        port=options.port,
        robot_description=options.robot_description,
        arm_id=options.arm_id,
        base=tuple(options.base),
        base_moves=options.base_moves,
        beside=tuple(
            DrawnRobot(description, arm_id, tuple(base))
            for description, arm_id, base in json.loads(options.beside)
        ),
        host_names=tuple(host_names(options.host)),
        watchdog_url=watchdog_url,
        ca=options.ca,
        viewer_token=viewer_token,
        sessions=SessionsFile(options.port, url) if options.port else None,
        follower=follower,
    )
    tell = _quiet if options.parent_pid else _say_json if options.json else _say
    try:
        return run_dashboard(config, tell)
    except OSError as error:
        raise PortTakenError(options.host, options.port, error) from error


def _say(url: str) -> None:
    say_now(f"Dashboard  {url}/login (log in with a token of the station)")


def _say_json(url: str) -> None:
    say_now_json({"ui_url": url})


def _quiet(_: str) -> None:
    """Print nothing: the station that started this dashboard prints its address."""
