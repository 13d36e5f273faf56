"""Output of the verbs: tables for people, JSON for programs."""

import json
import sys
from argparse import Namespace
from collections.abc import Sequence


def escaped(text: str, kept: str = "\n\t") -> str:
    """Return a text in which no sign steers the terminal.

    Names and notes come from anybody, also from agents: an escape sequence could
    overwrite what a person is about to allow.

    Args:
        text: The text.
        kept: Signs that stay although they are not printable; others are escaped.
    """
    if text.isprintable():
        return text
    return "".join(
        one if one.isprintable() or one in kept else ascii(one)[1:-1] for one in text
    )


def say(text: str) -> None:
    """Print a line."""
    sys.stdout.write(f"{escaped(text)}\n")


def say_progress(text: str) -> None:
    """Print a line of progress to stderr, without buffering."""
    sys.stderr.write(f"{escaped(text)}\n")
    sys.stderr.flush()


def say_now(text: str) -> None:
    """Print a line without buffering, for a reader that waits for it."""
    say(text)
    sys.stdout.flush()


def say_now_json(data: object) -> None:
    """Print data as one line of JSON, without buffering."""
    say_json(data)
    sys.stdout.flush()


def say_json(data: object) -> None:
    """Print data as one line of JSON; models and dataclasses by their wire names."""
    say(json.dumps(data, default=_jsonable))


def _jsonable(value: object) -> object:
    # Imported late, so that a stop need not wait for the import.
    from pydantic_core import to_jsonable_python

    return to_jsonable_python(value, by_alias=True)


def answer(options: Namespace, found: object, *lines: str) -> int:
    """Print lines, or with `--json` the data; return the exit code 0."""
    if options.json:
        say_json(found)
    else:
        for line in lines:
            say(line)
    return 0


def answer_table(
    options: Namespace,
    found: object,
    headers: Sequence[str],
    rows: Sequence[Sequence[str]],
    nothing: str = "",
) -> int:
    """Print a table, or with `--json` the data; return the exit code 0.

    Args:
        options: Options of the verb.
        found: Data of the table, for `--json`.
        headers: Headers of the columns.
        rows: Cells of the rows.
        nothing: Printed in place of a table without rows, if not empty.
    """
    if not options.json and (rows or not nothing):
        say_table(headers, rows)
        return 0
    return answer(options, found, nothing)


def number(value: float | None, nothing: str = "-") -> str:
    """Return a number as text, or `nothing` for None."""
    return nothing if value is None else f"{value:g}"


def say_table(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table: with lines and colours on a terminal, else plain columns."""
    rows = [[escaped(cell, "") for cell in row] for row in rows]
    if sys.stdout.isatty():
        _say_rich(headers, rows)
        return
    lines = [tuple(headers), *(tuple(row) for row in rows)]
    widths = [max(len(cell) for cell in column) for column in zip(*lines, strict=True)]
    for line in lines:
        cells = (cell.ljust(width) for cell, width in zip(line, widths, strict=True))
        say("  ".join(cells).rstrip())


def _say_rich(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, header_style="bold", pad_edge=False)
    for header in headers:
        table.add_column(header)
    for row in rows:
        table.add_row(*(Text(cell, style=_STYLES.get(cell, "")) for cell in row))
    Console(soft_wrap=True).print(table)


_STYLES = {"running": "green", "aborted": "red", "ok": "green", "warning": "yellow"}
