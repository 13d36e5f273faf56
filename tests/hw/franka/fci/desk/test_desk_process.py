"""`station fci --desk` and panda-python: what Desk says, libfranka hears.

The client is a process of its own, as in `test_panda_python`.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.hw.franka.fci.desk.desk_bench import client_of, take
from tests.waiting import PATIENCE

pytest.importorskip("panda_py")
pytestmark = [pytest.mark.slow, pytest.mark.alone]

CLIENT = Path(__file__).with_name("locked_client.py")
HOST = f"127.15.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"


@pytest.fixture
def url(tmp_path):
    """The address of Desk beside a server of libfranka's programs."""
    command = [sys.executable, "-m", "station", "fci", "--host", HOST, "--desk", "0"]
    server = subprocess.Popen(
        [*command, "--patience", "10"],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "XDG_DATA_HOME": str(tmp_path)},
    )
    line = server.stdout.readline()
    assert "Franka Control Interface" in server.stdout.readline()
    yield re.search(r"https://[0-9.:]+", line)[0]
    server.terminate()
    server.communicate(timeout=PATIENCE)
    assert server.returncode == 0


def run_program():
    """Return what a program of panda-python was told."""
    found = subprocess.run(
        [sys.executable, str(CLIENT), HOST],
        capture_output=True,
        text=True,
        timeout=60.0,
        check=True,
    )
    return json.loads(found.stdout)


def test_program_hears_of_brakes_and_fci_as_from_a_robot(url):
    told = run_program()
    assert "Connection to FCI refused" in told["error"]
    assert "enable FCI mode in Desk" in told["error"]
    with client_of(url) as desk:
        control = take(desk)
        desk.post("/api/fci:activate", headers=control)
        told = run_program()
        assert told["mode"] == "RobotMode.kOther"
        assert 'not possible in the current mode ("Other")' in told["error"]
        assert "Did you open the brakes?" in told["error"]
        desk.post("/api/arm/joints:unlock", headers=control)
        assert run_program() == {"mode": "RobotMode.kIdle", "arrived": True}
        desk.post("/api/fci:deactivate", headers=control)
    assert "Connection to FCI refused" in run_program()["error"]
