"""Verb `gripper`: homing, move, grasp, stop and state of an arm's hand."""

import time
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from collections.abc import Sequence

    from station.client import GripperClient, StationClient
    from station.wire import Gripper, GripperCommand

POLL = 0.1
"""How often the gripper is looked at [s]."""
_NUMBERS = {"state": 0, "stop": 0, "homing": 0, "move": 1, "grasp": 2}
_USAGE = (
    "station gripper [ARM] state | stop | homing | move WIDTH | grasp WIDTH FORCE, "
    "in metres and newtons"
)


def gripper(options: Namespace) -> int:
    """Command a gripper and wait for the end; return 1 when it does not succeed.

    Raises:
        UsageError: The words are wrong, or the arm must be named.
        KeyboardInterrupt: The user gave up; the gripper was stopped.
    """
    arm_id, action, numbers = _parse(options.words)
    with open_client(options) as client:
        hand = client.robot(arm_id or _only_arm(client)).gripper
        state = _begin(hand, action, numbers, options)
        command = state.command
        if command is None or action in {"state", "stop"} or options.no_wait:
            _tell(state, as_json=options.json)
            return 0
        try:
            state = _wait(hand, command)
        except KeyboardInterrupt:
            hand.stop()
            raise
    _tell(state, as_json=options.json)
    last = state.last
    succeeded = last and last.id == command.id and last.status == "succeeded"
    return 0 if succeeded else 1


def _parse(words: "Sequence[str]") -> tuple[str, str, list[float]]:
    """Return the arm, empty for the only one, what to do, and the numbers for it.

    Raises:
        UsageError: The words have another form.
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
        UsageError: There are several, or none.
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
    from station.wire import (
        GraspEpsilon,
        GripperGraspRequest,
        GripperMoveRequest,
    )

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


def _tell(state: "Gripper", *, as_json: bool) -> None:
    if as_json:
        say_model(state)
        return
    width = "unknown" if state.width is None else f"{1000.0 * state.width:.1f} mm"
    grasped = ", something is grasped" if state.is_grasped else ""
    say(f"The gripper of {state.arm_id} is {state.activity}: width {width}{grasped}.")
    for one in (state.last, state.command):
        if one is not None:
            say(f"{one.action} {one.id}: {one.status}. {one.message}".rstrip())
