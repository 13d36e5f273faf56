"""Verbs for a simulated robot: pause, resume, step, reset, and the scene around it."""

from argparse import ArgumentTypeError, Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, say

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import SceneObject, Simulation


def add_step(parser: "Parser") -> None:
    """Add the arguments of `step`."""
    parser.add_argument("n", nargs="?", type=int, default=1, metavar="N")


def add_reset(parser: "Parser") -> None:
    """Add the arguments of `reset`."""
    parser.add_argument(
        "joint_positions",
        nargs="*",
        type=_joint_position,
        metavar="JOINT=POSITION",
        help="where a joint goes [rad or m], e.g. panda_joint1=0.5",
    )
    parser.add_argument("--keyframe", metavar="POSE", help="a pose to start at")


def _joint_position(text: str) -> tuple[str, float]:
    """Return a joint and its position.

    Raises:
        ArgumentTypeError: The text is malformed.
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
        state = client.simulation.reset(dict(options.joint_positions), options.keyframe)
        return _tell(state, options)


def _tell(state: "Simulation", options: Namespace) -> int:
    pace = f"Running at {state.real_time_factor:g} times real time"
    how = "Paused" if state.paused else pace
    return answer(options, state, f"{how}; {state.time:.3f} s simulated.")


_NUMBERS = {"size", "position", "rpy", "colour"}
_ACTIONS = (
    "list", "put", "remove", "attach", "detach", "saved", "save", "load", "delete"
)  # fmt: skip


def add_scene(parser: "Parser") -> None:
    """Add the arguments of `scene`."""
    parser.add_argument("action", nargs="?", choices=_ACTIONS, default="list")
    parser.add_argument(
        "name", nargs="?", help="of the object; of a saved scene for the last four"
    )
    parser.add_argument(
        "values",
        nargs="*",
        type=_value,
        metavar="KEY=VALUE",
        help="of put, e.g. type=box size=0.1,1,1 position=0.6,0,0.5 role=keep_out "
        "margin=0.02; of attach arm=panda; of attach and detach load=no, which tells "
        "the arm no mass",
    )


def _value(text: str) -> tuple[str, object]:
    """Return a key and its value.

    Raises:
        ArgumentTypeError: The text is malformed.
    """
    key, sign, value = text.partition("=")
    if not sign:
        raise ArgumentTypeError(f"{text!r} is not KEY=VALUE, such as role=keep_out.")
    try:
        if key in _NUMBERS:
            return key, [float(one) for one in value.split(",")]
        if key == "margin":
            return key, float(value)
    except ValueError as error:
        raise ArgumentTypeError(f"{text!r} has no numbers.") from error
    return key, value.split(",") if key == "links" else value


def scene(options: Namespace) -> int:
    """List the scene, change one of its objects, or save it under a name."""
    action, name = options.action, options.name
    if action not in {"list", "saved"} and name is None:
        say(f"Which one? station scene {action} NAME")
        return 2
    with open_client(options) as client:
        if action in {"put", "attach", "detach"}:
            found = _change(client, options)
            carried = f", carried by {found.carried_by}" if found.carried_by else ""
            line = f"'{found.name}' is a {found.type} with the role {found.role}"
            return answer(options, found, f"{line}{carried}.")
        if action == "saved":
            names = client.scenes.names()
            return answer(options, names, *names)
        if action in {"save", "delete"}:
            kept = getattr(client.scenes, action)(name)
            word = "saved" if action == "save" else "deleted"
            line = f"The scene '{name}' with {len(kept.objects)} objects is {word}."
            return answer(options, kept, line)
        if action == "remove":
            client.remove_object(name)
        if action == "load":
            client.scenes.load(name)
        _list(client, options)
    return 0


def _change(client: "StationClient", options: Namespace) -> "SceneObject":
    values = dict(options.values)
    if options.action == "put":
        return client.put_object(options.name, **values)
    load = _is_to_load(options.action, values)
    if options.action == "attach":
        return client.attach_object(options.name, values.get("arm", ""), load=load)
    return client.detach_object(options.name, load=load)


def _is_to_load(action: str, values: dict[str, object]) -> bool:
    """Return whether the arm is told the mass of what it carries.

    Raises:
        UsageError: A key or a value is unknown.
    """
    allowed = {"arm", "load"} if action == "attach" else {"load"}
    for unknown in sorted(set(values) - allowed):
        raise UsageError(
            f"`scene {action}` has no key '{unknown}'.",
            remedy=f"Give {' and '.join(sorted(allowed))}, or leave them out.",
        )
    load = values.get("load", "yes")
    if load not in {"yes", "no"}:
        raise UsageError(f"load is '{load}'.", remedy="Give load=yes or load=no.")
    return load == "yes"


def _list(client: "StationClient", options: Namespace) -> None:
    for one in client.scene():
        at = ", ".join(f"{value or 0.0:.3f}" for value in one.position)
        carried = f", carried by {one.carried_by}" if one.carried_by else ""
        answer(options, one, f"{one.name}: {one.type}, {one.role}, at {at} m{carried}")
    for pair in () if options.json else client.clearances():
        say(
            f"{pair.arm}: {pair.link} is {1000.0 * pair.distance:.0f} mm from "
            f"'{pair.object}', margin {1000.0 * pair.margin:.0f} mm"
            + (", slowed" if pair.is_slowing else "")
        )
