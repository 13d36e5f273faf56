"""The page is told of all its modules at once."""

import re
from pathlib import Path

from station.ui import main as ui

STATIC = Path(ui.__file__).with_name("static")
ENTRIES = {"page.js", "login.js", "workspace.js"}
"""Scripts that a page names itself."""


def test_every_module_is_loaded_ahead_and_none_that_is_not_there():
    page = (STATIC / "page.html").read_text()
    told = re.findall(r'<link rel="modulepreload" href="/static/([^"]+)" />', page)
    files = {str(file.relative_to(STATIC)) for file in STATIC.rglob("*.js")}
    assert sorted(told) == sorted(files - ENTRIES)


def test_nothing_is_loaded_before_the_strip_and_its_stop():
    page = (STATIC / "page.html").read_text()
    assert page.index('src="/static/page.js"') < page.index("modulepreload")


def test_nothing_on_the_page_moves_by_itself():
    # Whoever asked for less motion then needs no rules of their own; what the page
    # moves is the ghost, which `forecast.js` shows at its end alone for them.
    sheet = (STATIC / "page.css").read_text()
    moving = re.findall(r"(?:animation|transition|scroll-behavior): ([^;]*)", sheet)
    # The first only waits: it shows a message when the page has not loaded after 8 s.
    assert moving == ["not-yet 8s", "none"]
    forecast = (STATIC / "lib" / "forecast.js").read_text()
    assert "(prefers-reduced-motion: reduce)" in forecast


def test_no_script_of_the_page_is_long():
    own = (f for f in STATIC.rglob("*.js") if "vendor" not in f.parts)
    lengths = {str(file): len(file.read_text().splitlines()) for file in own}
    assert max(lengths.values()) <= 450
    # A new panel has to find what it shares with another one.
    assert sum(lengths.values()) <= 5998
