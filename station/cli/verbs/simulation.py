"""Verbs for a simulated robot: pause, resume, step, reset."""

from argparse import ArgumentTypeError, Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.output import answer

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
        return _tell(client.simulation.pause(), options)


def resume(options: Namespace) -> int:
    """Let simulated time pass again."""
    with open_client(options) as client:
        return _tell(client.simulation.resume(), options)


def step(options: Namespace) -> int:
    """Run some cycles of a paused simulation."""
    with open_client(options) as client:
        return _tell(client.simulation.step(options.n), options)


def reset(options: Namespace) -> int:
    """Put the simulated world back to its start."""
    with open_client(options) as client:
        state = client.simulation.reset(dict(options.positions), options.keyframe)
        return _tell(state, options)


def _tell(state: "Simulation", options: Namespace) -> int:
    pace = f"Running at {state.real_time_factor:g} times real time"
    how = "Paused" if state.paused else pace
    return answer(options, state, f"{how}; {state.time:.3f} s simulated.")
