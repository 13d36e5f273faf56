"""How the parameter files of robot makers fare, each in a station of its own.

Run `python benchmarks/makers_files.py [--folder DIR] [--table FILE]`.
`makers_files.txt` beside this script names the files: repository, commit and path.
They are fetched from GitHub into the folder, by default one in the user's cache, once;
none is part of this project. A file runs unchanged when every controller in it is
loaded by a station whose mock robot has the joints that the file names; the files of
Franka's own packages get a simulated Panda.
"""

import argparse
import logging
import re
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

LIST = Path(__file__).with_suffix(".txt")
BEGIN, END = "<!-- makers -->", "<!-- end of makers -->"
_URL = "https://raw.githubusercontent.com/{repository}/{commit}/{path}"
_NAMES = {"joint", "left_wheel", "right_wheel", "joint_name"}
_LISTS = {"joints", "joint_names", "left_wheel", "right_wheel"}
_MOST = 160  # characters of a line of a page
_MOST_NAME = 110


@dataclass
class Row:
    """How one file fared.

    Attributes:
        repository: Its repository.
        path: Its path there.
        controllers: Number of controllers in it.
        loaded: Number of those that were loaded.
        reasons: Why the others were not, or why the file was refused.
    """

    repository: str
    path: str
    controllers: int = 0
    loaded: int = 0
    reasons: list[str] = field(default_factory=list)


def fetch(line: str, folder: Path) -> Path | None:
    """Return the local copy of a file of the list, fetched if need be."""
    repository, commit, path = line.split(maxsplit=2)
    local = folder / repository / commit / path
    if not local.exists():
        url = _URL.format(repository=repository, commit=commit, path=path)
        try:
            with urllib.request.urlopen(url, timeout=30) as answer:
                content = answer.read()
        except (urllib.error.URLError, TimeoutError):
            return None
        local.parent.mkdir(parents=True, exist_ok=True)
        local.write_bytes(content)
    return local


def examine(line: str, folder: Path) -> Row:
    """Return how a file of the list fares."""
    from station.app.composition import compose
    from station.config import load_config
    from station.core.errors import StationError

    repository, _, path = line.split(maxsplit=2)
    row = Row(repository, path)
    file = fetch(line, folder)
    if file is None:
        row.reasons = ["not fetched"]
        return row
    robot: dict[str, object] = {"type": "mock_hw/MockRobotHW", "arm_id": "panda"}
    try:
        config = load_config(
            {"robot": {**robot, "joints": ["a"]}, "start": []}, controller_files=[file]
        )
        names = sorted(set(_joints(config.controller_parameters())))
        made = {"type": "mock_hw/MockRobotHW", "joints": names or ["a"]}
        if repository.startswith("frankaemika/"):
            made = load_config().robot_parameters()  # their own arm, simulated
        robot_section = type(config.robot).model_validate(made)
        config = config.model_copy(update={"robot": robot_section})
        row.controllers = len(config.controllers)
        parameters = dict(config.parameters)
        if made["type"] == "mock_hw/MockRobotHW":
            parameters.setdefault("robot_description", _urdf(names))
        composed = compose(config.model_copy(update={"parameters": parameters}))
        row.reasons = [error.message for error in composed.not_loaded.values()]
        row.loaded = row.controllers - len(composed.not_loaded)
    except StationError as error:
        row.reasons = [str(error.message)]
    return row


def _joints(value: object) -> Iterator[str]:
    """Yield the names of all joints in some parameters."""
    if isinstance(value, list):
        for one in value:
            yield from _joints(one)
    if not isinstance(value, dict):
        return
    for key, inside in value.items():
        if key in _NAMES and isinstance(inside, str):
            yield inside
        elif key in _LISTS and isinstance(inside, list):
            yield from (one for one in inside if isinstance(one, str))
        else:
            yield from _joints(inside)


def _urdf(joints: list[str]) -> str:
    parts = [
        f'<joint name="{name}" type="continuous"><parent link="base"/>'
        f'<child link="{name}_link"/><origin xyz="0 {place} 0"/>'
        '<limit effort="100" velocity="10"/></joint>'
        f'<link name="{name}_link"><collision><geometry><sphere radius="0.1"/>'
        "</geometry></collision></link>"
        for place, name in enumerate(joints)
    ]
    return f'<robot name="r"><link name="base"/>{"".join(parts)}</robot>'


def table(rows: list[Row]) -> str:
    """Return the rows in Markdown."""
    lines = ["| file | controllers | loaded | what is missing |", "|---|---|---|---|"]
    for row in rows:
        missing = "; ".join(sorted({_short(reason) for reason in row.reasons})[:2])
        name = f"{row.repository}/{row.path}"
        if missing and len(name) > _MOST_NAME:  # the list beside this file has it whole
            name = f"{row.repository}/…/{Path(row.path).name}"
        begin = f"| `{name}` | {row.controllers} | {row.loaded} | "
        most = _MOST - len(begin) - len(" |")
        if len(missing) > most:
            missing = f"{missing[: most - 1]}…"
        lines.append(f"{begin}{missing} |")
    return "\n".join(lines)


def _short(reason: str) -> str:
    text = re.sub(r"\S*/(?=[^/ ]+\.yaml)", "", " ".join(reason.split()))
    text = re.sub(r"No loader knows the controller type '[\w/]*?(\w+)'.*", r"\1", text)
    return text.replace("|", "\\|")


def main() -> int:
    """Examine all files; 1 if fewer than half run unchanged."""
    parser = argparse.ArgumentParser(description=__doc__)
    home = Path("~/.cache/control-station/makers").expanduser()
    parser.add_argument("--folder", type=Path, default=home)
    parser.add_argument("--table", type=Path, metavar="FILE")
    options = parser.parse_args()
    logging.disable(logging.CRITICAL)
    lines = [line for line in LIST.read_text().splitlines() if line.strip()]
    rows = [examine(line, options.folder) for line in lines]
    text = table(rows)
    sys.stdout.write(f"{text}\n")
    if options.table is not None:
        page = options.table.read_text(encoding="utf-8")
        before, _, rest = page.partition(BEGIN)
        after = rest.partition(END)[2]
        page = f"{before}{BEGIN}\n{text}\n{END}{after}"
        options.table.write_text(page, encoding="utf-8")
    whole = sum(row.loaded == row.controllers > 0 for row in rows)
    sys.stdout.write(f"{whole} of {len(rows)} files run unchanged\n")
    return int(2 * whole < len(rows))


if __name__ == "__main__":
    sys.exit(main())
