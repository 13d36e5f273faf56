"""Measure everything anew and write the tables of docs/performance.md.

Run `make performance`, or `python benchmarks/write_tables.py [--only cycles peers]`, on
a machine that does nothing else. What is not measured keeps its table. Each table
stands between two comments that name it.
"""

import argparse
import json
import os
import platform
import re
import statistics
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import mujoco
from measuring import processor

FOLDER = Path(__file__).parent
PAGE = FOLDER.parent / "docs" / "performance.md"
PANDA = "Panda"
MODES = ("interpreted", "compiled")
COLUMNS = [(mode, temperature) for temperature in ("hot", "cold") for mode in MODES]

Row = dict[str, object]
Key = tuple[str, str]


def run(script: str, *arguments: str) -> list[Row]:
    """Return the rows of a benchmark."""
    command = [sys.executable, FOLDER / f"bench_{script}.py", "--json", *arguments]
    output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(output.stdout)


def medians(runs: Sequence[list[Row]]) -> list[Row]:
    """Return each row with the medians of its figures over some runs."""
    return [
        {
            key: round(statistics.median(row[key] for row in rows), 2)
            if isinstance(value, float)
            else value
            for key, value in rows[0].items()
        }
        for rows in zip(*runs, strict=True)
    ]


def table(headers: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table of Markdown."""
    lines = [headers, ["---"] * len(headers), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def write(page: Path, name: str, text: str) -> None:
    """Replace what stands between the two comments of that name.

    Args:
        page: The file.
        name: The name in the comments.
        text: What is to stand there.

    Raises:
        ValueError: The page has no such comments.
    """
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    pattern = re.escape(begin) + ".*?" + re.escape(end)
    whole, count = re.subn(
        pattern, lambda _: f"{begin}{text}\n{end}", page.read_text(), flags=re.DOTALL
    )
    if count != 1:
        raise ValueError(f"{page} has {count} places for the table '{name}'")
    page.write_text(whole)


def cost(row: Row | None) -> str:
    """Return ratio and difference of a cycle and a step."""
    if row is None:
        return "–"
    return f"{float(row['ratio']):.2f}× ({float(row['above_step_us']):.1f} µs)"


def whole(row: Row, *keys: str) -> str:
    """Return some figures of a row without decimals."""
    return ", ".join(f"{float(row[key]):.0f}" for key in keys)


def ends(labels: Sequence[tuple[object, object]]) -> list[tuple[object, object]]:
    """Return the first and the last label of each robot."""
    by_robot: dict[object, list[tuple[object, object]]] = {}
    for label in labels:
        by_robot.setdefault(label[0], []).append(label)
    return [
        label for own in by_robot.values() for label in dict.fromkeys((own[0], own[-1]))
    ]


def write_cycles(runs: int) -> None:
    """Measure cycles of all robots and write their tables."""
    rows = medians([run("cycle") for _ in range(runs)])
    found = {
        (row["robot"], row["controller"], row["mode"], row["temperature"]): row
        for row in rows
    }
    labels = list(dict.fromkeys((row["robot"], row["controller"]) for row in rows))
    headers = [f"{temperature}, {mode}" for mode, temperature in COLUMNS]

    def line(robot: object, controller: object) -> list[str]:
        name = str(controller).replace("_", " ").removesuffix(" controller")
        cells = [cost(found.get((robot, controller, *column))) for column in COLUMNS]
        return [name, *cells]

    panda = [line(*label) for label in labels if label[0] == PANDA]
    others = [[label[0], *line(*label)] for label in ends(labels) if label[0] != PANDA]
    write(PAGE, "machine", machine(rows))
    write(PAGE, "cycles", table(["runs", *headers], panda))
    write(PAGE, "robots", table(["robot", "runs", *headers], others))


def write_model(runs: int) -> None:
    """Measure state and model of an arm and write their table."""
    rows = medians([run("model") for _ in range(runs)])
    found = {(row["what"], row["mode"]): f"{row['us']:.1f}" for row in rows}
    names = list(dict.fromkeys(str(row["what"]) for row in rows))
    modes = ("interpreted", "compiled")
    lines = [
        [name, *(found.get((name, mode), "–") for mode in modes)] for name in names
    ]
    headers = ["one call", *(f"{mode} [µs]" for mode in modes)]
    write(PAGE, "model", table(headers, lines))


def write_peers(runs: int) -> None:
    """Measure other programs and write their table."""
    rows = medians([run("peers") for _ in range(runs)])
    lines = [
        [row["robot"], row["controller"], row["mode"], row["temperature"], cost(row)]
        for row in rows
    ]
    headers = ["program", "runs", "on", "caches", "a cycle over a step"]
    write(PAGE, "peers", table(headers, lines))


def write_jitter(_: int) -> None:
    """Measure the live loop and write its table."""
    rows = run("jitter")
    lines = [
        [
            row["beside"],
            whole(row, "p50_us", "p99_us", "max_us"),
            whole(row, "bare_p50_us", "bare_p99_us", "bare_max_us"),
            f"{float(row['p99_over_bare']):.2f}",
            whole(row, "cycle_p50_us", "cycle_p99_us"),
            f"{float(row['cycle_over_step']):.2f}",
            f"{float(row['rate_hz']):.1f}",
        ]
        for row in rows
    ]
    headers = [
        "beside",
        "late: p50, p99, max [µs]",
        "bare loop: p50, p99, max [µs]",
        "p99 over bare",
        "cycle: p50, p99 [µs]",
        "cycle over a step",
        "rate [Hz]",
    ]
    write(PAGE, "jitter", table(headers, lines))


def write_dashboard(_: int) -> None:
    """Measure the dashboard with three browsers and write its table."""
    rows = run("dashboard")

    def cell(value: object) -> object:
        return f"{value:.3g}" if isinstance(value, float) else value

    lines = [[cell(value) for value in row.values()] for row in rows]
    headers = ["what", "no browser", "3 browsers", "asked"]
    write(PAGE, "dashboard", table(headers, lines))


def write_batch(_: int) -> None:
    """Measure trials and write their table."""
    rows = run("batch")
    headers = [
        "stations in one process",
        "mode",
        "trials per second",
        "times real time",
        "a station: to build [s]",
        "a station: memory [MB]",
    ]
    keys = (
        *("stations", "mode", "trials_per_s"),
        *("times_real_time", "build_s", "memory_mb"),
    )
    write(PAGE, "batch", table(headers, [[row[key] for key in keys] for row in rows]))


def machine(rows: Sequence[Row]) -> str:
    """Return the machine in words."""
    steps = [
        float(row["mj_step_us"])
        for row in rows
        if (row["robot"], row["temperature"]) == (PANDA, "hot")
    ]
    return (
        f"{processor()}, {len(os.sched_getaffinity(0))} processors, "
        f"{platform.system()} {platform.release().partition('-')[0]}, "
        f"CPython {platform.python_version()}, MuJoCo {mujoco.mj_versionString()}; "
        f"one step of the Panda with its hand takes {statistics.median(steps):.1f} µs "
        "hot."
    )


PARTS: dict[str, Callable[[int], None]] = {
    "cycles": write_cycles,
    "model": write_model,
    "peers": write_peers,
    "jitter": write_jitter,
    "dashboard": write_dashboard,
    "batch": write_batch,
}


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--runs", type=int, default=5, help="whose medians count")
    options = parser.parse_args()
    for name in options.only:
        sys.stderr.write(f"measuring: {name}\n")
        PARTS[name](options.runs)


if __name__ == "__main__":
    main()
