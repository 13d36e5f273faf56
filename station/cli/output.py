"""Output of the verbs: tables for people, JSON for programs."""

import json
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic import BaseModel

    from station.reports import Report


def say(text: str) -> None:
    """Print a line."""
    sys.stdout.write(f"{text}\n")


def say_progress(text: str) -> None:
    """Print a line of progress to stderr at once."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


def say_json(data: object) -> None:
    """Print `data` as one line of JSON."""
    say(json.dumps(data))


def say_models(models: "Sequence[BaseModel | Report]") -> None:
    """Print wire models as a JSON list, by their names on the wire."""
    _say_answer(models)


def say_model(model: "BaseModel | Report") -> None:
    """Print a wire model as JSON, by its names on the wire."""
    _say_answer(model)


def _say_answer(answer: object) -> None:
    from pydantic_core import to_jsonable_python

    say_json(to_jsonable_python(answer, by_alias=True))


def say_table(headers: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table: with lines and colours on a terminal, else plain columns."""
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
