"""Generate examples/station.ipynb from the scripts beside it.

python tools/generate_notebook.py           writes the notebook
python tools/generate_notebook.py --check   fails when it is stale
"""

import ast
import json
import sys
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "examples"
NOTEBOOK = FOLDER / "station.ipynb"
SCRIPTS = (
    "tune_by_step_responses",
    "pick_a_cube",
    "record_and_analyse",
    "tune_a_joint",
)
FIRST = """\
# A station in a notebook

Start a station first, with a cube to pick: `.venv/bin/station run examples/cube.yaml`.
The cells are the scripts of this folder; a client shows what it is connected to.
"""


def text() -> str:
    """Return the text of the notebook, without outputs."""
    show = "from station.client import StationClient\n\nStationClient()"
    cells = [_cell("markdown", "first", FIRST), _cell("code", "connect", show)]
    for name in SCRIPTS:
        source = (FOLDER / f"{name}.py").read_text()
        tree = ast.parse(source)
        title = name.replace("_", " ").capitalize()
        says = f"## {title}\n\n{ast.get_docstring(tree)}"
        code = "\n".join(source.splitlines()[(tree.body[0].end_lineno or 0) :]).strip()
        cells += [_cell("markdown", f"{name}-title", says), _cell("code", name, code)]
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = {
        "cells": cells,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


def _cell(kind: str, name: str, source: str) -> dict[str, object]:
    cell: dict[str, object] = {"cell_type": kind, "id": name, "metadata": {}}
    if kind == "code":
        cell |= {"execution_count": None, "outputs": []}
    return {**cell, "source": source.splitlines(keepends=True)}


def main() -> int:
    """Write the notebook, or with `--check` return 1 when it is stale."""
    if "--check" in sys.argv[1:]:
        is_stale = not NOTEBOOK.exists() or NOTEBOOK.read_text() != text()
        if is_stale:
            print(f"{NOTEBOOK.name} is stale: run tools/generate_notebook.py.")
        return int(is_stale)
    NOTEBOOK.write_text(text())
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
