"""What becomes of a motion and of a login when a session, dashboard or station ends."""

import json
import math
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from station.client import StationClient
from tests.browser.conftest import RATE, free_ports
from tests.browser.workspace_page import (
    CONTROLLER,
    OTHER,
    WorkspacePage,
    allow_motion,
    position,
    run_alone,
    wait_until,
    without_scene,
)
from tests.stopwatch import Stopwatch

pytestmark = [pytest.mark.long, pytest.mark.alone]

_LIVE = '#bar[data-link="live"]'
_NOT_LIVE = '#bar:not([data-link="live"])'


class _Place:
    """A station whose ports and runtime directory stay when it is started anew."""

    def __init__(self, home, ports):
        self.station = None
        self.home = home
        # The watchdog would end a station that a busy machine lets hang for 10 s.
        config = home / "station.yaml"
        config.write_text("watchdog: {end_after: 600}\n")
        ports = ["--port", str(ports[0]), "--ui-port", str(ports[1])]
        self.arguments = [str(config), "--rate", str(RATE), *ports]
        self.processes = []

    def run(self, *command):
        self.processes.append(
            subprocess.Popen(
                [sys.executable, "-m", "station", *command, "--json"],
                stdout=subprocess.PIPE,
                text=True,
                env={**os.environ, "XDG_RUNTIME_DIR": str(self.home)},
            )
        )
        return self.processes[-1]

    def start(self):
        """Start the station; wait until station and dashboard answer."""
        self.station = self.run("run", *self.arguments)
        told = json.loads(self.station.stdout.readline())
        while "ui_ready" not in told:
            told |= json.loads(self.station.stdout.readline())
        known = json.loads(Path(told["runtime_file"]).read_text())
        self.api, self.ui, self.token = told["api_url"], told["ui_url"], known["token"]

    def restore(self):
        """Let the station be as one that has just started, started anew if it ended."""
        if self.station is None or self.station.poll() is not None:
            self.start()
        with self.client() as client:
            run_alone(client)
            allow_motion(client)
            client.simulation.reset()

    def client(self):
        return StationClient(self.api, self.token)

    def dashboards(self):
        """Return the processes that say they are a dashboard."""
        return {int(p.stem) for p in (self.home / "station").glob("*.dashboard")}

    def dashboard_pid(self):
        (pid,) = self.dashboards()
        return pid

    def end(self):
        for process in self.processes:
            if process.poll() is None:
                process.terminate()
                process.wait(10)
            process.stdout.close()


@pytest.fixture(scope="module")
def only_place(tmp_path_factory):
    place = _Place(tmp_path_factory.mktemp("station"), free_ports())
    yield place
    place.end()


@pytest.fixture
def place(only_place):
    """The station of all these tests, idle and with the arm in its first pose."""
    only_place.restore()
    return only_place


@pytest.fixture
def log_in(browser, place):
    """Open the workspace in a browser of its own."""
    contexts = []

    def open_page(token=None):
        context = browser.new_context(viewport={"width": 1280, "height": 800})
        contexts.append(context)
        without_scene(context)
        page = context.new_page()
        page.goto(f"{place.ui}/login?token={token or place.token}")
        return WorkspacePage(page)

    yield open_page
    for context in contexts:
        context.close()


def _hold_joint7(workspace, client):
    """Press the button that moves joint 7 up; return once the joint moves."""
    client.switch_controllers(start=[CONTROLLER])
    workspace.page.wait_for_function(
        "() => !document.querySelector('.joints input').disabled"
    )
    workspace.button("joints", "Move joint7 up while held").hover()
    workspace.page.mouse.down()
    before = position(client, "panda_joint7")
    assert wait_until(lambda: position(client, "panda_joint7") > before + 0.05)


def _stands_still(client):
    """Say whether joint 7 rests within half a second, far from its limit."""
    time.sleep(0.5)
    before = position(client, "panda_joint7")
    time.sleep(0.5)
    return abs(position(client, "panda_joint7") - before) < 2e-3 and before < 2.5


def _wait_for_login(page):
    """Wait for the login page; two causes may lead there, one ends the other's load."""
    page.wait_for_function("() => location.pathname.startsWith('/login')")


def test_a_session_that_ends_in_mid_jog_stops_the_jog(place, log_in):
    with place.client() as client:
        made = client.tokens.create("jogger", "operator")
        workspace = log_in(made.token)
        _hold_joint7(workspace, client)
        client.tokens.revoke("jogger")
        assert wait_until(lambda: _stands_still(client))
        _wait_for_login(workspace.page)


def test_logging_out_in_one_tab_stops_the_jog_of_another(place, log_in):
    with place.client() as client:
        workspace = log_in()
        _hold_joint7(workspace, client)
        other = workspace.page.context.new_page()
        other.goto(place.ui)
        other.locator("#logout").click()
        _wait_for_login(other)
        assert wait_until(lambda: _stands_still(client))
        _wait_for_login(workspace.page)


_STORE = "(await import('/static/lib/store.js')).store"


def test_a_page_comes_back_by_itself_when_its_station_does(place, log_in):
    workspace = log_in()
    page, dock = workspace.page, workspace.dock("tuning")
    with place.client() as client:
        before = client.gains(CONTROLLER).values["panda_joint1/p"]
        client.set_gains(CONTROLLER, {"panda_joint1/p": before + 1})
        client.switch_controllers(start=[CONTROLLER])
    gain = dock.get_by_label("p of panda_joint1")
    assert wait_until(lambda: gain.input_value() == f"{before + 1:g}")
    page.wait_for_function(f"async () => {_STORE}.markers.length > 0")
    place.station.kill()
    place.station.wait(10)
    page.wait_for_selector(_NOT_LIVE)
    place.start()
    # With the newest joints in its table, too: no part of the page is stale.
    with Stopwatch(os.getpid(), place.dashboard_pid()) as watch:
        page.wait_for_selector(f"body:not(.stale) {_LIVE}", timeout=60_000)
    assert watch.seconds < 3.0  # as promised
    # Station time begins anew: old marks would be shown at wrong times.
    page.wait_for_function(f"async () => {_STORE}.markers.length === 0")
    assert wait_until(lambda: gain.input_value() == f"{before:g}")
    with place.client() as client:
        client.switch_controllers(start=[CONTROLLER])
        page.wait_for_function(
            "() => !document.querySelector('.joints input').disabled"
        )
        here = position(client, "panda_joint1")
        # Fields follow the robot first: nothing is commanded by the return itself.
        time.sleep(0.5)
        assert position(client, "panda_joint1") == pytest.approx(here, abs=2e-3)


def test_a_login_survives_an_orderly_restart_of_everything(place, log_in):
    page = log_in().page
    place.station.terminate()
    place.station.wait(10)
    page.wait_for_selector(_NOT_LIVE)
    place.start()
    page.wait_for_selector(_LIVE, timeout=10_000)
    assert page.url == f"{place.ui}/"


def test_stop_is_answered_while_the_station_hangs_and_every_dock_looks_at_it(
    place, log_in
):
    with place.client() as client:
        workspace = log_in()
        page = workspace.page
        for dock in ("move", "tuning", "gripper", "timeline", "simulation"):
            workspace.dock(dock)
        page.wait_for_selector(_LIVE)
        os.kill(place.station.pid, signal.SIGSTOP)
        try:
            page.wait_for_selector(_NOT_LIVE)
            with page.expect_response("**/stop", timeout=4000) as answer:
                page.locator("#stop").click()
            assert answer.value.ok
            page.locator("#motion").get_by_text("STOPPED").wait_for()
        finally:
            os.kill(place.station.pid, signal.SIGCONT)
        page.wait_for_selector(_LIVE, timeout=40_000)
        assert wait_until(lambda: client.status().stop_state == "stopped")
        assert page.locator("#motion").inner_text() == "STOPPED"


def test_what_is_clicked_while_the_station_hangs_is_not_done_later(place, log_in):
    with place.client() as client:
        workspace = log_in()
        page = workspace.page
        other = workspace.button("controllers", f"Start {OTHER}")
        page.locator("#enable").wait_for()
        os.kill(place.station.pid, signal.SIGSTOP)
        try:
            page.locator("#enable").click()  # It is sent, and read when time is over.
            page.wait_for_selector('#bar[data-link="lost"]')
            other.click()
            line = page.locator("#refusal-line")
            line.get_by_text("The link to the station is lost.").wait_for()
            page.wait_for_function(
                "() => Number(document.querySelector('#link').textContent"
                ".match(/data ([0-9.]+) s/)[1]) > 4"
            )
        finally:
            os.kill(place.station.pid, signal.SIGCONT)
        page.wait_for_selector(_LIVE, timeout=40_000)
        page.locator("#log-button").click()
        # Or its connection, on which nothing was heard for long, is closed unread.
        refused = re.compile("too late to be begun|It is not known whether it was done")
        page.locator("#log").get_by_text(refused).wait_for()
        running = {c.name for c in client.controllers() if c.state == "running"}
        assert not running & {CONTROLLER, OTHER}


def test_a_motion_that_a_hanging_dashboard_ends_is_told_of(place, log_in):
    with place.client() as client:
        workspace = log_in()
        client.switch_controllers(start=[CONTROLLER])
        workspace.page.wait_for_function(
            "() => !document.querySelector('.joints input').disabled"
        )
        line = workspace.page.locator("#refusal-line")
        is_told = line.get_by_text("the motion has ended").is_visible

        def is_near(degrees):
            away = position(client, "panda_joint7") - math.radians(degrees)
            return abs(away) < math.radians(2)

        # What the dashboard reads first after a pause may be the newest of the station,
        # and the motion then goes on.
        for start, goal in ((45, 90), (90, 45)) * 4:
            workspace.type_into("joints", "Command of joint7", str(goal))
            assert wait_until(lambda here=start: not is_near(here))
            os.kill(place.dashboard_pid(), signal.SIGSTOP)
            time.sleep(1.0)
            os.kill(place.dashboard_pid(), signal.SIGCONT)
            assert wait_until(lambda there=goal: is_told() or is_near(there), 60)
            if is_told():
                break
        assert is_told()


def test_two_people_type_into_forms_of_their_own(log_in):
    ada, grace = log_in(), log_in()
    for workspace, text in ((ada, "from ada"), (grace, "from grace")):
        workspace.button("controllers", "Load …").click()
        workspace.dock("controllers").get_by_label("Search controller types").fill(text)
    for workspace, text in ((ada, "from ada"), (grace, "from grace")):
        field = workspace.dock("controllers").get_by_label("Search controller types")
        assert field.input_value() == text


def test_a_killed_dashboard_ends_the_jog_and_comes_back_with_its_session(place, log_in):
    with place.client() as client:
        workspace = log_in()
        page = workspace.page
        _hold_joint7(workspace, client)
        killed = place.dashboard_pid()
        os.kill(killed, signal.SIGKILL)
        assert wait_until(lambda: _stands_still(client))
        # Its station starts it again, at the same address.
        assert wait_until(lambda: place.dashboards() - {killed}, seconds=60.0)
        page.wait_for_selector(_LIVE, timeout=60_000)
        assert page.url == f"{place.ui}/"
        # What was held before is not held any more.
        assert wait_until(lambda: _stands_still(client))
