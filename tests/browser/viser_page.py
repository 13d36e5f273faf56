"""Find and use the widgets of a Viser page with Playwright."""

import re

SETTLE_MS = 150
"""Viser's page sends at most one event per 50 ms; a second one replaces the first."""


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

    def select(self, label, option):
        """Choose an option of a dropdown."""
        self.box(label).click()
        self.frame.get_by_role("option", name=option, exact=True).click()
        self._settle()

    def fill(self, label, text):
        """Replace the text of an input."""
        row = self.row(label)
        row.locator("input:not([type=hidden]), textarea").first.fill(text)
        self._settle()

    def click(self, button):
        """Click a button once it is enabled."""
        self.frame.get_by_role("button", name=button, exact=True).click()
        self._settle()

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
