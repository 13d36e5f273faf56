"""Verbs about recordings and incidents."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, answer_table
from station.cli.parser import check_words
from station.core.errors import RecordingRefusedError, counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import Recording

FORMATS = ("mcap", "csv", "npz", "parquet")
_RECORD = {
    "start": "name note",
    "get": "name output format channels joints rate",
    "list": "",
    **dict.fromkeys(("stop", "delete", "rerun"), "name"),
}
"""Arguments that each action uses."""
_NEEDS_NAME = frozenset({"get", "delete", "rerun"})


def add_record(parser: "Parser") -> None:
    """Add the arguments of `record`."""
    add = parser.add_argument
    add("action", choices=("start", "stop", "list", "get", "delete", "rerun"))
    add(
        "name",
        nargs="?",
        metavar="NAME",
        help="start: what to call it; stop, get, delete: which one; rerun: a file",
    )
    add("--note", default="", help="start: for the record")
    _add_file_options(parser)


def add_incidents(parser: "Parser") -> None:
    """Add the arguments of `incidents`."""
    add = parser.add_argument
    add("action", choices=("list", "get"))
    add("name", nargs="?", metavar="ID", help="get: which one")
    _add_file_options(parser)


def add_recover_file(parser: "Parser") -> None:
    """Add the arguments of `recover_file`."""
    parser.add_argument("file", type=Path, metavar="FILE")


def _add_file_options(parser: "Parser") -> None:
    add = parser.add_argument
    add("-o", "--output", type=Path, metavar="FILE", help="get: where to write")
    add("--format", choices=FORMATS, default="mcap", help="get: mcap, or a table")
    add(
        "--channels",
        nargs="+",
        default=[],
        metavar="CHANNEL",
        help="get a table: of these channels, or fields of channels such as "
        "joint_states/position",
    )
    add("--joints", nargs="+", default=[], metavar="JOINT", help="and of these joints")
    add(
        "--rate",
        type=float,
        metavar="HZ",
        help="and with so many rows per second; default every cycle",
    )


def record(options: Namespace) -> int:
    """Start, stop, list, fetch, delete or re-run recordings.

    Raises:
        UsageError: The name of the recording is missing.
    """
    action = options.action
    check_words(options, _RECORD)
    if action in _NEEDS_NAME and options.name is None:
        raise UsageError(
            f"`record {action}` needs to know which recording.",
            remedy="`station record list` has their names; `rerun` takes a file.",
        )
    if action == "rerun":
        return _rerun(options)
    with open_client(options) as client:
        if action == "list":
            return _say_all(client.recordings.list(), options)
        if action == "get":
            return _get(client, options, is_incident=False)
        if action == "start":
            found = client.recordings.start(options.name or "", options.note)
        elif action == "delete":
            found = client.recordings.delete(options.name)
        else:
            found = _stop(client, options.name)
    answer(options, found, _told(found, action))
    return int(found.state == "failed" and action == "stop")


def incidents(options: Namespace) -> int:
    """List incidents, or fetch one.

    Raises:
        UsageError: The name of the incident is missing.
    """
    check_words(options, {"list": "", "get": _RECORD["get"]})
    if options.action == "get" and options.name is None:
        raise UsageError(
            "`incidents get` needs to know which incident.",
            remedy="`station incidents list` has their names.",
        )
    with open_client(options) as client:
        if options.action == "list":
            return _say_all(client.incidents.list(), options)
        return _get(client, options, is_incident=True)


def recover_file(options: Namespace) -> int:
    """Repair a recording whose end is missing, or that has damaged bytes."""
    from station.records.mcap_recovery import recover_file as recover
    from station.records.record_store import RecordStore

    found = recover(options.file)
    RecordStore(options.file.parent).note_recovery(options.file.stem, found)
    summary = {
        "changed": found.is_changed,
        "messages": found.messages,
        "dropped": found.dropped,
        "lost_messages": found.lost_messages,
        "losses": list(found.losses),
    }
    line = (
        f"The file is whole: {counted(found.messages, 'message')}. Nothing was changed."
    )
    if found.is_changed:
        line = f"Recovered {counted(found.messages, 'message')}. {found.text()}"
    return answer(options, summary, line)


def _stop(client: "StationClient", name: str | None) -> "Recording":
    try:
        return client.recordings.stop(name)
    except LookupError as error:
        raise RecordingRefusedError(
            str(error), remedy="`station record start` begins a recording."
        ) from error


def _told(found: "Recording", action: str) -> str:
    """Return a sentence about a recording."""
    if action == "start":
        return f"Recording {found.identifier}. `station record stop` ends it."
    if action == "delete":
        return f"Deleted {found.identifier}."
    text = f"{found.identifier}: {found.cycles} cycles, {found.size / 1e6:.1f} MB"
    lost = f", {found.lost} lost" if found.lost else ", none lost"
    problem = f" {found.error}" if found.error else ""
    return f"{text}{lost}.{problem}"


def _say_all(found: "Sequence[Recording]", options: Namespace) -> int:
    rows = [
        [
            one.identifier,
            one.state,
            f"{one.duration:.1f} s",
            f"{one.cycles}",
            f"{one.lost}",
            f"{one.size / 1e6:.1f} MB",
            " ".join([*one.causes, one.error, one.note]).strip() or "-",
        ]
        for one in found
    ]
    headers = ["id", "state", "duration", "cycles", "lost", "size", "remarks"]
    return answer_table(options, found, headers, rows, "There are none.")


def _get(client: "StationClient", options: Namespace, *, is_incident: bool) -> int:
    """Fetch the file, and make a table of it if the options ask for one.

    Raises:
        UsageError: The target file exists already, or the options contradict each
            other.
    """
    source = client.incidents if is_incident else client.recordings
    target = options.output or Path(f"{options.name}.{options.format}")
    if target.exists():
        raise UsageError(
            f"There is a file {target} already.", remedy="Give another one with -o."
        )
    is_part = bool(options.channels or options.joints or options.rate is not None)
    if options.format == "mcap" and is_part:
        raise UsageError(
            "--channels, --joints and --rate choose of a table, not of an MCAP file.",
            remedy="Add --format csv, npz or parquet.",
        )
    if options.rate is not None and not 0.0 < options.rate < float("inf"):
        raise UsageError(
            f"--rate {options.rate:g} is no number of rows per second.",
            remedy="Give one above 0.",
        )
    if options.format == "mcap":
        source.download(options.name, target)
    else:
        import tempfile

        from station.records.recording_table import Choice, export

        choice = Choice(tuple(options.channels), tuple(options.joints), options.rate)
        with tempfile.TemporaryDirectory() as folder:
            file = source.download(options.name, Path(folder, "recording.mcap"))
            export(file, target, options.format, choice)
    line = f"Wrote {target} ({target.stat().st_size / 1e6:.1f} MB)."
    return answer(options, {"file": str(target)}, line)


def _rerun(options: Namespace) -> int:
    from station.app.rerun import rerun

    found = rerun(Path(options.name))
    answer(options, found.as_json(), found.text())
    return 0 if found.is_equal else 1
