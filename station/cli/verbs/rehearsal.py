"""Verb `rehearse`: try a motion in a copy of the station."""

import json
import sys
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import say, say_json
from station.cli.parser import read_duration, unique

if TYPE_CHECKING:
    from pydantic import JsonValue

    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import Rehearsal

_TRAJECTORY = "/JointTrajectoryController"


def add_rehearse(parser: "Parser") -> None:
    """Add the arguments of `rehearse`."""
    add = parser.add_argument
    add("controller", nargs="?", help="a running controller")
    add(
        "values",
        nargs="*",
        metavar="V",
        help="a set-point; for a trajectory controller a pose, or positions [rad or m]",
    )
    add(
        "--duration",
        type=read_duration,
        metavar="S",
        help="of a trajectory; without: calm",
    )
    add("--path", metavar="NAME", help="one round of a waypoint path")
    add("--file", metavar="FILE", help="a JSON list of steps; - for standard input")
    add("--seconds", type=float, metavar="S", help="how long; without: until all rests")
    add(
        "--certificate",
        action="store_true",
        help="ask for a certificate, to give the command with",
    )


def rehearse(options: Namespace) -> int:
    """Forecast a motion; return 1 if it would not be completed."""
    with open_client(options) as client:
        rehearsal = client.rehearse(
            _steps(client, options),
            seconds=options.seconds,
            certificate=options.certificate,
        )
    if options.json:
        say_json(rehearsal)
    else:
        _tell(rehearsal)
    return 0 if rehearsal.outcome == "completed" else 1


def _steps(client: "StationClient", options: Namespace) -> "list[dict[str, JsonValue]]":
    """Return the steps that the arguments ask for.

    Raises:
        UsageError: The command to rehearse is missing or there are several, or the
            file holds no steps.
    """
    named = {
        "a controller": options.controller,
        "--path": options.path,
        "--file": options.file,
    }
    given = [source for source, value in named.items() if value is not None]
    if len(given) > 1:
        raise UsageError(
            f"What to rehearse was named twice: by {' and by '.join(given)}.",
            remedy="Name a controller with a set-point, or give --path or --file.",
        )
    if options.duration is not None and options.controller is None:
        raise UsageError(
            f"--duration {options.duration:g} is for a controller alone.",
            remedy="Leave it out: --path and --file have their own times.",
        )
    if options.file is not None:
        return _steps_of_file(options.file)
    if options.path is not None:
        from station.wire.rehearsal import PathStep

        # Checked here, where its field has the name of the option.
        step = PathStep(kind="path", path=options.path)
        return [step.model_dump(exclude_unset=True)]
    name, values = options.controller, options.values
    if name is None or not values:
        raise UsageError(
            "Nothing to rehearse was named.",
            remedy="Name a running controller and a set-point, or give --path or "
            "--file.",
        )
    if client.controller(name).type.endswith(_TRAJECTORY):
        return [_goal(client, name, values, options.duration)]
    numbers: list[JsonValue] = [*_numbers(values)]
    return [{"kind": "set_point", "name": name, "values": numbers}]


def _steps_of_file(file: str) -> "list[dict[str, JsonValue]]":
    try:
        text = sys.stdin.read() if file == "-" else Path(file).read_text("utf-8")
        steps = json.loads(text, object_pairs_hook=unique)
    except (OSError, ValueError) as error:
        raise UsageError(
            f"{file} cannot be read: {error}.", remedy="Give a JSON list of steps."
        ) from error
    if (
        not isinstance(steps, list)
        or not steps
        or not all(isinstance(one, dict) for one in steps)
    ):
        raise UsageError(
            f"{file} holds no list of steps.",
            remedy='A step is such as {"kind": "path", "path": "wave"}.',
        )
    return steps


def _goal(
    client: "StationClient", name: str, values: list[str], duration: float | None
) -> "dict[str, JsonValue]":
    from station.client.poses import check_name, joint_positions, trajectory_goal

    target: str | list[float]
    if len(values) == 1 and not _is_number(values[0]):
        target = values[0]
        check_name(target)
    else:
        target = _numbers(values)
    here = client.query_state(name)
    wanted = joint_positions(target, here.name, here.position)
    goal = trajectory_goal(here.name, here.position, wanted, duration)
    return {"kind": "goal", "name": name, "request": dict(goal)}


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _numbers(values: list[str]) -> list[float]:
    """Return the numbers of some texts.

    Raises:
        UsageError: A text is not a number.
    """
    for value in values:
        if not _is_number(value):
            raise UsageError(f"{value!r} is no number.", remedy="Give numbers alone.")
    return [float(value) for value in values]


def _tell(trial: "Rehearsal") -> None:
    say(
        f"{trial.outcome} after {trial.duration:.3f} s ({trial.cycles} cycles, "
        f"rehearsed in {1e3 * trial.wall_time:.0f} ms)."
    )
    if trial.twin == "model":
        say("A model of the arm was moved; it is as good as its parameters.")
    if trial.error is not None:
        error = trial.error
        where = f" at {error.where}" if error.where else ""
        say(f"{error.cause}{where} in cycle {error.cycle}: {error.text}")
        for pair in error.touching:
            say(f"Touching: {' and '.join(pair)}.")
    near = [one for one in trial.joints if one.position_margin is not None]
    if near:
        least = min(near, key=lambda one: one.position_margin or 0.0)
        say(f"Nearest to a limit: {least.joint}, {least.position_margin:.3f} left.")
    for one in trial.clearances:
        kept = "" if one.margin is None else f", margin {1e3 * one.margin:.0f} mm"
        say(
            f"Nearest: {' and '.join(one.bodies)}, {1e3 * one.distance:.0f} mm in "
            f"cycle {one.cycle}{kept}."
        )
    for contact in trial.contacts:
        say(f"{' and '.join(contact.bodies)} touch with {contact.force:.1f} N.")
    cut = [one.joint for one in trial.joints if one.cut_off]
    if cut:
        say(f"Limits cut off commands of: {', '.join(cut)}.")
    if trial.certificate is not None:
        say(
            f"Certificate: {trial.certificate.name} (valid for "
            f"{trial.certificate.valid_for:g} s)"
        )
