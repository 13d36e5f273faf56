"""Verb `robot`: the services that a robot declares."""

import json
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_json, say_models, say_table

if TYPE_CHECKING:
    from pydantic import JsonValue

    from station.client import RobotClient


def robot(options: Namespace) -> int:
    """List the services of a robot, or call one of them and print its answer."""
    arguments = dict(_parse(argument) for argument in options.arguments)
    with open_client(options) as client:
        chosen = client.robot(options.arm_id)
        if options.service is None:
            return _list(chosen, as_json=options.json)
        name = options.service.replace("-", "_")
        answer = chosen.call(name, **arguments)
    if options.json:
        say_json(answer)
    elif answer is None:
        say("Done.")
    else:
        say(json.dumps(answer, indent=2))
    return 0


def _list(chosen: "RobotClient", *, as_json: bool) -> int:
    services = chosen.services()
    if as_json:
        say_models(services)
    else:
        rows = [
            [
                service.name,
                ", ".join(service.parameters) or "-",
                service.description.partition("\n")[0],
            ]
            for service in services
        ]
        say_table(["service", "arguments", "does"], rows)
    return 0


def _parse(argument: str) -> "tuple[str, JsonValue]":
    """Return name and value of `NAME=VALUE`.

    Raises:
        UsageError: The text has another form.
    """
    name, equals, text = argument.partition("=")
    if not equals or not name.isidentifier():
        raise UsageError(
            f"{argument!r} is not NAME=VALUE.",
            remedy="Write it like mass=0.5 or lengths=[1.0,2.0].",
        )
    try:
        return name, json.loads(text)
    except ValueError:
        return name, text
