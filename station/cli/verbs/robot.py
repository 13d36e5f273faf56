"""Verbs `robot` and `gripper`: the services of a robot, and the hand of an arm."""

import json
import time
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, answer_table
from station.cli.parser import read_json, unique

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic import JsonValue

    from station.cli.parser import Parser
    from station.client import GripperClient, RobotClient, StationClient
    from station.wire import Gripper, GripperCommand

POLL = 0.1
"""Time between two requests for the gripper's state [s]."""
_NUMBERS = {"state": 0, "stop": 0, "homing": 0, "move": 1, "grasp": 2}
_USAGE = (
    "station gripper [ARM] state | stop | homing | move WIDTH | grasp WIDTH FORCE, "
    "in metres and newtons"
)


def add_robot(parser: "Parser") -> None:
    """Add the arguments of `robot`."""
    add = parser.add_argument
    add("arm_id", metavar="ROBOT", help="name of the robot, e.g. panda")
    add("service", nargs="?", metavar="SERVICE", help="without it: list the services")
    add(
        "arguments",
        nargs="*",
        metavar="NAME=VALUE",
        help="arguments of the service; VALUE is JSON or text, e.g. mass=0.5",
    )


def add_gripper(parser: "Parser") -> None:
    """Add the arguments of `gripper`."""
    add = parser.add_argument
    add(
        "words",
        nargs="+",
        metavar="WORD",
        help="[ARM] state, stop, homing, move WIDTH or grasp WIDTH FORCE [m], [N]; an "
        "only arm needs no name",
    )
    add("--speed", type=float, default=0.1, metavar="M/S", help="how fast it opens")
    for name, how in (("inner", "narrower"), ("outer", "wider")):
        add(
            f"--{name}",
            type=float,
            default=0.005,
            metavar="M",
            help=f"how much {how} than WIDTH what is grasped may be",
        )
    add("--no-wait", action="store_true", help="only begin")


def robot(options: Namespace) -> int:
    """List the services of a robot, or call one of them and print its answer."""
    arguments = unique(map(_parse_argument, options.arguments))
    with open_client(options) as client:
        chosen = client.robot(options.arm_id)
        if options.service is None:
            return _list(chosen, options)
        found = chosen.call(options.service.replace("-", "_"), **arguments)
    line = "Done." if found is None else json.dumps(found, indent=2)
    return answer(options, found, line)


def _list(chosen: "RobotClient", options: Namespace) -> int:
    services = chosen.services()
    rows = [
        [
            service.name,
            ", ".join(service.parameters) or "-",
            service.description.partition("\n")[0],
        ]
        for service in services
    ]
    return answer_table(options, services, ["service", "arguments", "does"], rows)


def _parse_argument(argument: str) -> "tuple[str, JsonValue]":
    """Return name and value of `NAME=VALUE`.

    Raises:
        UsageError: The text is malformed.
    """
    name, equals, text = argument.partition("=")
    if not equals or not name.isidentifier():
        raise UsageError(
            f"{argument!r} is not NAME=VALUE.",
            remedy="Write it like mass=0.5 or lengths=[1.0,2.0].",
        )
    return name, read_json(text)


def gripper(options: Namespace) -> int:
    """Command a gripper and wait for the end; return 1 when it does not succeed.

    Raises:
        UsageError: The words are wrong, or the arm must be named.
        KeyboardInterrupt: The user gave up; the gripper was stopped.
    """
    arm_id, action, numbers = _parse_words(options.words)
    with open_client(options) as client:
        hand = client.robot(arm_id or _only_arm(client)).gripper
        state = _begin(hand, action, numbers, options)
        command = state.command
        if command is None or action in {"state", "stop"} or options.no_wait:
            return _tell(state, options)
        try:
            state = _wait(hand, command)
        except KeyboardInterrupt:
            hand.stop()
            raise
    _tell(state, options)
    last = state.last
    succeeded = last and last.id == command.id and last.status == "succeeded"
    return 0 if succeeded else 1


def _parse_words(words: "Sequence[str]") -> tuple[str, str, list[float]]:
    """Return the arm, empty for the only one, the action, and its numbers.

    Raises:
        UsageError: The words are malformed.
    """
    arm_id, rest = ("", words) if words[0] in _NUMBERS else (words[0], words[1:])
    try:
        numbers = [float(word) for word in rest[1:]]
    except ValueError:
        numbers = []
    if not rest or _NUMBERS.get(rest[0]) != len(numbers) or len(rest[1:]) > 2:
        raise UsageError(
            f"`gripper {' '.join(words)}` is no command of a gripper.", remedy=_USAGE
        )
    return arm_id, rest[0], numbers


def _only_arm(client: "StationClient") -> str:
    """Return the name of the only arm.

    Raises:
        UsageError: The station has several arms, or none.
    """
    arms = [arm.arm_id for arm in client.robots()]
    if len(arms) != 1:
        raise UsageError(
            f"The station's arms are: {', '.join(arms) or 'none'}.",
            remedy=f"Name one: {_USAGE}.",
        )
    return arms[0]


def _begin(
    hand: "GripperClient", action: str, numbers: "Sequence[float]", options: Namespace
) -> "Gripper":
    from station.wire import GraspEpsilon, GripperGraspRequest, GripperMoveRequest

    match action:
        case "move":
            move = GripperMoveRequest(width=numbers[0], speed=options.speed)
            return hand.move(move)
        case "grasp":
            epsilon = GraspEpsilon(inner=options.inner, outer=options.outer)
            width, force = numbers
            grasp = GripperGraspRequest(
                width=width, force=force, speed=options.speed, epsilon=epsilon
            )
            return hand.grasp(grasp)
        case "homing":
            return hand.homing()
        case "stop":
            return hand.stop()
        case _:
            return hand.state()


def _wait(hand: "GripperClient", command: "GripperCommand") -> "Gripper":
    while True:
        state = hand.state()
        if state.command is None or state.command.id != command.id:
            return state
        time.sleep(POLL)


def _tell(state: "Gripper", options: Namespace) -> int:
    width = "unknown" if state.width is None else f"{1000.0 * state.width:.1f} mm"
    grasped = ", something is grasped" if state.is_grasped else ""
    line = f"The gripper of {state.arm_id} is {state.activity}: width {width}{grasped}."
    commands = (
        f"{one.action} {one.id}: {one.status}. {one.message}".rstrip()
        for one in (state.last, state.command)
        if one is not None
    )
    return answer(options, state, line, *commands)
