"""Find and use the widgets of a Viser page with Playwright."""

import re

SETTLE_MS = 150
"""Viser's page sends at most one event per 50 ms; a second one replaces the first."""


class SceneWords:
    """The words in the 3D view: they are drawn, so the page has no text to look for.

    Args:
        frame: The part of the page that Viser draws; it ran `NOTE` before all else.
    """

    # Viser's page has its socket in a worker, which posts the messages to the page.
    NOTE = """
(() => {
  const Real = window.Worker;
  window.sceneWords = {};
  window.sceneHidden = {};
  const hear = (message) => {
    const words = window.sceneWords;
    if (message.type === "SetSceneNodeVisibilityMessage")
      window.sceneHidden[message.name] = !message.visible;
    if (message.type === "LabelMessage")
      words[message.name] = {text: message.props.text, visible: true};
    else if (!(message.name in words)) return;
    else if (message.type === "RemoveSceneNodeMessage") delete words[message.name];
    else if (message.type === "SetSceneNodeVisibilityMessage")
      words[message.name].visible = message.visible;
    else if (message.type === "SceneNodeUpdateMessage" && "text" in message.updates)
      words[message.name].text = message.updates.text;
  };
  window.Worker = class extends Real {
    constructor(...given) {
      super(...given);
      this.addEventListener("message", ({data}) => {
        if (data?.type === "message_batch") data.messages.forEach(hear);
      });
    }
  };
})();
"""

    def __init__(self, frame):
        self._frame = frame

    def shown(self):
        """Return all words that are shown now."""
        return self._frame.evaluate(
            "() => Object.values(window.sceneWords)"
            ".filter((one) => one.visible && one.text).map((one) => one.text)"
        )

    def wait_for(self, pattern):
        """Wait until words match a pattern; return them."""
        shown = self._frame.wait_for_function(
            "(pattern) => Object.values(window.sceneWords).find((one) =>"
            " one.visible && new RegExp(`^(?:${pattern})$`).test(one.text))?.text",
            arg=pattern,
        )
        return shown.json_value()


class SceneNodes:
    """What is in the 3D view, as the browser draws it.

    Args:
        frame: The part of the page that Viser draws.
    """

    # Drawn where it is, and as it was sent; a node of which a parent is hidden is not.
    _FIND = """
(pattern) => {
  const nodes = Object.entries(window.__viserSceneTree.getState());
  const wanted = new RegExp(`^${pattern}$`);
  const [name, node] = nodes.find(([name]) => wanted.test(name)) ?? [];
  const drawn = window.__viserMutable.nodeRefFromName[name];
  const world = window.__viserMutable.nodeRefFromName["/base_axes"];
  if (!drawn || !world || !node.effectiveVisibility) return null;
  drawn.updateWorldMatrix(true, false);
  world.updateWorldMatrix(true, false);
  const pose = world.matrixWorld.clone().invert().multiply(drawn.matrixWorld);
  const { points, color } = node.message.props;
  return {pose: pose.elements, points: points && Array.from(points), color};
}
"""

    def __init__(self, frame):
        self._frame = frame

    def find(self, pattern):
        """Return the first shown node whose name matches a pattern, or None.

        Returns:
            Its `pose` in the world in column-major order, shape (16,), and the `points`
            and the `color` that it was made with, if it has some.
        """
        return self._frame.evaluate(self._FIND, pattern)

    def wait_for(self, pattern):
        """Wait until a node is shown; return it."""
        return self._frame.wait_for_function(self._FIND, arg=pattern).json_value()

    def wait_for_end(self, pattern):
        """Wait until a node is not shown any more."""
        self._frame.wait_for_function(f"(p) => ({self._FIND})(p) === null", arg=pattern)


class ViserPage:
    """The part of a dashboard's page that Viser draws, an iframe.

    Args:
        page: The page, logged in.
    """

    def __init__(self, page):
        self.page = page
        page.wait_for_selector("#view")
        self.frame = page.query_selector("#view").content_frame()

    def wait_for_scene(self, triangles=100_000, timeout=60_000):
        """Wait until at least so many triangles are drawn."""
        self.frame.wait_for_function(
            "n => (window.__viserTestpoints?.rendererInfo?.render.triangles ?? 0) > n",
            arg=triangles,
            timeout=timeout,
        )

    def unfold_panel(self):
        """Open Viser's own panel, which is folded at first."""
        self.frame.get_by_text("Controls", exact=True).first.click()
        self.frame.get_by_role("tab").first.wait_for()
        self._settle()

    def open_tab(self, name):
        """Show a tab."""
        self.frame.get_by_role("tab", name=name, exact=True).click()
        self._settle()

    def row(self, label):
        """Return the row of a labelled input."""
        text = self.frame.locator("label", has_text=re.compile(f"^{re.escape(label)}$"))
        return text.locator(
            'xpath=ancestor::div[contains(@class,"mantine-Flex-root")][1]'
        )

    def box(self, label):
        """Return the first text box of a labelled input."""
        return self.row(label).locator("input:not([type=hidden])").first

    def drag_slider(self, label, fraction):
        """Drag a slider's thumb to a fraction of its track."""
        row = self.row(label)
        row.scroll_into_view_if_needed()
        track = row.locator(".mantine-Slider-trackContainer").first.bounding_box()
        thumb = row.get_by_role("slider").bounding_box()
        y = thumb["y"] + thumb["height"] / 2
        self.page.mouse.move(thumb["x"] + thumb["width"] / 2, y)
        self.page.mouse.down()
        self.page.mouse.move(track["x"] + fraction * track["width"], y, steps=5)
        self.page.mouse.up()
        self._settle()

    def _settle(self):
        self.page.wait_for_timeout(SETTLE_MS)
