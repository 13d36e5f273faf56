"""The verbs about recordings: `record`, `incidents`, `recover_file`."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from station.cli.arguments import Verbs
    from station.cli.parser import Parser

FORMATS = ("mcap", "csv", "npz", "parquet")


def add_record_verbs(verbs: "Verbs") -> None:
    """Add the verbs."""
    record = verbs.add(
        "record",
        "records:record",
        "record every cycle; list, fetch, delete and run recordings again",
    )
    record.add_argument(
        "action", choices=("start", "stop", "list", "get", "delete", "rerun")
    )
    record.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="start: what to call it; stop, get, delete: which one; rerun: a file",
    )
    record.add_argument("--note", default="", help="start: for the record")
    _add_file_options(record)
    incidents = verbs.add(
        "incidents",
        "records:incidents",
        "list or fetch what was kept of stops, reflexes, overruns and faults",
    )
    incidents.add_argument("action", choices=("list", "get"))
    incidents.add_argument("name", nargs="?", metavar="ID", help="get: which one")
    _add_file_options(incidents)
    recover = verbs.add(
        "recover_file",
        "records:recover_file",
        "mend a recording whose end is missing, or that has damaged bytes",
        is_client=False,
    )
    recover.add_argument("file", type=Path, metavar="FILE")


def _add_file_options(parser: "Parser") -> None:
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="get: where to write"
    )
    parser.add_argument(
        "--format", choices=FORMATS, default="mcap", help="get: mcap, or a table"
    )
    parser.add_argument(
        "--channels",
        nargs="+",
        default=[],
        metavar="CHANNEL",
        help="get a table: of these channels, or fields of channels such as "
        "joint_states/position",
    )
    parser.add_argument(
        "--joints", nargs="+", default=[], metavar="JOINT", help="and of these joints"
    )
    parser.add_argument(
        "--rate",
        type=float,
        metavar="HZ",
        help="and with so many rows per second; default every cycle",
    )


def add_foxglove_option(run: "Parser") -> None:
    """Add `--foxglove` to the verb `run`."""
    run.add_argument(
        "--foxglove",
        nargs="?",
        type=int,
        const=8765,
        metavar="PORT",
        help="serve the channels of a recording live to Foxglove, at the loopback "
        "address unless the configuration says another; default port 8765",
    )
