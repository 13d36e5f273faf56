"""Generate the client for plain Python from the client for asyncio, and its page.

python tools/generate_client.py           writes station/client/_sync, docs/client.md
python tools/generate_client.py --check   fails when the files there are stale
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import unasync

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "station" / "client" / "_async"
TARGET = SOURCE.with_name("_sync")
PAGE = ROOT / "docs" / "client.md"
NOTE = "# Generated from _async/{name} by tools/generate_client.py.\n"
NAMES = {
    "_async": "_sync",
    "async_command_stream": "command_stream",
    "async_heartbeat": "heartbeat",
    "async_stream": "stream",
    "aclose": "close",
    "aiter_bytes": "iter_bytes",
    "aread": "read",
    "AsyncBaseTransport": "BaseTransport",
    "AsyncClient": "Client",
    "AsyncGoalHandle": "GoalHandle",
    "asyncio": "time",
    "AsyncCommandStream": "CommandStream",
    "AsyncConnection": "Connection",
    "AsyncControlLease": "ControlLease",
    "AsyncExperimentsClient": "ExperimentsClient",
    "AsyncGainSetsClient": "GainSetsClient",
    "AsyncGripperClient": "GripperClient",
    "AsyncHeartbeat": "Heartbeat",
    "AsyncLeaseClient": "LeaseClient",
    "AsyncIncidentsClient": "IncidentsClient",
    "AsyncRecordingsClient": "RecordingsClient",
    "_AsyncFiles": "_Files",
    "AsyncRobotClient": "RobotClient",
    "AsyncSimulationClient": "SimulationClient",
    "AsyncStationClient": "StationClient",
    "AsyncStream": "Stream",
    "AsyncTokensClient": "TokensClient",
    "AsyncAlarmsClient": "AlarmsClient",
    "AsyncWaypointPathsClient": "WaypointPathsClient",
}


def generate() -> dict[str, str]:
    """Return the text of every generated module by its file name."""
    sources = [path for path in SOURCE.glob("*.py") if path.name != "__init__.py"]
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "_async"), Path(folder, "_sync")
        source.mkdir()
        for path in sources:
            note = NOTE.format(name=path.name)
            (source / path.name).write_text(note + path.read_text())
        rule = unasync.Rule(f"{source}/", f"{target}/", NAMES)
        unasync.unasync_files([str(source / path.name) for path in sources], [rule])
        # Without "async" and "Async" lines are shorter and imports sort differently.
        for command in (
            ["check", "--quiet", "--select=I", "--fix"],
            ["format", "--quiet"],
        ):
            ruff = [sys.executable, "-m", "ruff", *command]
            configuration = f"--config={ROOT / 'pyproject.toml'}"
            subprocess.run([*ruff, configuration, str(target)], check=True, cwd=ROOT)
        return {path.name: (target / path.name).read_text() for path in sources}


def stale() -> list[str]:
    """Return the names of the files whose text is not what would be generated."""
    expected = generate()
    present = {path.name: path.read_text() for path in TARGET.glob("*.py")}
    present.pop("__init__.py", None)
    names = sorted(expected.keys() | present.keys())
    return [name for name in names if expected.get(name) != present.get(name)]


def main() -> int:
    """Write the files, or with `--check` say which are stale and return 1."""
    if "--check" in sys.argv[1:]:
        names = stale() or ([] if _page() == PAGE.read_text() else [PAGE.name])
        if names:
            print(f"Stale: {', '.join(names)}.")
            print("Run .venv/bin/python tools/generate_client.py.")
        return int(bool(names))
    for name, text in generate().items():
        (TARGET / name).write_text(text)
    PAGE.write_text(_page())
    return 0


def _page() -> str:
    # Imported late: it reads the docstrings of what has just been written.
    from client_page import page

    return page()


if __name__ == "__main__":
    raise SystemExit(main())
