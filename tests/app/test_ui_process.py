"""The dashboard's process starts, is watched, and goes away."""

import os
import signal
import socket
import sys
import time

import pytest

from station.app.ui_process import PortTakenError, UiOptions, UiProcess, free_port

OPTIONS = UiOptions("http://127.0.0.1:8000", "secret", "127.0.0.1", 8080)
STUCK = (
    "import signal, sys, time\n"
    "signal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
    "print('up', flush=True)\n"
    "time.sleep(600)\n"
)


def process(program: str, options: UiOptions = OPTIONS) -> UiProcess:
    return UiProcess(options, [sys.executable, "-c", program])


def wait_until(condition, timeout=20.0) -> None:
    deadline = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


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
    wait_until(lambda: "up" in capfd.readouterr().out)

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
        wait_until(ui.answers)
    finally:
        ui.kill()
        ui.finish(20.0)

    assert not ui.answers()
