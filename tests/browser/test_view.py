"""What the 3D view says: progress, forces, contacts, the commanded pose, a target.

The view is a picture, so a test reads the words that were sent to it and counts what
was drawn; the station tells whether that is true.
"""

import math
import re

import httpx
import numpy as np
import pytest

from tests.browser.conftest import keep_screenshot, logged_in, run_station
from tests.browser.viser_page import SceneNodes, SceneWords, ViserPage
from tests.browser.workspace_page import (
    CONTROLLER,
    WorkspacePage,
    let_pass,
    position,
    run_alone,
    wait_until,
)

pytestmark = pytest.mark.long

WALL = """
scene:
  objects:
    - {name: wall, type: box, size: [0.3, 0.1, 0.4], position: [0.3, 0.25, 0.5]}
"""
TARGETS = "cartesian_streaming_controller"
# The progress line is noted from its first words on.
NOTE_PROGRESS = """
addEventListener("DOMContentLoaded", () => {
  const line = document.getElementById("progress");
  if (!line) return;
  window.progressSaid = [];
  const note = () => window.progressSaid.push(line.hidden ? "" : line.textContent);
  note();
  const everything = {attributes: true, childList: true, subtree: true};
  new MutationObserver(note).observe(line, {...everything, characterData: true});
});
"""
DRAWN = "() => window.__viserTestpoints.rendererInfo.render"


@pytest.fixture(scope="module")
def running_station(tmp_path_factory):
    """A station with a wall at the left of the arm."""
    home = tmp_path_factory.mktemp("station")
    (home / "station.yaml").write_text(WALL)
    with run_station(home, str(home / "station.yaml")) as running:
        yield running


@pytest.fixture(scope="module")
def page(browser, running_station):
    """The page with its 3D view; half the pixels each way, drawn in software."""

    def begin(context):
        context.add_init_script(NOTE_PROGRESS)
        context.add_init_script(SceneWords.NOTE)
        context.set_default_timeout(60_000)

    with logged_in(
        browser, running_station, height=640, scale=0.5, begin=begin
    ) as page:
        yield page


@pytest.fixture
def view(page):
    """The 3D view with everything in it."""
    page.wait_for_function("() => document.getElementById('progress').hidden")
    skip = page.get_by_role("button", name="Skip the tour")
    if skip.is_visible():
        skip.click()
    return ViserPage(page).frame


@pytest.fixture
def words(view):
    """The words that are shown in the 3D view."""
    return SceneWords(view)


@pytest.fixture
def nodes(view):
    """What is drawn in the 3D view."""
    return SceneNodes(view)


@pytest.fixture
def workspace(page):
    return WorkspacePage(page)


@pytest.fixture
def at_rest(client):
    """The arm stands in its first pose with its first gains, before and after."""
    before = client.gains(CONTROLLER).values
    _reset(client)
    yield client
    _reset(client)
    client.set_gains(CONTROLLER, before)


def _reset(client):
    run_alone(client)
    client.simulation.reset()


def test_a_line_says_what_loads_until_all_arms_are_drawn(page, view):
    said = page.evaluate("() => window.progressSaid")
    # Robots that are loaded at once leave the first words no time.
    begins = ("Opening the 3D view", "Loading the 3D view", "3D view: loading")
    assert said[0].startswith(begins)
    assert said[-1] == ""
    wanted = page.evaluate(
        "async () => (await (await fetch('/workspace/state')).json()).triangles"
    )
    steps = "\n".join(said)
    assert f"3D view: loading the robots (0 of {wanted:,} triangles)" not in steps
    # A slow page draws all of them between two looks, and may learn late how many.
    assert re.search(
        rf"(?:loading the robots \([\d,]+(?: of {wanted:,})? triangles\)|connecting)",
        steps,
    )
    assert view.evaluate(DRAWN)["triangles"] >= wanted > 100_000


def _enable(page):
    page.locator("#enable").click()
    page.wait_for_function("() => !document.querySelector('.joints input').disabled")


def _lean_on_the_wall(page, workspace, client):
    """Press the hand to the wall, so softly that the arm does not stop itself."""
    _enable(page)
    client.set_gains(CONTROLLER, {"panda_joint1/p": 40.0})
    _move(workspace, "joint1", 27, speed=12)


def _move(workspace, joint, degrees, *, speed):
    """Type where a joint shall be, and how fast it may go there [deg/s]."""
    field = workspace.dock("joints").get_by_label("Top speed in degrees per second")
    field.evaluate(
        "(e, speed) => {"
        " e.value = speed; e.dispatchEvent(new Event('input', {bubbles: true})); }",
        speed,
    )
    workspace.type_into("joints", f"Command of {joint}", str(degrees))


def _toggle(page, layer):
    """Click one of the buttons after *Show*."""
    tools = page.locator("#view-tools")
    tools.get_by_role("button", name=layer, exact=True).click()


def _matrix(elements):
    """Return a homogeneous matrix of 16 numbers in column-major order."""
    return np.reshape(elements, (4, 4), order="F")


def _flange(state):
    """Return the pose of the flange in the base, by the station."""
    return _matrix(state.O_T_EE) @ np.linalg.inv(_matrix(state.F_T_EE))


@pytest.fixture
def touching(running_station):
    """Ask the station for the bodies that touch the wall, one for each contact."""

    def ask():
        answer = httpx.get(
            f"{running_station.api}/api/v1/scene",
            headers={"Authorization": f"Bearer {running_station.token}"},
        )
        pairs = [set(one["bodies"]) for one in answer.json()["contacts"]]
        return [(pair - {"wall"}).pop() for pair in pairs if "wall" in pair]

    return ask


def test_a_touched_wall_shows_contacts_the_force_and_the_commanded_pose(
    page, view, words, workspace, at_rest, touching
):
    before = view.evaluate(DRAWN)
    _lean_on_the_wall(page, workspace, at_rest)
    assert wait_until(touching, 30)
    found = words.wait_for(r"panda_\w+ touches wall, \d+ N")
    assert found.split()[0] in touching()
    assert words.wait_for("commanded pose")
    assert position(at_rest, "panda_joint1") < math.radians(27) - 0.03
    said = words.wait_for(r"\d+ N on the arm")
    force = at_rest.robot("panda").state().O_F_ext_hat_K[:3]
    assert int(said.split()[0]) == pytest.approx(math.hypot(*force), abs=6.0)
    drawn = view.evaluate(DRAWN)
    assert drawn["points"] == before["points"] + len(touching())
    assert drawn["triangles"] > before["triangles"]
    key = page.locator("#view-tools .key")
    for meaning in ("commanded pose", "force on the arm", "contact"):
        assert key.get_by_text(meaning, exact=True).is_visible()
    keep_screenshot(page, "view_forces.png")


def test_what_is_not_laid_over_the_robot_is_not_explained(page):
    key = page.locator("#view-tools .key")
    forces = page.locator("#view-tools").get_by_role("button", name="Forces")
    forces.dispatch_event("click")
    key.get_by_text("contact", exact=True).wait_for(state="hidden")
    forces.dispatch_event("click")
    key.get_by_text("contact", exact=True).wait_for()


def _stands_at(nodes, pattern, pose):
    """Return whether a node comes to a pose; it has none before its first picture.

    The tolerance is how far the arm's own weight and its motion bend its joints.
    """

    def pose_now():
        node = nodes.find(pattern)
        return _matrix(node["pose"]) if node else np.full((4, 4), np.inf)

    return wait_until(lambda: np.allclose(pose_now(), pose, rtol=0.0, atol=0.01))


def test_the_frames_are_where_the_station_says(page, nodes, words, at_rest):
    hand = at_rest.robot("panda")
    tip = np.eye(4)
    tip[2, 3] = 0.05
    hand.set_K_frame(tip.flatten(order="F").tolist())
    _toggle(page, "Frames")
    for name in ("O", "F", "EE", "K"):
        words.wait_for(name)
    state = hand.state()
    tool = _matrix(state.O_T_EE)
    wanted = {"O": np.eye(4), "F": _flange(state), "EE": tool, "K": tool @ tip}
    for name, pose in wanted.items():
        assert _stands_at(nodes, f".*/frame_{name}", pose), name
    key = page.locator("#view-tools .key")
    assert key.get_by_text("z axis", exact=True).is_visible()
    _toggle(page, "Frames")
    for name in wanted:
        nodes.wait_for_end(f".*/frame_{name}")
    hand.set_K_frame(np.eye(4).flatten().tolist())


def test_the_trail_ends_at_the_flange_and_a_waypoint_is_previewed_as_a_ghost(
    page, nodes, words, workspace, at_rest
):
    hand = at_rest.robot("panda")
    _enable(page)
    dock = workspace.dock("move")
    dock.get_by_role("button", name="+ Capture").click()
    captured = _flange(hand.state())
    _toggle(page, "Trail")
    _move(workspace, "joint1", -35, speed=85)
    assert wait_until(lambda: position(at_rest, "panda_joint1") < math.radians(-34))

    def here():
        return _flange(hand.state())[:3, 3]

    def trail():
        node = nodes.find("/trail_0")
        return np.reshape(node["points"] if node else [9.0] * 3, (-1, 3))

    assert wait_until(lambda: np.linalg.norm(trail()[-1] - here()) < 0.01)
    arrived = here()
    assert np.linalg.norm(trail() - captured[:3, 3], axis=1).min() < 0.01
    dock = workspace.dock("move")  # it may have been folded for the joints
    dock.get_by_role("button", name=re.compile("Move to this waypoint")).hover()
    words.wait_for("waypoint .*")
    ghost = "/ghost_0/.*/panda_link8"
    assert _stands_at(nodes, ghost, captured)
    preview = dock.get_by_role("button", name="Preview", exact=True)
    preview.click()
    words.wait_for("preview, to .*")
    preview.click()
    nodes.wait_for_end(ghost)
    # The robot has not moved for the picture's sake.
    assert here() == pytest.approx(arrived, abs=0.015)
    _toggle(page, "Trail")
    nodes.wait_for_end("/trail_0")
    at_rest.waypoint_paths.delete(at_rest.waypoint_paths.names()[0])


def test_the_link_of_a_joint_near_its_limit_is_tinted_and_explained(
    page, nodes, words, workspace, at_rest
):
    _enable(page)
    _move(workspace, "joint7", 160, speed=85)
    assert wait_until(lambda: position(at_rest, "panda_joint7") > math.radians(159))

    def error_of_words():
        told = words.wait_for(r"panda_joint7: \d+° to its upper limit")
        room = 166 - math.degrees(position(at_rest, "panda_joint7"))
        return int(re.search(r"(\d+)°", told)[1]) - room

    # The words are of the moment at which they came, a picture ago.
    assert wait_until(lambda: abs(error_of_words()) < 0.6)
    assert nodes.wait_for(".*/panda_link7/tint")["color"] == [235, 94, 0]
    key = page.locator("#view-tools .key").get_by_text("joint near its limit")
    assert key.is_visible()
    _toggle(page, "Limits")
    nodes.wait_for_end(".*/tint")
    assert not key.is_visible()
    _toggle(page, "Limits")
    nodes.wait_for(".*/panda_link7/tint")


def _flange_in_the_page(page, below):
    """Return where in the page a point under the flange is, seen by the preset Hand.

    Args:
        page: The page.
        below: How far under the flange the point is, along the world's z axis [m].
    """
    towards = np.array([0.76, -0.58, 0.293]) / np.linalg.norm([0.76, -0.58, 0.293])
    lift = math.sqrt(1.0 - towards[2] ** 2)
    depth = 0.75 + below * towards[2]
    box = page.locator("#view").bounding_box()
    down = below * lift / (depth * math.tan(0.7 / 2.0)) * box["height"] / 2.0
    return box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0 + down


def test_the_hand_follows_the_dragged_target_and_stays_where_it_was_let_go(
    page, view, workspace, at_rest
):
    # Who used the sliders before shall not find an arm that ignores the target.
    _enable(page)
    dock = workspace.dock("move")
    dock.get_by_text("Hand: jog and target").click()
    before = view.evaluate(DRAWN)["triangles"]
    page.get_by_role("button", name="Hand", exact=True).dispatch_event("click")
    # Seen from near, most of the arm is not in the picture.
    view.wait_for_function(f"n => ({DRAWN})().triangles < n", arg=before)
    dock.get_by_role("button", name="Start hand targets").click()
    assert wait_until(lambda: at_rest.controller(TARGETS).state == "running")
    assert at_rest.controller(CONTROLLER).state != "running"
    view.wait_for_function(
        "() => window.sceneHidden['/robot/panda_link0/target'] === false"
    )
    # The offer to enable sliders instead does not cover the hand.
    page.wait_for_function("() => document.getElementById('enable').offsetHeight < 30")
    hand = at_rest.robot("panda")

    def height():
        return hand.state().O_T_EE[14]

    start = height()
    x, y = _flange_in_the_page(page, 0.1034 + 0.05)
    page.mouse.move(x, y)
    page.wait_for_timeout(300)
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(x, y + 5 * step)
    assert wait_until(lambda: height() < start - 0.02)
    keep_screenshot(page, "view_target.png")
    page.mouse.up()
    assert wait_until(lambda: max(map(abs, hand.state().dq)) < 0.02)
    rest = height()
    assert let_pass(at_rest, 1.0)
    assert height() == pytest.approx(rest, abs=2e-3)
    assert hand.state().O_T_EE[12:14] == pytest.approx([0.307, 0.0], abs=0.02)


SCHEME = """
(wanted) => document.getElementById("view").contentDocument
  .documentElement.dataset.mantineColorScheme === wanted
"""


@pytest.mark.usefixtures("view")
def test_the_view_is_dark_while_the_page_is(page):
    page.emulate_media(color_scheme="dark")
    page.wait_for_function(SCHEME, arg="dark")
    keep_screenshot(page, "dark.png")
    page.emulate_media(color_scheme="light")
    page.wait_for_function(SCHEME, arg="light")


# Where a point above the middle of a node is in the picture.
PROJECTED = """
([name, above]) => {
  const {nodeRefFromName: nodes, camera, canvas} = window.__viserMutable;
  if (!nodes[name]) return null;
  const point = camera.position.clone().set(0, 0, above);
  const at = nodes[name].localToWorld(point).project(camera);
  const box = canvas.getBoundingClientRect();
  const [x, y] = [(1 + at.x) / 2 * box.width, (1 - at.y) / 2 * box.height];
  return [box.left + x, box.top + y];
}
"""


def _drag_up(page, view, arrows, by):
    """Drag the upper one of the arrows by some pixels."""
    corner = page.locator("#view").bounding_box()
    x, y = view.evaluate(PROJECTED, [arrows, 0.12])
    x, y = x + corner["x"], y + corner["y"]
    page.mouse.move(x, y)
    page.wait_for_timeout(300)  # until the view knows what the pointer is at
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(x, y - by * step / 8)
    page.mouse.up()


def _height(client, name):
    return next(one.position[2] for one in client.scene() if one.name == name)


def test_a_box_dragged_into_the_way_stops_the_arm_short_of_its_margin(
    page, view, workspace, at_rest, nodes
):
    dock = workspace.dock("simulation")
    dock.get_by_label("Size of the new object [m]").fill("0.1, 0.1, 0.4")
    dock.get_by_role("button", name="Add", exact=True).click()
    place = dock.get_by_label("Position of box [m]")
    place.fill("0.27, -0.27, 0.45")
    place.press("Enter")

    def arrows():
        shown = nodes.find("/moved_object")
        return shown and shown["pose"][14]

    assert wait_until(lambda: arrows() == pytest.approx(0.45))
    _drag_up(page, view, "/moved_object", 32)
    assert wait_until(lambda: _height(at_rest, "box") > 0.47)
    at_rest.switch_controllers(start=["position_group_controller"])
    _move(workspace, "joint1", -80, speed=40)
    assert wait_until(lambda: position(at_rest, "panda_joint1") < -0.05)

    def room():
        (nearest,) = at_rest.clearances()
        return nearest.distance - nearest.margin

    assert wait_until(lambda: room() < 5e-3)
    panda = at_rest.robot("panda")
    assert wait_until(lambda: max(map(abs, panda.state().dq)) < 0.02)
    assert room() > -1e-3
    assert position(at_rest, "panda_joint1") > -0.7
    dock.get_by_role("button", name="Remove box", exact=True).click()
    assert wait_until(lambda: [one.name for one in at_rest.scene()] == ["wall"])


def test_a_motion_is_rehearsed_and_goes_around_what_is_in_the_way(
    workspace, at_rest, nodes
):
    beyond = {"name": "beyond", "duration": 3.0, "positions": {"panda_joint1": 1.5}}
    at_rest.waypoint_paths.save("poses", [beyond])
    joints = workspace.dock("joints")
    joints.get_by_label("Pose", exact=True).dispatch_event("pointerdown")
    joints.get_by_role("button", name="Rehearse").click()
    joints.get_by_text(re.compile("It would end after .* s, at ")).wait_for()
    assert position(at_rest, "panda_joint1") == pytest.approx(0.0, abs=0.01)
    joints.get_by_role("button", name="Go around").click()
    joints.get_by_text(re.compile(r"A way around .* It would be completed")).wait_for()
    nodes.wait_for("/ghost_0.*")
    joints.get_by_role("button", name="Move as rehearsed").click()
    assert wait_until(lambda: abs(position(at_rest, "panda_joint1") - 1.5) < 0.01, 30)
    assert at_rest.robot("panda").errors().robot_mode != "reflex"
    at_rest.waypoint_paths.delete("poses")
