"""A plug-in of pytest: options and fixtures of the checks, and a matrix of results."""

import json
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from inspect import getdoc, signature
from itertools import groupby
from pathlib import Path
from typing import Any

import pytest

from station.core.errors import StationError
from station.core.franka.franka_robot_state import RobotMode
from station.core.scheduling import realtime_interpreter, request_realtime_priority
from station.hw.franka.fci.wire.robot_protocol import PANDA, PROTOCOLS
from station.testing.fci_conformance.dialog import (
    Dialog,
    Endpoint,
    FciSilenceError,
    find_protocol,
)
from station.testing.fci_conformance.trajectories import State

_AREAS = ("reading", "motions", "errors")
_TRIES = 3
"""Most attempts at a check in which this client was late."""


@dataclass(slots=True)
class Row:
    """One check and its result.

    Attributes:
        check: The check, in words.
        area: The group of checks that it belongs to.
        result: `passed`, `failed`, `not in this version`, or why it was skipped.
        expected: The behaviour that the protocol or libfranka's documents require; by
            default the docstring of the check.
        seen: The behaviour of the endpoint.
    """

    check: str
    area: str
    result: str = ""
    expected: str = ""
    seen: str = ""

    def see_more(self, seen: str) -> None:
        """Add to the behaviour."""
        self.seen = f"{self.seen}; {seen}" if self.seen else seen


def needs(is_there: bool) -> None:  # noqa: FBT001 - a condition
    """Skip the check if the spoken version of the protocol lacks the feature."""
    if not is_there:
        pytest.skip("not in this version")


_endpoint_key = pytest.StashKey[Endpoint]()
_row_key = pytest.StashKey[Row]()
_rows_key = pytest.StashKey[list[Row]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the options."""
    group = parser.getgroup("fci", "checks of the Franka Control Interface")
    group.addoption("--fci", metavar="ADDRESS", help="name or address of the robot")
    group.addoption("--fci-port", type=int, default=PANDA.port, metavar="PORT")
    group.addoption(
        "--fci-version",
        type=int,
        choices=sorted(PROTOCOLS),
        help="the client's version; by default the newest that the robot has",
    )
    group.addoption(
        "--fci-move", action="store_true", help="move the arm, provoke errors, recover"
    )
    group.addoption("--fci-report", type=Path, metavar="FILE", help="write JSON")


def pytest_configure(config: pytest.Config) -> None:
    """Find the endpoint's version, if an endpoint is named.

    Raises:
        UsageError: The endpoint does not answer, or speaks no version that this project
            has a table for.
    """
    config.addinivalue_line("markers", "moves: a check that moves the arm")
    config.stash[_rows_key] = []
    host = config.getoption("--fci")
    if host is None:
        return
    port, version = config.getoption("--fci-port"), config.getoption("--fci-version")
    try:
        protocol = find_protocol(host, port, version)
    except (OSError, StationError, FciSilenceError) as error:
        raise pytest.UsageError(
            f"{host}:{port} does not answer as a robot: {error}"
        ) from error
    config.stash[_endpoint_key] = Endpoint(
        host, port, protocol, config.getoption("--fci-move")
    )


def pytest_itemcollected(item: pytest.Item) -> None:
    """Make the row of a check."""
    # Only the package's own checks get a row: a run may collect other tests, too.
    if not item.module.__name__.startswith(__package__ or ""):  # type: ignore[attr-defined]
        return
    words = item.name.removeprefix("test_").replace("_", " ")
    check = words.replace("[", ": ", 1).removesuffix("]")
    area = item.module.__name__.rpartition(".test_")[2]  # type: ignore[attr-defined]
    expected = (getdoc(item.function) or "").removesuffix(".")  # type: ignore[attr-defined]
    item.stash[_row_key] = Row(check, area, expected=expected)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort the checks: reading checks first, checks that provoke errors last."""

    def place(item: pytest.Item) -> int:
        row = item.stash.get(_row_key, None)
        return -1 if row is None else _AREAS.index(row.area)

    items.sort(key=place)


@pytest.hookimpl(wrapper=True)
def pytest_runtestloop(session: pytest.Session) -> Generator[None, object, object]:
    """Keep this client on time, so that its delays do not count as the endpoint's."""
    if _endpoint_key not in session.config.stash:
        return (yield)
    # A full collection of pytest's garbage takes 40 ms; 20 lost commands are an error.
    with realtime_interpreter():
        request_realtime_priority()
        return (yield)


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Make a check, and note its verdict.

    A check that fails while this client was late is repeated, because it proves
    nothing.

    Raises:
        AssertionError: The check does not hold.
        FciSilenceError: The endpoint has not sent a message that the client waits for.
    """
    row = pyfuncitem.stash.get(_row_key, None)
    if row is None:
        return None
    dialog: Any = pyfuncitem.funcargs.get("dialog")
    names = signature(pyfuncitem.obj).parameters
    arguments = {name: pyfuncitem.funcargs[name] for name in names}
    for tries_left in reversed(range(_TRIES)):
        row.seen = ""
        try:
            if dialog is not None:
                dialog.late = 0
                if pyfuncitem.get_closest_marker("moves"):
                    dialog.go_to()
            holds, seen = pyfuncitem.obj(**arguments)
            row.seen = str(seen)
            if not holds:
                raise AssertionError(row.seen)
        except (AssertionError, FciSilenceError):
            if dialog is None or not dialog.late:
                raise
            row.see_more(f"this side was late in {dialog.late} cycles")
            if not tries_left:
                raise
        else:
            break
    return True


@pytest.fixture
def endpoint(request: pytest.FixtureRequest) -> Endpoint:
    """Return the endpoint."""
    found = request.config.stash.get(_endpoint_key, None)
    if found is None:
        pytest.skip("no endpoint: give its address with --fci")
    if request.node.get_closest_marker("moves") and not found.may_move:
        pytest.skip("skipped: it moves the arm")
    return found


@pytest.fixture
def row(request: pytest.FixtureRequest) -> Row:
    """Return the row of the check that runs."""
    row: Row = request.node.stash[_row_key]
    return row


@pytest.fixture
def dialog(endpoint: Endpoint) -> Iterator[Dialog]:
    """Connect a client for one check."""
    opened = endpoint.open()
    yield opened
    if endpoint.may_move and opened.state["robot_mode"] == RobotMode.REFLEX.value:
        with suppress(OSError, FciSilenceError):  # the check has reported it already
            opened.recover()
    opened.close()


@pytest.fixture
def state(dialog: Dialog) -> State:
    """Return the newest state."""
    return dialog.settle()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Note the result of a check in its row."""
    report = yield
    row = item.stash.get(_row_key, None)
    if row is None or (report.when != "call" and report.passed):
        return report
    if not row.result:
        item.config.stash[_rows_key].append(row)
    error = call.excinfo.value if call.excinfo is not None else None
    row.result = str(error) if report.skipped else report.outcome
    if report.failed and not (isinstance(error, AssertionError) and row.seen):
        row.see_more(f"{type(error).__name__}: {error}")
    return report


def pytest_terminal_summary(
    terminalreporter: "pytest.TerminalReporter", config: pytest.Config
) -> None:
    """Print the matrix, and write the report."""
    endpoint = config.stash.get(_endpoint_key, None)
    if endpoint is None:
        return
    rows, write = config.stash[_rows_key], terminalreporter.write_line
    address, version = f"{endpoint.host}:{endpoint.port}", endpoint.protocol.version
    write(f"\nFranka Control Interface {version} at {address}")
    width = max((len(row.check) for row in rows), default=0)
    for area, in_area in groupby(rows, key=lambda row: row.area):
        write(f"\n{area}")
        for row in in_area:
            write(f"  {row.check:{width}}  {row.result}")
            if row.result == "failed":
                write(f"  {'':{width}}    expected: {row.expected or 'no error'}")
                write(f"  {'':{width}}    seen:     {row.seen}")
    results = Counter(row.result for row in rows)
    write("\n" + ", ".join(f"{count} {result}" for result, count in results.items()))
    if (file := config.getoption("--fci-report")) is not None:
        report = {
            "address": address,
            "version": version,
            "moved": endpoint.may_move,
            "checks": [asdict(row) for row in rows],
        }
        file.write_text(json.dumps(report, indent=2) + "\n", encoding="utf-8")
