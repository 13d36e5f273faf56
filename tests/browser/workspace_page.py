"""Find and use the docks of the workspace with Playwright, as a person would."""


class WorkspacePage:
    """The page around the 3D view.

    Args:
        page: The page, logged in.
    """

    def __init__(self, page):
        self.page = page
        page.wait_for_selector('#bar[data-link="live"]')
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
        """Type a value into a field and press Enter."""
        field = self.dock(dock).get_by_label(label, exact=True)
        field.fill(text)
        field.press("Enter")

    def hold(self, dock, name, milliseconds):
        """Hold a button for some time."""
        button = self.button(dock, name)
        button.hover()
        self.page.mouse.down()
        self.page.wait_for_timeout(milliseconds)
        self.page.mouse.up()
