"""The dashboard as a process."""

import asyncio
import signal
import subprocess
import sys

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.client import StationUnreachableError
from station.ui.main import ask_role, dashboard_url
from station.ui.sessions.sessions import Role
from tests.api.spring import make_station
from tests.certificates import make_certificate
from tests.stopwatch import Stopwatch
from tests.ui.fake_station import OPERATOR, VIEWER
from tests.waiting import PATIENCE

PROGRAM = """
import sys
from station.ui.main import DashboardConfig, run_dashboard
config = DashboardConfig(sys.argv[1], "operator-token", port=0, robot_description="")
sys.exit(run_dashboard(config, lambda url: print(url, flush=True)))
"""


@pytest.mark.parametrize(
    ("token", "role"),
    [(OPERATOR, Role.OPERATOR), (VIEWER, Role.VIEWER), ("x", None), ("ü\n", None)],
)
def test_the_station_decides_the_role(fake_station, token, role):
    assert asyncio.run(ask_role(fake_station.url, token)) is role


def test_an_absent_station_is_no_wrong_token():
    with pytest.raises(StationUnreachableError):
        asyncio.run(ask_role("http://127.0.0.1:9", OPERATOR))


def test_the_role_is_asked_over_tls(tmp_path):
    tls = make_certificate(tmp_path)
    app = create_app(make_station(), Authenticator(OPERATOR, VIEWER))
    with ApiServer(app, port=0, tls=tls) as server:
        role = asyncio.run(ask_role(server.url, VIEWER, str(tls.certificate)))

    assert role is Role.VIEWER


@pytest.mark.parametrize(
    ("host", "url"),
    [
        ("127.0.0.1", "http://127.0.0.1:8080"),
        ("0.0.0.0", "http://127.0.0.1:8080"),
        ("::1", "http://[::1]:8080"),
        ("::", "http://[::1]:8080"),
    ],
)
def test_the_address_can_be_opened(host, url):
    assert dashboard_url(host, 8080) == url


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "robot", "told"),
    [
        (signal.SIGINT, "", ""),
        # The panels are there, although the robot cannot be drawn.
        (signal.SIGTERM, "gone.urdf", "gone.urdf"),
    ],
)
def test_a_signal_ends_it_at_once_and_cleanly(fake_station, number, robot, told):
    program = PROGRAM.replace('robot_description=""', f"robot_description={robot!r}")
    with subprocess.Popen(
        [sys.executable, "-W", "error", "-c", program, fake_station.url],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout.readline().startswith("http://127.0.0.1:")
        with Stopwatch(process.pid) as watch:
            process.send_signal(number)
            _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    assert told in errors
    assert "Traceback" not in errors
    assert watch.seconds < 1.0  # as promised
