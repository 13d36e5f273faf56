"""The verb `scene`: the objects around robots, and scenes that have a name."""

from argparse import ArgumentTypeError, Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.output import say, say_model

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import SceneObject

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
        ArgumentTypeError: The text has another form.
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
    """List the scene, change one of its objects, or keep it under a name."""
    action, name = options.action, options.name
    if action not in {"list", "saved"} and name is None:
        say(f"Which one? station scene {action} NAME")
        return 2
    with open_client(options) as client:
        if action in {"put", "attach", "detach"}:
            _tell_object(_change(client, options), as_json=options.json)
            return 0
        if action == "saved":
            for one in client.scenes.names():
                say(one)
            return 0
        if action in {"save", "delete"}:
            kept = getattr(client.scenes, action)(name)
            word = "saved" if action == "save" else "deleted"
            say(f"The scene '{name}' with {len(kept.objects)} objects is {word}.")
            return 0
        if action == "remove":
            client.remove_object(name)
        if action == "load":
            client.scenes.load(name)
        _list(client, as_json=options.json)
    return 0


def _change(client: "StationClient", options: Namespace) -> "SceneObject":
    values = dict(options.values)
    if options.action == "put":
        return client.put_object(options.name, **values)
    load = values.pop("load", "yes") != "no"
    if options.action == "attach":
        return client.attach_object(options.name, values.get("arm", ""), load=load)
    return client.detach_object(options.name, load=load)


def _tell_object(found: "SceneObject", *, as_json: bool) -> None:
    if as_json:
        say_model(found)
        return
    carried = f", carried by {found.carried_by}" if found.carried_by else ""
    say(f"'{found.name}' is a {found.type} with the role {found.role}{carried}.")


def _list(client: "StationClient", *, as_json: bool) -> None:
    for one in client.scene():
        if as_json:
            say_model(one)
            continue
        at = ", ".join(f"{value or 0.0:.3f}" for value in one.position)
        carried = f", carried by {one.carried_by}" if one.carried_by else ""
        say(f"{one.name}: {one.type}, {one.role}, at {at} m{carried}")
    for pair in () if as_json else client.clearances():
        say(
            f"{pair.arm}: {pair.link} is {1000.0 * pair.distance:.0f} mm from "
            f"'{pair.object}', margin {1000.0 * pair.margin:.0f} mm"
            + (", slowed" if pair.is_slowing else "")
        )
