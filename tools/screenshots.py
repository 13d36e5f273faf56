"""Take pictures of every dock of the dashboard, to be looked at: `artifacts/docks/`.

A station of its own is started and ended. Each size is a page of its own, whose docks
are shown in turn, light and dark; three sizes take some three minutes without a GPU.
`--readme` renews the picture of the docs;
`--station examples/dual_panda.yaml` or `--station=--robot=ur5` shows another robot.
"""

import argparse
import io
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from PIL import Image, ImageOps
from playwright.sync_api import Browser, Page, sync_playwright

SIZES = ((1280, 800), (1920, 1080), (390, 844))
PLACE = Path("artifacts/docks")
README = Path("docs/images/dashboard.png")
FLAGS = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]
SCENE_MS = 90_000
SETTLING_MS = 500  # the docks look at the station every 350 ms
MOVING_MS = 1500
NICENESS = 10
NARROW = 999
_READY_LINES = 20


@contextmanager
def station(arguments: Sequence[str]) -> Iterator[str]:
    """Run a station on free ports; yields the address that logs in.

    Args:
        arguments: More arguments of `station run`.
    """
    command = [sys.executable, "-m", "station", "run", "--port", "0", "--ui-port", "0"]
    with tempfile.TemporaryDirectory() as home:
        places = {
            "XDG_RUNTIME_DIR": home,
            "XDG_DATA_HOME": f"{home}/data",
            "XDG_STATE_HOME": f"{home}/state",
        }
        process = subprocess.Popen(
            [*command, "--json", *arguments],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **places},
        )
        try:
            told: dict[str, str] = {}
            for line, _ in zip(process.stdout or (), range(_READY_LINES), strict=False):
                told.update(json.loads(line))
                if "ui_ready" in told:
                    break
            token = json.loads(Path(told["runtime_file"]).read_text())["token"]
            yield f"{told['ui_url']}/login?token={token}"
        finally:
            process.terminate()
            process.wait(15)


def opened(browser: Browser, login: str, size: tuple[int, int]) -> Page:
    """Return the page, logged in, with the robot drawn and the tour skipped."""
    width, height = size
    context = browser.new_context(viewport={"width": width, "height": height})
    page = context.new_page()
    page.set_default_timeout(SCENE_MS)
    page.goto(login)
    page.wait_for_selector(".joints tbody tr", state="attached")
    page.get_by_role("button", name="Skip the tour").click()
    page.wait_for_function("() => document.getElementById('progress').hidden")
    return page


def docks(page: Page) -> list[str]:
    """Return the names of the docks, in their order on the page."""
    names: list[str] = page.locator(".dock").evaluate_all(
        "docks => docks.map((dock) => dock.dataset.dock)"
    )
    return names


def show_dock(page: Page, dock: str, size: tuple[int, int]) -> None:
    """Unfold a dock and fold the others beside it; choose it on a narrow screen."""
    if size[0] <= NARROW:
        page.locator(f'#docks-nav [data-dock="{dock}"]').click()
    for other in page.locator(".dock").all():
        name = other.get_attribute("data-dock")
        fold = other.locator(".fold")
        is_open = fold.get_attribute("aria-expanded") == "true"
        is_beside = other.evaluate("e => e.parentElement.className") == "column"
        if is_open != (name == dock or not is_beside) and fold.is_visible():
            fold.click()
    page.locator(f'.dock[data-dock="{dock}"]').scroll_into_view_if_needed()


def move(page: Page, size: tuple[int, int]) -> None:
    """Enable the sliders and move two joints, so that plots have something to show."""
    recover = page.locator("#trouble button")  # An arm stops if its loop is starved.
    if recover.is_visible():
        recover.click()
        recover.wait_for(state="hidden")
    enable = page.locator("#enable")
    if enable.is_visible():
        enable.click()
    show_dock(page, "joints", size)
    page.wait_for_function("() => !document.querySelector('.joints input').disabled")
    fields = page.locator(".joints input")
    for row, value in ((0, "18"), (3, "-100")):
        fields.nth(row).fill(value)
        fields.nth(row).press("Enter")
        page.wait_for_timeout(MOVING_MS)


def take(page: Page, name: str, schemes: Sequence[str]) -> None:
    """Keep a picture of the page, light and dark."""
    page.wait_for_timeout(SETTLING_MS)
    PLACE.mkdir(parents=True, exist_ok=True)
    size = page.evaluate("() => `${innerWidth}x${innerHeight}`")
    for scheme in schemes:
        page.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
        (PLACE / f"{name}-{size}-{scheme}.png").write_bytes(page.screenshot())


def all_docks(
    browser: Browser, login: str, size: tuple[int, int], schemes: Sequence[str]
) -> None:
    """Take a picture of the page as it opens, and of each dock."""
    page = opened(browser, login, size)
    take(page, "00-first", schemes)
    move(page, size)
    take(page, "01-moving", schemes)
    for i, dock in enumerate(docks(page)):
        show_dock(page, dock, size)
        take(page, f"{i + 2:02}-{dock}", schemes)
    page.context.close()


def readme(browser: Browser, login: str) -> None:
    """Renew the picture of the docs: the robot, docks, and plots with data."""
    page = opened(browser, login, SIZES[0])
    page.locator("#enable").click()
    page.wait_for_function("() => !document.querySelector('.joints input').disabled")
    for joint, value in (("joint1", "25"), ("joint4", "-115"), ("joint1", "-5")):
        field = page.get_by_label(f"Command of {joint}")
        field.fill(value)
        field.press("Enter")
        page.wait_for_timeout(2200)
    picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
    # Six bits of each colour look the same and need fewer bytes.
    ImageOps.posterize(picture, 6).save(README, optimize=True)


def main() -> None:
    """Take the pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--readme", action="store_true")
    parser.add_argument("--schemes", nargs="+", default=["light", "dark"])
    parser.add_argument("--widths", nargs="+", type=int, help="only these sizes")
    parser.add_argument(
        "--station", nargs="+", default=[], help="arguments of `station run`"
    )
    chosen = parser.parse_args()
    with station(chosen.station) as login:
        # Drawing in software must not starve the control loop; the browser inherits it.
        os.setpriority(os.PRIO_PROCESS, 0, NICENESS)
        take_pictures(login, chosen)


def take_pictures(login: str, chosen: argparse.Namespace) -> None:
    """Take the pictures that were asked for."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=FLAGS
        )
        if chosen.readme:
            readme(browser, login)
        else:
            widths = chosen.widths or [width for width, _ in SIZES]
            for size in (size for size in SIZES if size[0] in widths):
                all_docks(browser, login, size, chosen.schemes)
        browser.close()


if __name__ == "__main__":
    main()
