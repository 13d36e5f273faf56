"""Verb `lesson`: exercises that the station checks on the student's own run."""

import getpass
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, answer_table, say
from station.cli.parser import read_number, unique

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire.lessons import Lesson


def add_lesson(parser: "Parser") -> None:
    """Add the arguments of `lesson`."""
    add = parser.add_argument
    add("action", choices=("list", "show", "begin", "check"))
    add("name", nargs="?", metavar="NAME", help="the lesson")
    add("answers", nargs="*", metavar="ANSWER=VALUE", help="check: worked-out numbers")
    add(
        "--person",
        default=getpass.getuser(),
        help="whose progress is kept; the user of this machine when left out",
    )


def lesson(options: Namespace) -> int:
    """List or show lessons, begin one, or check it; return 1 if it is not solved.

    Raises:
        UsageError: There are too few or too many words.
    """
    needs_name = options.action != "list"
    if (options.name is not None) != needs_name or (
        options.answers and options.action != "check"
    ):
        raise UsageError(
            f"The words after `lesson {options.action}` are too few or too many.",
            remedy="station lesson list, station lesson begin p_alone, "
            "station lesson check p_alone steady_error=5.1.",
        )
    answers = unique(map(read_number, options.answers))
    with open_client(options) as client:
        if options.action == "check":
            return _check(client, options, answers)
        if options.action == "list":
            return _list(client, options)
        if options.action == "begin":
            found = client.lessons.begin(options.name, options.person)
        else:
            found = _find(client, options)
    asked = (f"Answer: {one.name}=… [{one.unit}] {one.label}" for one in found.answers)
    return answer(options, found, f"{found.title}\n\n{found.text}", *asked)


def _find(client: "StationClient", options: Namespace) -> "Lesson":
    """Return a lesson.

    Raises:
        UsageError: There is no such lesson.
    """
    known = {one.name: one for one in client.lessons.list(options.person).lessons}
    if options.name not in known:
        raise UsageError(
            f"There is no lesson {options.name!r}.",
            remedy=f"There are: {', '.join(known)}.",
        )
    return known[options.name]


def _list(client: "StationClient", options: Namespace) -> int:
    found = client.lessons.list(options.person)
    rows = [
        ["✔" if one.is_solved else "", one.name, one.title] for one in found.lessons
    ]
    answer_table(options, found.lessons, ["", "lesson", "title"], rows)
    for reason in () if options.json else found.unusable:
        say(f"Left out: {reason}")
    return 0


def _check(
    client: "StationClient", options: Namespace, answers: dict[str, float]
) -> int:
    result = client.lessons.check(options.name, options.person, answers)
    lines = []
    for one in result.verdicts:
        lines.append(f"{'✔' if one.is_met else '✖'} {one.says}")
        lines += [f"  {one.hint}"] if one.hint else []
    end = "Solved." if result.is_solved else "Not solved yet."
    answer(options, result, *lines, end)
    return 0 if result.is_solved else 1
