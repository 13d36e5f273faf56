"""Verbs for a simulated robot: pause, resume, step, reset."""

from argparse import ArgumentTypeError, Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.wire import Simulation


def add_step(parser: "Parser") -> None:
    """Add the arguments of `step`."""
    parser.add_argument("n", nargs="?", type=int, default=1, metavar="N")


def add_reset(parser: "Parser") -> None:
    """Add the arguments of `reset`."""
    parser.add_argument(
        "positions",
        nargs="*",
        type=_joint_position,
        metavar="JOINT=POSITION",
        help="where a joint goes [rad or m], e.g. panda_joint1=0.5",
    )
    parser.add_argument("--keyframe", metavar="POSE", help="a pose to start at")


def _joint_position(text: str) -> tuple[str, float]:
    """Return a joint and its position.

    Raises:
        ArgumentTypeError: The text has another form.
    """
    name, _, number = text.partition("=")
    try:
        return name, float(number)
    except ValueError as error:
        raise ArgumentTypeError(
            f"{text!r} is not JOINT=POSITION, such as panda_joint1=0.5."
        ) from error


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
