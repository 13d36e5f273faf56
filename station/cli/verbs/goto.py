"""The verb that moves the arm to a pose and waits until it is there."""

import time
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.named_poses import check_name, positions_of, ready_controller
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from pydantic import JsonValue

    from station.client import StationClient
    from station.wire import Goal

CALM_SPEED = 0.5
"""Mean speed of the joint that has the longest way, without a duration [rad/s]."""
SHORTEST = 1.0
"""Shortest time that is chosen without a duration [s]."""
POLL = 0.1
"""How often the goal is looked at [s]."""
_FINAL = {"succeeded", "aborted", "preempted"}


def goto(options: Namespace) -> int:
    """Move a trajectory controller's joints; 1 when they do not arrive.

    Without numbers, the name is that of a pose, and the controller is the trajectory
    controller that runs; without one, a controller is started and keeps holding.

    Raises:
        UsageError: There is no such pose.
        KeyboardInterrupt: The user gave up; the goal was cancelled.
    """
    with open_client(options) as client:
        controller, values = options.name, options.values
        if not values:
            controller = _controller_for(client, options.name)
        here = client.query_state(controller)
        values = values or positions_of(options.name, here.name)
        request = _request(here.name, here.position, values, options.duration)
        goal = client.submit_goal(controller, request)
        try:
            goal = _wait(client, controller, goal)
        except KeyboardInterrupt:
            client.cancel_goal(controller, goal.id)
            raise
    if options.json:
        say_model(goal)
    else:
        why = goal.result.message if goal.result else ""
        say(f"{controller}: the goal {goal.status}. {why}".rstrip())
    return 0 if goal.status == "succeeded" else 1


def _controller_for(client: "StationClient", pose: str) -> str:
    """Return the controller that goes to a pose; nothing is started for a wrong name.

    Raises:
        UsageError: There is no such pose, or no such controller.
    """
    check_name(pose)
    return ready_controller(client)


def _request(
    names: "Sequence[str]",
    here: "Sequence[float | None]",
    values: "Sequence[float]",
    duration: float | None,
) -> "Mapping[str, JsonValue]":
    ways = [abs(v - (h or 0.0)) for v, h in zip(values, here, strict=False)]
    calm = max(SHORTEST, max(ways, default=0.0) / CALM_SPEED)
    point: dict[str, JsonValue] = {
        "positions": list(values),
        "velocities": [0.0] * len(values),
        "accelerations": [0.0] * len(values),
        "time_from_start": calm if duration is None else duration,
    }
    return {"trajectory": {"joint_names": list(names), "points": [point]}}


def _wait(client: "StationClient", controller: str, goal: "Goal") -> "Goal":
    while goal.status not in _FINAL:
        time.sleep(POLL)
        goal = client.goal(controller, goal.id)
    return goal
