"""Verbs for a simulated robot: pause, resume, step, reset, and the scene around it."""

from argparse import ArgumentTypeError, Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, say, say_json
from station.cli.parser import check_words, unique
from station.core.errors import counted, suggest

if TYPE_CHECKING:
    from collections.abc import Sequence

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
        state = client.simulation.reset(
            unique(options.joint_positions), options.keyframe
        )
        return _tell(state, options)


def _tell(state: "Simulation", options: Namespace) -> int:
    pace = f"Running at {state.real_time_factor:g} times real time"
    how = "Paused" if state.paused else pace
    return answer(options, state, f"{how}; {state.time:.3f} s simulated.")


_NUMBERS = {"size", "position", "rpy", "orientation", "colour"}
_KEYS = (
    "type", "size", "position", "rpy", "orientation", "role", "margin", "links",
    "colour", "file",
)  # fmt: skip
"""Keys of `put`; only the configuration has those of bodies, such as a mass."""
_ACTIONS = {
    "list": "", "saved": "",
    "put": "name values", "attach": "name values", "detach": "name values",
    **dict.fromkeys(("remove", "save", "load", "delete"), "name"),
}  # fmt: skip
"""Arguments that each action uses."""


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
    """List the scene, change one of its objects, or save it under a name.

    Raises:
        UsageError: There are too few or too many words.
    """
    action, name = options.action, options.name
    check_words(options, _ACTIONS)
    if "name" in _ACTIONS[action] and name is None:
        raise UsageError(
            f"`scene {action}` needs a name.", remedy=f"station scene {action} NAME"
        )
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
            content = counted(len(kept.objects), "object")
            line = f"The scene '{name}' with {content} is {word}."
            return answer(options, kept, line)
        if action == "remove":
            client.remove_object(name)
        if action == "load":
            client.scenes.load(name)
        _list(client, options)
    return 0


def _change(client: "StationClient", options: Namespace) -> "SceneObject":
    values = unique(options.values)
    if options.action == "put":
        _check_keys("put", values, _KEYS)
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
    _check_keys(action, values, ("arm", "load") if action == "attach" else ("load",))
    load = values.get("load", "yes")
    if load not in {"yes", "no"}:
        raise UsageError(f"load is '{load}'.", remedy="Give load=yes or load=no.")
    return load == "yes"


def _check_keys(
    action: str, values: dict[str, object], allowed: "Sequence[str]"
) -> None:
    for unknown in sorted(set(values) - set(allowed)):
        raise UsageError(
            f"`scene {action}` has no key '{unknown}'.",
            remedy=f"{suggest(unknown, allowed)} Leave out what is to stay as it is.",
        )


def _list(client: "StationClient", options: Namespace) -> None:
    objects = client.scene()
    if options.json:
        say_json(objects)
        return
    for one in objects:
        at = ", ".join(f"{value or 0.0:.3f}" for value in one.position)
        carried = f", carried by {one.carried_by}" if one.carried_by else ""
        say(f"{one.name}: {one.type}, {one.role}, at {at} m{carried}")
    for pair in client.clearances():
        say(
            f"{pair.arm}: {pair.link} is {1000.0 * pair.distance:.0f} mm from "
            f"'{pair.object}', margin {1000.0 * pair.margin:.0f} mm"
            + (", slowed" if pair.is_slowing else "")
        )
