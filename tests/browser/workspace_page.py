"""Find and use the docks of the workspace with Playwright, as a person would."""

from tests import waiting

CONTROLLER = "effort_group_position_controller"
"""The controller that the page starts first."""
OTHER = "position_group_controller"
"""Another one that wants the same joints."""
# Thirty frames a second are a third of what page, dashboard and station compute; ten
# show the same. Plots that are drawn fifteen times a second are a fifth; five times do.
FEWER_FRAMES = """
window.WebSocket = class extends WebSocket {
  constructor(url) {
    super(url.replace(/([?&]rate)=30\\b/, "$1=10"));
  }
};
(() => {
  const {setInterval} = window;
  const plots = 1000 / 15;
  window.setInterval = (look, ms, ...more) =>
    setInterval(look, ms === plots ? 200 : ms, ...more);
})();
"""

# The frame of the 3D view stays, and is empty. To answer its request in place of the
# dashboard costs more: Playwright is then asked about every request of the page.
NO_SCENE = """
if (location.pathname === "/ui/") {
  window.stop();
  document.append(document.createElement("html"));
  document.documentElement.append(document.createElement("body"));
}
"""


def wait_until(holds, seconds=20.0):
    """Poll until `holds()` is true; return its last answer, which callers assert.

    A look is a request here, of several milliseconds of two processes. A hundred of
    them a second would take half a processor from the page that is waited for.

    Args:
        holds: What is waited for.
        seconds: How long at most [s].
    """
    return waiting.wait_until(holds, seconds, pause=0.05)


class WorkspacePage:
    """The page around the 3D view.

    Args:
        page: The page, logged in.
    """

    def __init__(self, page):
        self.page = page
        page.wait_for_selector('#bar[data-link="live"]')
        fold = page.locator('.dock[data-dock="joints"] .fold')
        if fold.get_attribute("aria-expanded") == "true":
            page.wait_for_selector(".joints tbody tr")

    def dock(self, name):
        """Return a dock, unfolded and in view."""
        dock = self.page.locator(f'.dock[data-dock="{name}"]')
        fold = dock.locator(".fold")
        if fold.get_attribute("aria-expanded") == "false":
            fold.click()
        dock.scroll_into_view_if_needed()
        return dock

    def button(self, dock, name):
        """Return a button of a dock."""
        return self.dock(dock).get_by_role("button", name=name, exact=True)

    def type_into(self, dock, label, text):
        """Type a value into a field and press Enter; twice if it is a far one."""
        field = self.dock(dock).get_by_label(label, exact=True)
        field.fill(text)
        field.press("Enter")
        if self.page.locator(".far").is_visible():
            field.press("Enter")


def position(client, joint):
    """Return the measured position of a joint [rad]."""
    joints = client.joint_states()
    return joints.position[joints.name.index(joint)]


def let_pass(client, seconds):
    """Wait until so much station time has passed [s]; callers assert it."""
    end = client.status().time + seconds
    return wait_until(lambda: client.status().time > end)


def run_alone(client, *names):
    """Let these controllers run, and no others but the one that tells the states."""
    running = {one.name for one in client.controllers() if one.state == "running"}
    stop = running - {*names, "joint_state_controller"}
    start = {*names} - running
    if start or stop:
        client.switch_controllers(start=sorted(start), stop=sorted(stop))


def allow_motion(client):
    """Take back a STOP, if there is one."""
    if client.status().stop_state != "armed":
        client.release_stop()
        client.release_stop(arm=True)


def without_scene(context):
    """Leave the 3D view empty: drawn in software it takes longer than the rest.

    The page follows the streams with fewer frames, too.
    """
    context.add_init_script(FEWER_FRAMES)
    context.add_init_script(NO_SCENE)
    context.set_default_timeout(20_000)
