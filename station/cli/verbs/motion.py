"""Verbs that move the robot or keep it from moving."""

import json
from argparse import Namespace
from dataclasses import dataclass
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from station.cli.connection import locate, open_client
from station.cli.errors import UsageError
from station.cli.output import answer
from station.cli.parser import read_duration
from station.cli.verbs.switching import stop_running
from station.core.errors import StationError
from station.local.station_locator import watchdog_of

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import GoalHandle, StationClient
    from station.client.poses import Pose, Target
    from station.client.robots import Restart
    from station.wire import ArmReport, Recoveries, Recovery

STOP_TIME = 0.5
"""Longest wait for the station's answer to a stop, before the watchdog is asked [s]."""
TIMEOUT = 2.0
"""Longest wait for the watchdog [s]."""


def add_command(parser: "Parser") -> None:
    """Add the arguments of `command`."""
    add = parser.add_argument
    add("controller")
    add("command", nargs="+", type=float, metavar="V")
    _add_certificate(parser)


def add_goto(parser: "Parser") -> None:
    """Add the arguments of `goto`."""
    add = parser.add_argument
    add(
        "name",
        help="a pose, e.g. `ready` (with --plan also one of the robot's own), or a "
        "trajectory controller",
    )
    add("values", nargs="*", type=float, metavar="V", help="positions [rad or m]")
    add("--duration", type=read_duration, metavar="S", help="without it: a calm one")
    add("--plan", action="store_true", help="go around what is in the way")
    add(
        "--pose",
        action="store_true",
        help="with --plan: the numbers are x y z [m] of a Franka's end effector in the "
        "frame of its base, and a quaternion x y z w unless it is to stay turned as it "
        "is",
    )
    _add_certificate(parser)


def _add_certificate(parser: "Parser") -> None:
    parser.add_argument(
        "--certificate",
        metavar="NAME",
        help="what `rehearse --certificate` told for exactly this motion",
    )


def add_motion_sequence(parser: "Parser") -> None:
    """Add the arguments of `motion_sequence`."""
    parser.add_argument("controller", help="a running trajectory controller")
    parser.add_argument("file", help="YAML or JSON with a list `motions`")


def add_stop(parser: "Parser") -> None:
    """Add the arguments of `stop`."""
    add = parser.add_argument
    add("names", nargs="*", metavar="NAME")
    add("--reason", default="", help="for the record")


def add_recover(parser: "Parser") -> None:
    """Add the arguments of `recover`."""
    add = parser.add_argument
    add("arm_id", nargs="?", help="default: all arms")
    add(
        "--restart",
        action="store_true",
        help="start the controllers again that the error stopped",
    )


def add_release(parser: "Parser") -> None:
    """Add the arguments of `release`."""
    parser.add_argument(
        "--arm", action="store_true", help="second step: allow motion again"
    )


def command(options: Namespace) -> int:
    """Send a set-point to a controller."""
    with open_client(options) as client:
        accepted = client.command(
            options.controller, options.command, certificate=options.certificate
        )
    line = f"{options.controller} took the set-point (epoch {accepted.epoch})."
    return answer(options, accepted, line)


def goto(options: Namespace) -> int:
    """Move a trajectory controller's joints; return 1 if they do not arrive.

    Without numbers, the name is that of a pose, and the running trajectory controller
    moves there. If none runs, one is started, and keeps holding the joints. The cycle
    that starts it stops controllers that command the same joints.

    Raises:
        UsageError: The pose is unknown, a word is not a number, or the path is to be
            planned and has a certificate.
        KeyboardInterrupt: The user gave up; the goal was cancelled.
    """
    from station.client.poses import UnknownPoseError

    target = _target(options)
    if options.plan and options.certificate:
        raise UsageError(
            "--certificate is for a rehearsed motion, and --plan finds a new path.",
            remedy="Leave one of them out.",
        )
    with open_client(options) as client:
        try:
            handle = client.start_move(
                target,
                duration=options.duration,
                controller=options.name if options.values else "",
                plan=options.plan,
                certificate=options.certificate,
            )
        except UnknownPoseError as error:
            raise UsageError(error.detail, remedy=error.remedy) from error
        return _wait_for(options, handle)


def motion_sequence(options: Namespace) -> int:
    """Follow blended motion primitives; return 1 if the joints do not arrive.

    Raises:
        UsageError: The file does not hold a list.
        KeyboardInterrupt: The user gave up; the goal was cancelled.
    """
    from station.core.yaml_reader import read_yaml

    motions = read_yaml(Path(options.file)).values.get("motions")
    if not isinstance(motions, list) or not all(isinstance(m, dict) for m in motions):
        raise UsageError(
            f"{options.file} has no list 'motions' of motion primitives.",
            remedy="One is such as {type: PTP, joint_positions: [0.1, 0.2]}.",
        )
    with open_client(options) as client:
        return _wait_for(
            options, client.start_motion_sequence(options.controller, motions)
        )


def _wait_for(options: Namespace, handle: "GoalHandle") -> int:
    try:
        goal = handle.ended()
    except KeyboardInterrupt:
        handle.cancel()
        raise
    why = goal.result.message if goal.result else ""
    line = f"{handle.controller}: the goal {goal.status}. {why}"
    answer(options, goal, line.rstrip())
    return 0 if goal.status == "succeeded" else 1


def _target(options: Namespace) -> "Target | Pose":
    """Return the target of a motion.

    Raises:
        UsageError: The numbers are not a pose, or no path to the pose was found.
    """
    from station.client.poses import Pose

    values: list[float] = options.values
    if not options.pose:
        return values or str(options.name)
    if len(values) not in {3, 7} or not options.plan:
        raise UsageError(
            "A pose has 3 or 7 numbers, and the way there is planned.",
            remedy="station goto CONTROLLER x y z [qx qy qz qw] --pose --plan",
        )
    x, y, z, *turned = values
    if not turned:
        return Pose((x, y, z))
    qx, qy, qz, qw = turned
    return Pose((x, y, z), (qx, qy, qz, qw))


def stop(options: Namespace) -> int:
    """Stop the robot; with names of loaded controllers, stop only these.

    A word that does not name a controller may be a mistake or an emergency. The robot
    stops, because this is the safe interpretation. A station that does not answer, or
    whose loop makes no cycles, is stopped through its watchdog.

    Raises:
        StationUnreachableError: Neither the station nor its watchdog answers.
        WatchdogError: The watchdog does not confirm the stop either.
    """
    from station.client import StationUnreachableError

    url, token = locate(options.url, options.token)
    watchdog_url = watchdog_of(url)
    reason = options.reason or " ".join(options.names) or "station stop"
    with open_client(options) as client:
        patience = client.timeout
        if watchdog_url and token:
            client.timeout = STOP_TIME
        if options.names and _are_loaded(client, options.names):
            client.timeout = patience
            return stop_running(client, options)
        try:
            state = client.stop(reason)
        except StationUnreachableError:
            if not (watchdog_url and token):
                raise
        else:
            if not (state.pending and watchdog_url and token):
                return answer(options, state, _MEANING[state.state])
    stopped = stop_through_watchdog(watchdog_url, token, reason)
    found = {"state": "stopped", "pending": not stopped.carried_out}
    line = f"The robot is stopped, through the watchdog. {stopped.detail}"
    return answer(options, found, line)


def _are_loaded(client: "StationClient", names: list[str]) -> bool:
    from station.client import ApiError

    try:
        loaded = {controller.name for controller in client.controllers()}
    except (ApiError, ValueError):
        return False  # without a valid answer, stop the robot
    return loaded.issuperset(names)


def release(options: Namespace) -> int:
    """Release a stop, in two steps."""
    with open_client(options) as client:
        state = client.release_stop(arm=options.arm)
    return answer(options, state, _MEANING[state.state])


def recover(options: Namespace) -> int:
    """Clear the errors of an arm, or of all of them."""
    with open_client(options) as client:
        restart: Restart = "previous" if options.restart else "none"
        recovered: Recovery | Recoveries
        if options.arm_id is not None:
            recovered = client.robot(options.arm_id).recover(restart)
            arms: list[ArmReport] = [recovered]
        else:
            recovered = client.recover_all(restart)
            arms = recovered.robots
    lines = []
    for arm in arms:
        lines.append(f"{arm.arm_id} is {arm.robot_mode}.")
        lines += [f"Caution: {arm.caution}"] if arm.caution else []
        lines += [f"To move it again: {arm.remedy}."] if arm.remedy else []
    started = ", ".join(recovered.restarted) or "nothing"
    return answer(options, recovered, *lines, f"Started again: {started}.")


_MEANING = {
    "stopped": "The robot is stopped. Take it back with `station release`.",
    "released": "The stop is released; nothing moves yet. Allow motion again with "
    "`station release --arm`.",
    "armed": "Motion is possible. Nothing resumes by itself: start a controller.",
}


class WatchdogError(StationError, ConnectionError):
    """The watchdog does not answer, or refuses the request."""

    code = "watchdog"


@dataclass(frozen=True, slots=True)
class WatchdogStop:
    """A stop that the watchdog has latched.

    Attributes:
        carried_out: Whether the control loop has already carried out the stop.
        detail: Explanation by the watchdog, for people.
    """

    carried_out: bool
    detail: str


def stop_through_watchdog(url: str, token: str, reason: str) -> WatchdogStop:
    """Latch a stop for the control loop, and make real arms hold.

    Args:
        url: URL of the watchdog.
        token: A token of the station, with any role.
        reason: Reason of the stop, for people.

    Raises:
        WatchdogError: The watchdog does not answer, or refuses the token.
    """
    connection = HTTPConnection(urlsplit(url).netloc, timeout=TIMEOUT)
    try:
        connection.request(
            "POST",
            "/stop",
            body=json.dumps({"reason": reason}),
            headers={"Authorization": f"Bearer {token}"},
        )
        answer = connection.getresponse()
        verdict = json.loads(answer.read())
    # A ValueError means that another program has the port and does not answer in JSON.
    except (OSError, HTTPException, ValueError) as error:
        raise WatchdogError(
            f"The watchdog at {url} does not answer: {error}.",
            remedy="Use the emergency stop of the robot.",
        ) from error
    finally:
        connection.close()
    if answer.status != 200:
        raise WatchdogError(
            f"The watchdog at {url} refuses: {verdict.get('detail')}",
            remedy="Give a token of the station: --token, or STATION_TOKEN.",
        )
    return WatchdogStop(verdict["carried_out"], verdict["detail"])
