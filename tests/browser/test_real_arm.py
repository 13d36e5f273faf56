"""The docks that the workspace shows for a robot that is not simulated."""

import subprocess
import sys

import pytest

from station.client import StationClient
from tests.browser.conftest import run_station
from tests.browser.workspace_page import WorkspacePage, without_scene

pytestmark = pytest.mark.long

ARM_HOST = "127.0.0.5"
REAL_ARM = f"""
robot:
  type: franka_hw/FrankaHW
  arm_id: panda
  robot_description: example-robot-data:panda
  robot_ip: {ARM_HOST}
  realtime_config: ignore
start: [joint_state_controller]
"""


def test_the_dock_of_the_simulation_is_not_there_for_a_real_robot(
    browser, tmp_path, monkeypatch
):
    for key in ("XDG_RUNTIME_DIR", "XDG_DATA_HOME", "XDG_STATE_HOME"):
        monkeypatch.setenv(key, str(tmp_path / "arm"))
    (tmp_path / "arm").mkdir(mode=0o700)
    config = tmp_path / "real.yaml"
    config.write_text(REAL_ARM)
    command = [sys.executable, "-m", "station", "fci", "--host", ARM_HOST]
    with subprocess.Popen(
        [*command, "--patience", "5"], stdout=subprocess.PIPE, text=True
    ) as arm:
        try:
            assert ARM_HOST in arm.stdout.readline()
            with run_station(tmp_path, str(config), rate=1000) as running:
                _expect_no_simulation(browser, running)
        finally:
            arm.terminate()


def _expect_no_simulation(browser, running):
    with StationClient(running.api, running.token) as client:
        assert client.status().simulation is None
        label = client.status().robot_label
        client.waypoint_paths.capture("poses", "here")
    assert label == running.robot == f"REAL ARM {ARM_HOST}"
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    without_scene(context)
    page = context.new_page()
    page.goto(f"{running.ui}/login?token={running.token}")
    assert WorkspacePage(page).dock("timeline").is_visible()
    page.locator("#robot").get_by_text(label, exact=True).wait_for()
    page.locator('.dock[data-dock="simulation"]').wait_for(state="hidden")
    # A model of the arm finds ways, and rehearses them.
    joints = WorkspacePage(page).dock("joints")
    for trial in ("Rehearse", "Go around"):
        joints.get_by_role("button", name=trial, disabled=False).wait_for()
    page.set_viewport_size({"width": 390, "height": 844})
    page.locator('#docks-nav [data-dock="timeline"]').wait_for()
    assert page.locator("#robot").is_visible()
    assert page.locator('#docks-nav [data-dock="simulation"]').is_hidden()
    context.close()
