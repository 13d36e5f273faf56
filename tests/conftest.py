"""What every test runs under."""

import asyncio
import gc
import logging
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import hypothesis
import pytest
import uvicorn.server
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

from station.compiled import status
from station.core.scheduling import GC_THRESHOLDS
from tests.compiled_reach import reaches_compiled
from tests.thread_guard import leaked_threads

TESTS = Path(__file__).parent
ONE_STATION = "tests/browser/workspace/"
"""The folder whose files share a station."""
MARKS_OF_FOLDERS = {
    "browser": ("browser", "slow", "alone"),
    "system": ("slow", "alone"),
    "ui": ("alone",),
}
"""The marks of all tests of a folder: a browser and whole processes are never quick."""

# Looking for garbage in what the tests have imported takes a tenth of their time.
gc.set_threshold(*GC_THRESHOLDS)

# Reproducible examples, and no time limit for one on a busy machine.
hypothesis.settings.register_profile("station", deadline=None, derandomize=True)
hypothesis.settings.load_profile("station")


def pytest_report_header() -> str:
    """Say whether the tests run compiled."""
    return f"control cycle: {status().text()}"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options for runs of a part of the tests."""
    parser.addoption(
        "--marked",
        metavar="MARK",
        help="read only files with a test that has this mark",
    )
    parser.addoption(
        "--reaching-compiled",
        action="store_true",
        help="run only tests that reach compiled modules",
    )


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish() -> None:
    """Collect the garbage of all tests, once: pytest would do so five times."""
    gc.collect()
    gc.freeze()


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave out files without a test that has the mark of `--marked`.

    To read all tests takes every worker ten seconds, for a mark that few have.
    """
    mark = config.getoption("--marked")
    if mark is None or not collection_path.name.startswith("test_"):
        return None
    if mark in MARKS_OF_FOLDERS.get(_folder(collection_path), ()):
        return None
    return f"mark.{mark}" not in collection_path.read_text() or None


def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> None:
    """Mark tests by their folder, and bring them into their order."""
    if config.getoption("--reaching-compiled"):
        others = [item for item in items if not _reaches_compiled(item)]
        items[:] = [item for item in items if _reaches_compiled(item)]
        config.hook.pytest_deselected(items=others)
    for item in items:
        for mark in MARKS_OF_FOLDERS.get(_folder(item.path), ()):
            item.add_marker(mark)
    items.sort(key=_turn)


def pytest_collection_finish() -> None:
    """Keep what is imported, and the tests, out of sight of the garbage collector."""
    gc.collect()
    gc.freeze()


def _folder(path: Path) -> str:
    """Return which folder of the tests has a file; empty if it is elsewhere."""
    return path.relative_to(TESTS).parts[0] if path.is_relative_to(TESTS) else ""


def _turn(item: pytest.Item) -> int:
    """Return when an item is run: long parts first, and small ones last.

    While one worker has the browser of the shared station, the other one has whole
    processes, which wait most of the time.
    """
    parts = (ONE_STATION, "tests/system/", "tests/browser/")
    found = (n for n, part in enumerate(parts) if item.nodeid.startswith(part))
    return next(found, len(parts))


class _OneWorkerForOneStation(LoadFileScheduling):
    """Gives each file to one worker, and all that share a station to the same.

    A browser needs a processor of its own: two of them at the same time take longer
    than one after the other, while other tests wait most of the time.
    """

    def _split_scope(self, nodeid: str) -> str:
        return ONE_STATION if nodeid.startswith(ONE_STATION) else nodeid.split("::")[0]


@pytest.hookimpl(tryfirst=True, optionalhook=True)
def pytest_xdist_make_scheduler(
    config: pytest.Config, log: Producer
) -> LoadFileScheduling | None:
    """Keep the files together that share a station."""
    if config.getoption("dist") == "loadfile":
        return _OneWorkerForOneStation(config, log)
    return None


def _reaches_compiled(item: pytest.Item) -> bool:
    assert isinstance(item, pytest.Function)
    return reaches_compiled(item.module.__name__)


@pytest.fixture(autouse=True, scope="session")
def own_data_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep the tests away from what their user has saved (gain sets, events)."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(tmp_path_factory.mktemp("data")))
        patch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
        yield


@pytest.fixture(autouse=True, scope="session")
def prompt_servers() -> Iterator[None]:
    """Let a web server look more often whether it, or a connection, is to end."""

    def sleep(seconds: float) -> object:
        return asyncio.sleep(min(seconds, 0.005))

    hasty = SimpleNamespace(**{**vars(asyncio), "sleep": sleep})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(uvicorn.server, "asyncio", hasty)
        yield


@pytest.fixture
def log_as_before() -> Iterator[None]:
    """Take away what the test lets the process log with.

    A handler that is left writes each warning of later tests, into a closed file.
    """
    root, station = logging.getLogger(), logging.getLogger("station")
    before, level = root.handlers[:], station.level
    yield
    for handler in [each for each in root.handlers if each not in before]:
        root.removeHandler(handler)
    station.setLevel(level)


@pytest.fixture(autouse=True)
def no_leaked_threads() -> Iterator[None]:
    """Fail the test that leaves a thread behind.

    Set up before the test's own fixtures and torn down after them. Threads of module
    and session fixtures are there before, so they are nobody's leak.
    """
    before = threading.enumerate()
    yield
    leaked = leaked_threads(before)
    assert not leaked, f"the test left threads running: {leaked}"
