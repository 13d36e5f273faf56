"""The verb that moves the arm to a pose and waits until it is there."""

from argparse import Namespace

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_model


def goto(options: Namespace) -> int:
    """Move a trajectory controller's joints; 1 when they do not arrive.

    Without numbers, the name is that of a pose, and the controller is the trajectory
    controller that runs; without one, a controller is started and keeps holding.
    Controllers that command the same joints are stopped in that cycle.

    Raises:
        UsageError: There is no such pose.
        KeyboardInterrupt: The user gave up; the goal was cancelled.
    """
    from station.client._sync.motion import start_move
    from station.client.poses import UnknownPoseError

    name, values = options.name, options.values
    with open_client(options) as client:
        try:
            handle = start_move(
                client,
                values or name,
                duration=options.duration,
                controller=name if values else "",
            )
        except UnknownPoseError as error:
            raise UsageError(error.detail, remedy=error.remedy) from error
        try:
            goal = handle.ended()
        except KeyboardInterrupt:
            handle.cancel()
            raise
    if options.json:
        say_model(goal)
    else:
        why = goal.result.message if goal.result else ""
        say(f"{handle.controller}: the goal {goal.status}. {why}".rstrip())
    return 0 if goal.status == "succeeded" else 1
