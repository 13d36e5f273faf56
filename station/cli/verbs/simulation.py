"""Verbs for a simulated robot: pause, resume, step, reset."""

from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from station.wire import Simulation


def pause(options: Namespace) -> int:
    """Let simulated time stand still."""
    with open_client(options) as client:
        return _tell(client.simulation.pause(), as_json=options.json)


def resume(options: Namespace) -> int:
    """Let simulated time pass again."""
    with open_client(options) as client:
        return _tell(client.simulation.resume(), as_json=options.json)


def step(options: Namespace) -> int:
    """Run some cycles of a paused simulation."""
    with open_client(options) as client:
        return _tell(client.simulation.step(options.n), as_json=options.json)


def reset(options: Namespace) -> int:
    """Put the simulated world back to its start."""
    with open_client(options) as client:
        state = client.simulation.reset(dict(options.positions), options.keyframe)
        return _tell(state, as_json=options.json)


def _tell(state: "Simulation", *, as_json: bool) -> int:
    if as_json:
        say_model(state)
    elif state.paused:
        say(f"Paused; {state.time:.3f} s simulated.")
    else:
        factor = state.real_time_factor
        say(f"Running at {factor:g} times real time; {state.time:.3f} s simulated.")
    return 0
