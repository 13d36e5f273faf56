"""A running station and a browser that is logged in to its dashboard."""

import json
import os
import socket
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest
from playwright.sync_api import sync_playwright

from station.client import StationClient
from tests.browser.viser_page import ViserPage
from tests.browser.workspace_page import (
    CONTROLLER,
    WorkspacePage,
    run_alone,
    without_scene,
)

CHROMIUM = "/usr/bin/chromium"
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
ARTIFACTS = Path("artifacts")
RATE = 250
"""Cycles a second of a station: at 1 kHz it takes the processor that the browser needs.

A simulated Panda stays at 1 kHz.
"""
_READY_LINES = 20
# Drawn in software, a picture of the arm takes longer than what a test waits for. All
# but the drawing happens: the scene, its matrices, what the pointer hits, the count of
# triangles. A picture that is wanted is read at the end of its frame, before it goes.
DRAW_ON_REQUEST = """
for (const name of ["drawArrays", "drawArraysInstanced", "drawElements",
                    "drawElementsInstanced", "drawRangeElements"]) {
  const draw = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...given) {
    if (!window.wanted) return;
    draw.apply(this, given);
    if (!window.wanted.begun) Promise.resolve().then(() => window.wanted?.read(this));
    window.wanted.begun = true;
  };
}
"""
DRAW = """
() => new Promise((done) => {
  if (!document.querySelector("canvas")) return done(0);
  window.wanted = {begun: false, read: (gl) => {
    const target = gl.getParameter(gl.FRAMEBUFFER_BINDING);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const bytes = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    const colours = new Set(new Uint32Array(bytes.buffer)).size;
    requestAnimationFrame(() => requestAnimationFrame(() => done(colours)));
  }};
})
"""


@pytest.fixture(scope="package")
def browser():
    """Debian's chromium without a GPU; its compiled shaders serve all modules."""
    if not Path(CHROMIUM).exists():
        pytest.fail(f"{CHROMIUM} is missing; install Debian's package `chromium`")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@contextmanager
def run_station(home, *arguments, rate=RATE):
    """`station run` with more arguments, with its files in `home`."""
    command = [sys.executable, "-m", "station", "run", "--port", "0", "--ui-port", "0"]
    with subprocess.Popen(
        [*command, "--json", "--rate", str(rate), *arguments],
        stdout=subprocess.PIPE,
        text=True,
        env={
            **os.environ,
            "XDG_RUNTIME_DIR": str(home),
            "XDG_DATA_HOME": str(home / "data"),
        },
    ) as process:
        try:
            yield _announced(process)
        finally:
            process.terminate()
            process.wait(10)


def _announced(process):
    told = {}
    for _ in range(_READY_LINES):
        told.update(json.loads(process.stdout.readline()))
        if "ui_ready" in told:
            break
    known = json.loads(Path(told["runtime_file"]).read_text())
    return SimpleNamespace(
        api=told["api_url"],
        ui=told["ui_url"],
        robot=told["robot"],
        token=known["token"],
        viewer_token=known["viewer_token"],
    )


def free_ports():
    """Return two ports at which nobody listens."""
    with socket.socket() as first, socket.socket() as second:
        first.bind(("127.0.0.1", 0))
        second.bind(("127.0.0.1", 0))
        return first.getsockname()[1], second.getsockname()[1]


@pytest.fixture
def client(running_station):
    """A script's client of the running station."""
    with StationClient(running_station.api, running_station.token) as client:
        yield client


@pytest.fixture(scope="module")
def page(browser, running_station):
    """The dashboard, logged in; a script error on the page fails the last test.

    Half the pixels in each direction, and few of them: they are drawn in software, and
    each click waits for a picture.
    """
    with logged_in(browser, running_station, height=560, scale=0.5) as page:
        yield page


@contextmanager
def logged_in(
    browser, running, *, width=1280, height=800, scale=1.0, begin=lambda _: None
):
    """Open the dashboard in a browser of its own, and log in.

    Args:
        browser: Makes it.
        running: The station.
        width: Of the window [px].
        height: Of the window [px].
        scale: Pixels of a picture over those of the page, in each direction.
        begin: Called with the context before the page is opened.
    """
    viewport = {"width": width, "height": height}
    with browser.new_context(viewport=viewport, device_scale_factor=scale) as context:
        context.add_init_script(DRAW_ON_REQUEST)
        begin(context)
        with opened(context, running) as page:
            yield page


@contextmanager
def opened(context, running, begin=lambda _: None):
    """Open the dashboard in a tab, and log in; a script error on the page is a failure.

    Args:
        context: Has the tab.
        running: The station.
        begin: Called with the tab before the page is opened.
    """
    page = context.new_page()
    begin(page)
    failures = []
    page.on("pageerror", lambda error: failures.append(str(error)))
    page.goto(f"{running.ui}/login?token={running.token}")
    try:
        yield page
    finally:
        page.close()
    assert failures == []


@pytest.fixture(scope="module")
def viser_page(page):
    """The part of the page that Viser draws, with the robot in it."""
    view = ViserPage(page)
    view.wait_for_scene()
    view.unfold_panel()
    return view


def keep_screenshot(page, name):
    """Keep a picture of the page as an artefact of the test run.

    Returns:
        How many colours the 3D view has in it; 1 is an empty one, 0 none at all.
    """
    view = page.query_selector("#view")
    frame = view.content_frame() if view else page.main_frame
    colours = frame.evaluate(DRAW)
    # Written here: Playwright would leave a thread behind for it.
    picture = page.screenshot()
    frame.evaluate("() => { window.wanted = null; }")
    ARTIFACTS.mkdir(exist_ok=True)
    (ARTIFACTS / name).write_bytes(picture)
    return colours


@pytest.fixture(scope="module")
def workspace_tab(browser, running_station):
    """The workspace, logged in; a script error on the page fails the last test."""
    with logged_in(browser, running_station, begin=without_scene) as page:
        yield page


@pytest.fixture(scope="module")
def workspace(workspace_tab):
    """What a person does on the workspace."""
    return WorkspacePage(workspace_tab)


@pytest.fixture
def enabled(client, workspace):
    """The default controller runs, and the page has noticed."""
    if client.controller(CONTROLLER).state != "running":
        run_alone(client, CONTROLLER)
    # An open dock that finds no room folds the one that was used longest ago.
    workspace.dock("joints")
    workspace.page.wait_for_function(
        "() => document.querySelector('.joints input')?.disabled === false"
    )
    return client


@pytest.fixture
def in_control(workspace, client):
    """The page holds control as ada; a script gives it back after the test."""
    page = workspace.page
    page.locator("#control").click()
    page.get_by_label("Your name").fill("ada")
    page.get_by_role("button", name="Take control", exact=True).click()
    page.locator("#control").get_by_text("you (ada)").wait_for()
    yield client
    taken = client.lease.take("the test", force=True)
    client.lease.act_under(taken.lease)
    client.lease.release()
    page.locator("#control").get_by_text("any operator").wait_for()
