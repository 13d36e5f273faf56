"""The page at many sizes: no text is cut, no control covered or moved by a STOP."""

import re
from pathlib import Path

import pytest

from tests.browser.conftest import ARTIFACTS
from tests.browser.workspace_page import WorkspacePage, wait_until

pytestmark = pytest.mark.long

STYLES = Path(__file__).parents[3] / "station/ui/static/page.css"
CHECKS = Path(__file__).with_name("layout_checks.js")
SIZES = {
    "1280x800": (1280, 800),
    "1440x900": (1440, 900),
    "1920x1080": (1920, 1080),
    "768x1024": (768, 1024),
    "390x844": (390, 844),
    "1280x800 at 150 %": (853, 533),
    "1920x1080 at 150 %": (1280, 720),
}
STOPPED_IN_ALL = {"1280x800", "390x844"}
"""Sizes with a STOP in every view; the strip that grows is the same in all of them."""
PRESETS = ("Operate", "Tune", "Record", "Safety")
# The docks look at the station every 350 ms.
LOOKED_MS = 400


@pytest.fixture(scope="module")
def page(open_tab):
    """The page, whose tour was to be skipped at every size."""
    checks = CHECKS.read_text()
    with open_tab(lambda tab: tab.add_init_script(checks)) as page:
        WorkspacePage(page)
        page.emulate_media(color_scheme="light", reduced_motion="reduce")
        skip = page.get_by_role("button", name="Skip the tour")
        for size in SIZES.values():
            _resize(page, *size)
            skip.click(trial=True)
        skip.click()
        yield page


def _resize(page, width, height):
    page.set_viewport_size({"width": width, "height": height})
    page.wait_for_function("(width) => innerWidth === width", arg=width)


def _views(page):
    """Show every layout in turn, or every dock of a narrow page; yields its name."""
    if page.locator("#layouts").is_visible():
        for preset in PRESETS:
            page.locator("#layouts").get_by_role("button", name=preset).click()
            yield preset
    else:
        for button in page.locator("#docks-nav button:visible").all():
            button.click()
            yield button.inner_text()


def _faults(page, *checks):
    return [
        f"{name}: {fault}"
        for name in checks
        for fault in page.evaluate(f"() => layoutChecks.{name}()")
    ]


def _is_at_rest(page):
    """Return whether nothing is moved by what the docks come to know meanwhile."""
    page.evaluate("() => layoutChecks.remember()")
    page.wait_for_timeout(LOOKED_MS)
    return not _faults(page, "moved")


def _moved_by_a_stop(page):
    page.evaluate("() => layoutChecks.remember()")
    page.locator("#stop").click()
    page.locator("#release").wait_for()
    found = _faults(page, "moved")
    page.locator("#release").click()
    page.locator("#arm").click()
    page.locator("#arm").wait_for(state="hidden")
    return found + _faults(page, "moved")


def test_the_dark_page_differs_in_its_colours_alone():
    """The layout of the light page is that of both."""
    css = STYLES.read_text()
    assert css.count("prefers-color-scheme") == 1
    dark = re.search(r"scheme: dark\) \{\s*:root \{([^}]*)\}\s*\}", css)[1]
    lines = [line.strip() for line in dark.split(";")]
    assert all(re.fullmatch(r"--[\w-]+: #\w+|", line) for line in lines)


OVERLAP = """() => {
  const box = (each) => each.getBoundingClientRect();
  const facts = [...document.querySelectorAll(".facts > div")].map(box);
  const actions = box(document.querySelector("#bar .actions"));
  return facts.some((fact) => fact.right > actions.left && fact.top < actions.bottom);
}"""


def test_facts_and_buttons_of_the_bar_never_overlap(page):
    overlapping = []
    for width in range(1000, 1700, 20):
        _resize(page, width, 800)
        if page.evaluate(OVERLAP):
            overlapping.append(width)

    assert overlapping == []


@pytest.mark.parametrize("size", SIZES)
def test_no_text_is_cut_nothing_is_covered_and_a_stop_moves_nothing(page, size):
    _resize(page, *SIZES[size])
    faults = []
    for number, view in enumerate(_views(page)):
        # Numbers that change may go on to move others: nothing is lost by that.
        wait_until(lambda: _is_at_rest(page), seconds=3)
        found = _faults(page, "cut", "covered")
        if number == 0 or size in STOPPED_IN_ALL:
            found += _moved_by_a_stop(page)
        if number == 0 or found:
            ARTIFACTS.mkdir(exist_ok=True)
            name = f"layout-{SIZES[size][0]}-{view}.png".replace(" ", "-")
            (ARTIFACTS / name).write_bytes(page.screenshot())
        faults += [f"{view}: {fault}" for fault in found]
    assert not faults, "\n".join(faults)
