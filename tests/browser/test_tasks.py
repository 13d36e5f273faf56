"""Tasks that a person does from a page just opened, and how many clicks they take.

The table in docs/dashboard.md has the same numbers.
"""

import math
import re
from pathlib import Path

import pytest

from tests.browser.conftest import run_station
from tests.browser.workspace_page import (
    CONTROLLER,
    WorkspacePage,
    position,
    run_alone,
    wait_until,
)

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
CUBE_X, CUBE_Z = "0.5", "0.02"
SCENE = f"""
scene:
  objects:
    - {{name: cube, type: box, size: [0.04, 0.04, 0.04],
        position: [{CUBE_X}, 0, {CUBE_Z}], mass: 0.1}}
    - {{name: table, type: table, size: [0.3, 0.5, 0.3], position: [0, -0.6, 0.3]}}
"""


class Person:
    """Uses the page with the mouse, and counts the clicks; typing is free.

    Attributes:
        clicks: How often the mouse was pressed.
    """

    def __init__(self, page):
        self.page = page
        self.clicks = 0

    def click(self, name, role="button"):
        """Click what has this name."""
        self.clicks += 1
        self.page.get_by_role(role, name=name, exact=True).first.click()

    def fold(self, dock):
        """Open or close a dock by its title."""
        self.clicks += 1
        self.page.locator(f'.dock[data-dock="{dock}"] .fold').click()

    def field(self, label, text, end="Enter"):
        """Click a field, replace what is in it, and press a key."""
        self.clicks += 1
        field = self.page.get_by_label(label, exact=True)
        field.click()
        self.write(text, end)

    def move(self, label, text, has_arrived):
        """Type a value, and wait until its joint has arrived.

        A busy machine makes a motion slow, and may let the link be late, which ends a
        motion: the page says so, and a person then asks for it again.
        """
        self.field(label, text)
        line = self.page.locator("#refusal-line")
        told = line.get_by_text("the motion has ended")

        def look():
            if told.is_visible():
                line.get_by_role("button", name="Hide", exact=True).click()
                self.page.get_by_label(label, exact=True).click()
                self.write(text)
            return has_arrived()

        assert wait_until(look, 60)

    def write(self, text, end="Enter"):
        """Type over what is in the focused field."""
        self.page.keyboard.press("Control+a")
        self.page.keyboard.type(text)
        self.page.keyboard.press(end)
        if self.page.locator(".far").is_visible():
            self.page.keyboard.press(end)  # far: the ghost is shown first


@pytest.fixture(scope="module")
def running_station(tmp_path_factory):
    """A station with a cube before the arm, and a table at its right."""
    home = tmp_path_factory.mktemp("station")
    (home / "station.yaml").write_text(SCENE)
    with run_station(home, str(home / "station.yaml")) as running:
        yield running


@pytest.fixture
def person(workspace_tab, client):
    """Somebody in front of a page just opened; nothing but the states runs."""
    run_alone(client)
    client.simulation.reset()
    workspace_tab.evaluate(
        "() => { localStorage.clear(); localStorage['station.tour'] = '\"done\"'; }"
    )
    workspace_tab.reload()
    WorkspacePage(workspace_tab)
    return Person(workspace_tab)


def counted(task):
    """Return the clicks of a task in the table of the docs."""
    page = (ROOT / "docs/dashboard.md").read_text()
    return int(re.search(rf"^\| {re.escape(task)} \| (\d+) \|", page, re.M)[1])


def enable(person):
    """Click the button of the first minute."""
    person.click("Enable sliders")
    person.page.wait_for_function(
        "() => !document.querySelector('.joints input').disabled"
    )


def test_joint_3_is_moved_by_10_degrees(person, client):
    enable(person)
    wanted = math.radians(10)
    person.move(
        "Command of joint3",
        "10",
        lambda: abs(position(client, "panda_joint3") - wanted) < 0.01,
    )
    assert person.clicks == counted("move joint 3 by 10°") <= 3


def test_a_controller_is_loaded_with_parameters_and_started(person, client):
    person.click("Load …")
    person.page.keyboard.type("effort_controllers/JointGroupPosition")
    person.click("effort_controllers/JointGroupPositionController", "option")
    name = person.page.get_by_label("Name of the controller").input_value()
    person.field("panda_joint1 / pid / p", "555", "Tab")
    person.click("Load and start")
    assert wait_until(
        lambda: name in [c.name for c in client.controllers() if c.state == "running"]
    )
    assert client.gains(name).values["panda_joint1/p"] == 555
    client.switch_controllers(stop=[name])
    client.unload_controller(name)
    task = "load a controller with parameters and start it"
    assert person.clicks == counted(task) <= 6


def test_p_is_changed_and_two_runs_are_compared(person, client):
    enable(person)
    person.fold("tuning")
    figures = person.page.locator("st-bench .runs tbody tr")
    person.click("Run test")
    figures.first.wait_for()
    before = client.gains(CONTROLLER).values["panda_joint1/p"]
    person.field("p of panda_joint1", "400")
    assert wait_until(lambda: client.gains(CONTROLLER).values["panda_joint1/p"] == 400)
    person.click("Run test")
    figures.nth(1).wait_for()
    # The newest is the first.
    assert "p 400" in figures.first.inner_text()
    assert "p 200" in figures.nth(1).inner_text()
    client.set_gains(CONTROLLER, {"panda_joint1/p": before})
    assert person.clicks == counted("change p and compare two runs") <= 8


def test_gains_are_found_by_relay_and_applied(person, client):
    enable(person)
    person.fold("tuning")
    person.click("Find gains by relay")
    row = person.page.locator("st-bench .proposals tbody tr").filter(
        has_text="Tyreus-Luyben PID"
    )
    row.wait_for()
    before = client.gains(CONTROLLER).values
    person.click("Apply Tyreus-Luyben PID")
    run = client.bench_runs.list()[-1]
    proposals = client.bench_runs.get(run.name).proposals
    (wanted,) = [p.gains for p in proposals if p.rule == "tyreus_luyben_pid"]
    assert wanted["panda_joint1/p"] == pytest.approx(
        run.metrics["ultimate_gain"] / 2.2, rel=1e-3
    )
    assert wait_until(lambda: client.gains(CONTROLLER).values == {**before, **wanted})
    person.click("Undo")
    assert wait_until(lambda: client.gains(CONTROLLER).values == before)
    assert person.clicks - 1 == counted("find gains by relay and apply them") <= 6


def test_a_path_is_recorded_and_played(person, client):
    enable(person)
    person.fold("move")
    person.click("+ Capture")
    person.move(
        "Command of joint1", "10", lambda: position(client, "panda_joint1") > 0.15
    )
    person.click("+ Capture")
    person.page.locator("ol.waypoints li").nth(1).wait_for()
    person.click("▶ Play")
    paths = client.waypoint_paths
    assert wait_until(lambda: (p := paths.playback()) and p.state == "succeeded", 20)
    paths.delete("path-1")
    assert person.clicks == counted("record two waypoints and play them") <= 8


def test_the_cube_is_grasped_and_lifted(person, client):
    person.fold("move")
    person.clicks += 1
    person.page.get_by_text("Hand: jog and target").click()
    person.click("Start hand targets")
    person.page.wait_for_function(
        "() => !document.querySelector('[aria-label=\"Step of the hand\"]').disabled"
    )
    person.field("Hand x [m]", CUBE_X, "Tab")
    person.write("0", "Tab")
    person.write(CUBE_Z)
    hand = client.robot("panda")

    def distance():
        pose = hand.state().O_T_EE
        return math.dist(pose[12:15], (float(CUBE_X), 0.0, float(CUBE_Z)))

    assert wait_until(lambda: distance() < 0.01, 25)
    person.click("Grasp")
    assert wait_until(lambda: hand.gripper.state().is_grasped)
    gripper = person.page.locator("st-gripper")
    gripper.get_by_text(re.compile(r"holds an object with \d+ N")).wait_for()
    assert person.clicks == counted("grasp the cube") <= 6
    person.page.get_by_label("Hand z [m]").focus()
    person.write("0.2")
    assert wait_until(lambda: client.scene()[0].position[2] > 0.1, 20)


def test_the_objects_are_listed_where_they_are(person, client):
    person.fold("simulation")
    dock = person.page.locator("st-scene-objects")
    for one in client.scene():
        place = ", ".join(f"{value + 0.0:.3f}" for value in one.position)
        field = dock.get_by_label(f"Position of {one.name} [m]")
        assert wait_until(lambda f=field, p=place: f.input_value() == p)
    table = dock.get_by_role("group", name="table")
    assert table.get_by_text("fixed").count() == 1
    # The simulated world is built once.
    assert table.get_by_role("button", name="Remove table").is_disabled()


def test_hitting_the_table_is_recovered_from_and_its_alarm_acknowledged(person, client):
    enable(person)
    person.move(
        "Command of joint1", "-90", lambda: position(client, "panda_joint1") < -1.55
    )
    person.move(
        "Command of joint2",
        "20",
        lambda: client.status().robots[0].robot_mode == "reflex",
    )
    assert wait_until(lambda: _arms_alarm(client) is not None)
    assert position(client, "panda_joint2") < 0.0  # The table is in the way.
    person.clicks = 0
    person.click("Recover panda")
    assert wait_until(lambda: client.status().robots[0].robot_mode == "idle")
    assert person.clicks == counted("recover after a collision") <= 2
    enable(person)
    assert person.clicks <= 2
    person.move(
        "Command of joint2", "-45", lambda: position(client, "panda_joint2") < -0.7
    )
    person.page.locator("#alarms").click()
    assert _arms_alarm(client).cleared_at is not None
    dock = person.page.locator('.dock[data-dock="timeline"]')
    dock.get_by_role("button", name=re.compile("^Acknowledge panda")).click()
    assert wait_until(lambda: _arms_alarm(client) is None)


def _arms_alarm(client):
    """Return the alarm of the arm, or None."""
    alarms = [one for one in client.alarms.list() if one.subject == "robot panda"]
    return alarms[0] if alarms else None
