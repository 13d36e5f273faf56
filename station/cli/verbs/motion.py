"""Verbs that move the robot or keep it from moving."""

from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.output import say, say_model
from station.cli.verbs.switching import stop_running

if TYPE_CHECKING:
    from station.client import StationClient
    from station.client.routes import Restart
    from station.wire import ArmReport, Recoveries, Recovery, StopState


def command(options: Namespace) -> int:
    """Send a controller a set-point."""
    with open_client(options) as client:
        accepted = client.command(options.controller, options.values)
    if options.json:
        say_model(accepted)
    else:
        say(f"{options.controller} took the set-point (epoch {accepted.epoch}).")
    return 0


def stop(options: Namespace) -> int:
    """Stop the robot; with names of loaded controllers, these alone.

    A word that is no controller may be a mistake or a cry for help. The robot stops,
    because that is the safe interpretation.
    """
    with open_client(options) as client:
        if options.names and _are_loaded(client, options.names):
            return stop_running(client, options.names, as_json=options.json)
        reason = options.reason or " ".join(options.names) or "station stop"
        state = client.stop(reason)
    return _tell(state, as_json=options.json)


def _are_loaded(client: "StationClient", names: list[str]) -> bool:
    from station.client import ApiError

    try:
        loaded = {controller.name for controller in client.controllers()}
    except (ApiError, ValueError):
        return False  # Without an answer that is understood, stop the robot.
    return loaded.issuperset(names)


def release(options: Namespace) -> int:
    """Release a stop, in two steps."""
    with open_client(options) as client:
        state = client.release_stop(arm=options.arm)
    return _tell(state, as_json=options.json)


def recover(options: Namespace) -> int:
    """Clear the errors of an arm, or of all of them."""
    with open_client(options) as client:
        restart: Restart = "previous" if options.restart else "none"
        recovered: Recovery | Recoveries
        if options.arm_id:
            recovered = client.robot(options.arm_id).recover(restart)
            arms: list[ArmReport] = [recovered]
        else:
            recovered = client.recover_all(restart)
            arms = recovered.robots
    if options.json:
        say_model(recovered)
        return 0
    for arm in arms:
        say(f"{arm.arm_id} is {arm.robot_mode}.")
    say(f"Started again: {', '.join(recovered.restarted) or 'nothing'}.")
    return 0


_MEANING = {
    "stopped": "The robot is stopped. Take it back with `station release`.",
    "released": "The stop is released; nothing moves yet. Allow motion again with "
    "`station release --arm`.",
    "armed": "Motion is possible. Nothing resumes by itself: start a controller.",
}


def _tell(state: "StopState", *, as_json: bool) -> int:
    if as_json:
        say_model(state)
    else:
        say(_MEANING[state.state])
    return 0
