"""The watchdog's process: what it imports, and how it ends."""

import json
import os
import socket
import subprocess
import sys

import pytest

from station.core.loop.heartbeat import PAGE_BYTES
from tests.app.watchdog.bench import OPERATOR, VIEWER
from tests.waiting import PATIENCE

HEAVY = {"numpy", "fastapi", "pydantic", "mujoco", "uvicorn", "asyncio", "inspect"}
LIST = "import sys, station.app.watchdog.__main__; print('\\n'.join(sys.modules))"


def test_it_imports_the_standard_library_and_the_heartbeat_alone():
    command = [sys.executable, "-c", LIST]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    modules = set(found.stdout.split())

    ours = {m for m in modules if m.startswith("station.") and m.count(".") > 1}
    assert not HEAVY & modules
    assert ours - {"station.core.loop", "station.core.loop.heartbeat"} <= {
        m for m in ours if m.startswith("station.app.watchdog")
    }


@pytest.fixture
def watchdog():
    """Return a watchdog's process whose station is this one."""
    page, stacks = os.memfd_create("page"), os.memfd_create("stacks")
    os.ftruncate(page, PAGE_BYTES)
    with socket.create_server(("127.0.0.1", 0)) as listener:
        inherited = (page, listener.fileno(), stacks)
        with subprocess.Popen(
            [sys.executable, "-m", "station.app.watchdog", *map(str, inherited)],
            stdin=subprocess.PIPE,
            pass_fds=inherited,
        ) as process:
            yield process
            process.kill()
    for descriptor in (page, stacks):
        os.close(descriptor)


def settings(folder):
    """Return the first line for a watchdog."""
    values = {
        "pid": os.getpid(),
        "operator_token": OPERATOR,
        "viewer_token": VIEWER,
        "incident_directory": str(folder),
        "hold_commands": [["true"]],
    }
    return json.dumps({"settings": values}).encode() + b"\n"


def test_it_ends_with_its_input(watchdog, tmp_path):
    watchdog.stdin.write(settings(tmp_path) + b'{"status": {"step": "x"}}\n')
    watchdog.stdin.close()

    assert watchdog.wait(PATIENCE) == 0


def test_it_ends_when_the_station_ends_before_it_sent_anything(watchdog):
    watchdog.stdin.close()

    assert watchdog.wait(PATIENCE) == 0
