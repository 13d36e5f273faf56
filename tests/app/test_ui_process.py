"""The dashboard's process starts, is watched, and goes away."""

import os
import signal
import socket
import subprocess
import sys
from dataclasses import replace

import pytest

from station.app.orphaned_dashboard import read_dashboard
from station.app.ui_process import (
    UNKNOWN_CODE,
    PortTakenError,
    UiOptions,
    UiProcess,
    find_orphan,
    free_port,
)
from tests.waiting import PATIENCE, wait_until

OPTIONS = UiOptions("http://127.0.0.1:8000", "secret", "127.0.0.1", 8080)
STUCK = (
    "import signal, sys, time\n"
    "signal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
    "print('up', flush=True)\n"
    "time.sleep(600)\n"
)


def process(program: str, options: UiOptions = OPTIONS) -> UiProcess:
    return UiProcess(options, [sys.executable, "-c", program])


def test_free_port_is_the_one_asked_for_or_any():
    port = free_port("127.0.0.1", 0)

    assert port > 0
    assert free_port("127.0.0.1", port) == port


def test_taken_port_is_refused_with_a_way_out():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(PortTakenError, match=f"127.0.0.1:{port}") as caught:
            free_port("127.0.0.1", port)

    assert f"--ui-port {port + 1}" in caught.value.remedy


def test_command_line_does_not_show_the_token():
    command = OPTIONS.command()

    assert "secret" not in " ".join(command)
    assert command[command.index("--connect") + 1] == "http://127.0.0.1:8000"
    assert command[command.index("--parent-pid") + 1] == str(os.getpid())


def test_token_goes_by_the_environment():
    ui = process("import os, sys; sys.exit(os.environ['STATION_TOKEN'] != 'secret')")

    ui.start()
    ui.finish(20.0)

    assert ui.exit_code() == 0


def test_terminate_ends_it():
    ui = process("import time; time.sleep(600)")
    ui.start()

    ui.terminate()
    ui.finish(20.0)

    assert ui.exit_code() == -signal.SIGTERM


def test_stuck_process_is_killed(capfd):
    ui = process(STUCK)
    ui.start()
    assert wait_until(lambda: "up" in capfd.readouterr().out)

    ui.terminate()
    ui.finish(0.05)

    assert ui.exit_code() == -signal.SIGKILL


def test_ending_what_never_started_does_nothing():
    ui = process("")

    ui.terminate()
    ui.kill()
    ui.finish(0.0)

    assert ui.exit_code() is None


def test_it_answers_when_its_page_does():
    port = free_port("127.0.0.1", 0)
    options = UiOptions("http://127.0.0.1:1", "secret", "127.0.0.1", port)
    serve = [sys.executable, "-m", "http.server", str(port), "--bind", "127.0.0.1"]
    ui = UiProcess(options, serve)
    assert not ui.answers()

    ui.start()
    try:
        assert wait_until(ui.answers)
    finally:
        ui.kill()
        ui.finish(20.0)

    assert not ui.answers()


SLEEP = [sys.executable, "-c", "import time; time.sleep(600)"]
IGNORE = [sys.executable, "-c", STUCK]


@pytest.fixture
def leave(tmp_path, monkeypatch):
    """Return a function that starts a dashboard whose station has ended."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    left = []

    def start(options, command=SLEEP):
        child = subprocess.Popen(
            command, start_new_session=True, stdout=subprocess.PIPE
        )
        left.append(child)
        record = UiProcess(options, command)._record(child.pid)
        replace(record, station_pid=os.getppid(), station_started="1").write()
        return child

    yield start
    for child in left:
        child.kill()
        child.wait()
        child.stdout.close()


def test_an_orphan_that_shows_the_same_is_adopted(leave):
    child = leave(OPTIONS)

    orphan = find_orphan("127.0.0.1", 0, OPTIONS.shown())
    ui = UiProcess(replace(OPTIONS, api_url="http://new"), adopted=orphan)
    ui.start()

    assert (orphan.pid, orphan.port) == (child.pid, 8080)
    assert read_dashboard(child.pid).api_url == "http://new"
    assert ui.exit_code() is None
    ui.terminate()
    ui.finish(20.0)
    assert ui.exit_code() == UNKNOWN_CODE
    assert child.wait() == -signal.SIGTERM
    assert read_dashboard(child.pid) is None


@pytest.mark.parametrize(
    ("command", "code"), [(SLEEP, -signal.SIGTERM), (IGNORE, -signal.SIGKILL)]
)
def test_an_orphan_that_shows_something_else_is_ended(
    leave, monkeypatch, command, code
):
    monkeypatch.setattr("station.app.ui_process.ORPHAN_TIME", 0.2)
    child = leave(replace(OPTIONS, arm_id="left"), command)
    if command is IGNORE:
        assert child.stdout.readline() == b"up\n"

    assert find_orphan("127.0.0.1", 8080, OPTIONS.shown()) is None
    assert child.wait(PATIENCE) == code


def test_an_adopted_dashboard_that_does_not_end_is_killed(leave):
    child = leave(OPTIONS, IGNORE)
    assert child.stdout.readline() == b"up\n"
    ui = UiProcess(OPTIONS, adopted=find_orphan("127.0.0.1", 0, OPTIONS.shown()))

    ui.terminate()
    ui.finish(0.05)

    assert child.wait(PATIENCE) == -signal.SIGKILL


@pytest.mark.usefixtures("leave")
def test_without_an_orphan_there_is_nothing_to_adopt():
    assert find_orphan("127.0.0.1", 0, OPTIONS.shown()) is None
