"""How old the pose on the screen is, and what three browsers cost the control loop.

Run `python benchmarks/bench_dashboard.py [--seconds 20] [--browsers 3]` on a machine
that does nothing else; it needs Chromium and the packages of the tests. It starts
`station run` with its dashboard, measures without browsers, then with some that are
niced, so that drawing in software on the same cores does not decide it. Then it kills
the station, starts it again, and measures when its API, its dashboard and the open
pages are back. At the end it measures what six traces of the dock *Plots* cost a
browser.

The age of a pose: joint 1 turns steadily, and one way alone, so its angle says when the
station had it. A page notes when a pose reaches it (Viser's worker has decoded it), and
the newest one whenever a picture is due (an animation frame). Without a GPU a picture
keeps the page from taking poses for a second, which says nothing of the dashboard. So
it is measured once more with pages that do all but fill pixels, which a GPU does beside
the page. The station's time is laid over the wall clock by the fastest of many stream
frames: the age leaves out what that one needed on its way, under 1 ms.
"""

import argparse
import contextlib
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from live import BROWSER_FLAGS
from measuring import print_table, print_title
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page, sync_playwright

from station.client import StationClient
from station.wire import LoopReport

CONTROLLER = "effort_group_position_controller"
JOINT = "panda_joint1"
NODE = "/robot/panda_link0/panda_link1"
SWEEP = 1.2
"""While poses are timed the joint turns from minus this to plus this [rad]."""
SPEED = 0.4
"""Speed of the joint on its way there, and back [rad/s]."""
SETTLING = 3.0
"""Pause between the two, in which pages take what has come before [s]."""
NICENESS = 10
_CLOCK = os.sysconf("SC_CLK_TCK")
_PATIENCE = 120.0
# Viser's page has its socket in a worker, which posts the messages to the page.
_NOTE_POSES = (
    """
(() => {
  const Real = window.Worker;
  window.__noting = false;
  window.__poses = {reached: [], drawn: []};
  let newest = null;
  const note = (wxyz, at) => {
    if (newest === null)
      requestAnimationFrame(() => {
        window.__poses.drawn.push([Date.now() / 1000, newest]);
        newest = null;
      });
    newest = 2 * Math.atan2(wxyz[3], wxyz[0]);
    window.__poses.reached.push([at, newest]);
  };
  // The worker says when it passes a batch on: a page that draws takes it later.
  const STAMP = `
    const post = self.postMessage.bind(self);
    self.postMessage = (data, given) =>
      post(data?.type ? {...data, at: Date.now() / 1000} : data, given);
  `;
  URL.revokeObjectURL = () => {};  // it would revoke what the worker has still to load
  window.Worker = class extends Real {
    constructor(url, options) {
      const load = `import ${JSON.stringify(String(url))};`;
      const code = new Blob([load, STAMP], {type: "text/javascript"});
      super(URL.createObjectURL(code), options);
      this.addEventListener("message", ({data}) => {
        if (!window.__noting || data?.type !== "message_batch") return;
        for (const message of data.messages)
          if (message.type === "SetOrientationMessage" && message.name === "NODE")
            note(message.wxyz, data.at);
      });
    }
  };
})();
"""
).replace("NODE", NODE)
_NOTE_RETURN = """
() => {
  const bar = document.getElementById("bar");
  window.__back = null;
  const look = () => {
    const isBack = bar.dataset.link === "live" && !document.body.matches(".stale");
    window.__back = isBack ? (window.__back ?? Date.now() / 1000) : null;
  };
  const options = {attributes: true, attributeFilter: ["class", "data-link"]};
  new MutationObserver(look).observe(bar, options);
  new MutationObserver(look).observe(document.body, options);
}
"""


# All but the filling of pixels: scene, matrices and the calls of the page.
_DRAW_NOTHING = """
for (const name of ["drawArrays", "drawArraysInstanced", "drawElements",
                    "drawElementsInstanced", "drawRangeElements"])
  WebGL2RenderingContext.prototype[name] = function () {};
"""


Row = dict[str, object]


class RunningStation:
    """A station with its dashboard on ports that stay the same.

    Attributes:
        access: What its runtime file says.
        answered_at: When its API was announced after the last start [s], wall clock.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        ports = [_free_port(), _free_port()]
        self._ports = ["--port", str(ports[0]), "--ui-port", str(ports[1])]
        self._process: subprocess.Popen[bytes] | None = None
        self.access: dict[str, str] = {}
        self.answered_at = 0.0

    def start(self) -> None:
        """Start, and wait until station and dashboard answer.

        Raises:
            RuntimeError: The station does not start.
        """
        output = self._folder / "stdout"
        with output.open("wb") as stdout:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "station", "run", "--json", *self._ports],
                env={**os.environ, "XDG_RUNTIME_DIR": str(self._folder)},
                stdout=stdout,
            )
        os.setpriority(os.PRIO_PROCESS, self._process.pid, 0)
        deadline = time.monotonic() + _PATIENCE
        self.answered_at = 0.0
        while len(lines := output.read_text().splitlines()) < 2:
            if lines and not self.answered_at:
                self.answered_at = time.time()
            if self._process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError("the station did not start; see its messages")
            time.sleep(0.02)
        self.answered_at = self.answered_at or time.time()
        self.access = json.loads(Path(json.loads(lines[0])["runtime_file"]).read_text())

    def stop(self, number: signal.Signals = signal.SIGINT) -> None:
        """End the station by a signal."""
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(number)
            self._process.wait(10.0)

    def dashboard_cpu(self) -> float:
        """Return the CPU time that the dashboard has used [s].

        Raises:
            RuntimeError: There is no dashboard.
        """
        stat = Path(f"/proc/{self.dashboard_pid()}/stat").read_text().rpartition(")")[2]
        user, system = stat.split()[11:13]
        return (int(user) + int(system)) / _CLOCK

    def dashboard_pid(self) -> int:
        """Return the process of the dashboard.

        Raises:
            RuntimeError: There is no dashboard.
        """
        for path in Path(self._folder / "station").glob("*.dashboard"):
            return int(path.stem)
        raise RuntimeError("the dashboard has ended")


@dataclass(frozen=True)
class Measured:
    """What was measured with some browsers."""

    loop: LoopReport
    cpu: float
    screens: "list[Screen]"


@dataclass(frozen=True)
class Screen:
    """The poses on one browser's screen.

    Attributes:
        poses: Poses that arrived, per second.
        pictures: Pictures with a new pose, per second.
        reached: How old each pose was when it reached the page [s].
        ages: How old the pose of each picture was when it was drawn [s].
    """

    poses: float
    pictures: float
    reached: NDArray[np.float64]
    ages: NDArray[np.float64]


@dataclass(frozen=True)
class Return:
    """How long a killed station that is started anew takes to be back.

    Attributes:
        station: From its start until its API is announced [s].
        dashboard: From there until the dashboard has its data [s].
        pages: From there until the last page shows it, with joints that move [s].
    """

    station: float
    dashboard: float
    pages: float


def main() -> None:
    """Print the table, or JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--browsers", type=int, default=3)
    parser.add_argument("--json", action="store_true", help="print rows as JSON")
    options = parser.parse_args()
    seconds, count = options.seconds, options.browsers
    with tempfile.TemporaryDirectory() as folder:
        station = RunningStation(Path(folder))
        station.start()
        try:
            rows = _measure_all(station, seconds, count)
        finally:
            station.stop()
    if options.json:
        sys.stdout.write(json.dumps(rows, indent=1) + "\n")
        return
    print_title(f"The dashboard for {seconds:g} s, without and with {count} browsers")
    print_table(list(rows[0]), [list(row.values()) for row in rows])


def _measure_all(station: RunningStation, seconds: float, count: int) -> list[Row]:
    with StationClient(station.access["url"], station.access["token"]) as client:
        client.switch_controllers(start=[CONTROLLER])
        alone = measure(station, client, [], seconds)
        os.setpriority(os.PRIO_PROCESS, 0, NICENESS)  # the browsers inherit it
        with browsers(station.access, count, draws=False) as pages:
            undrawn = measure(station, client, pages, seconds)
        with browsers(station.access, count) as pages:
            watched = measure(station, client, pages, seconds)
            back = come_back(station, pages)
        plots = plot_cost(station.access, seconds)
    late, later = alone.loop.lateness, watched.loop.lateness
    return [
        _row("lateness p50 [us]", late.p50 * 1e6, later.p50 * 1e6),
        _row("lateness p99 [us]", late.p99 * 1e6, later.p99 * 1e6, "1.5 times as late"),
        _row("dashboard [cores]", alone.cpu, watched.cpu, "0.5"),
        *_rows_of_poses("a page that fills no pixels", undrawn.screens, ("100", "30")),
        *_rows_of_poses("a page that draws in software", watched.screens, ("", "")),
        _row("a station started anew: its API answers after [s]", "", back.station),
        _row("the dashboard has it after the API [s]", "", back.dashboard),
        _row("all pages have it after the API [s]", "", back.pages, "3"),
        _row("6 traces of 30 Hz over 30 s, one browser [cores]", "", plots, "0.1"),
    ]


def _row(
    what: str, none: float | str, watched: float | str, asked: str = ""
) -> dict[str, object]:
    return {"what": what, "no browser": none, "browsers": watched, "asked": asked}


def _rows_of_poses(
    where: str, screens: "Sequence[Screen]", asked: tuple[str, str]
) -> list[Row]:
    """Return how old poses are, all browsers together, and how many come."""
    reached = np.concatenate([screen.reached for screen in screens])
    shown = np.concatenate([screen.ages for screen in screens])
    poses = float(np.mean([screen.poses for screen in screens]))
    pictures = float(np.mean([screen.pictures for screen in screens]))
    return [
        _row(f"a pose reaches {where}: age p50, p95 [ms]", "", _percentiles(reached)),
        _row(
            f"it is on the screen of {where}: the same",
            "",
            _percentiles(shown),
            asked[0],
        ),
        _row(
            "poses, pictures per second", "", f"{poses:.0f}, {pictures:.1f}", asked[1]
        ),
    ]


def _percentiles(ages: NDArray[np.float64]) -> str:
    """Return median and p95 in milliseconds."""
    return ", ".join(f"{np.percentile(ages, q) * 1e3:.0f}" for q in (50, 95))


@contextmanager
def chromium() -> Iterator[Browser]:
    """Run Chromium.

    Raises:
        FileNotFoundError: There is none.
    """
    path = shutil.which("chromium") or shutil.which("google-chrome")
    if path is None:
        raise FileNotFoundError("there is no Chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=BROWSER_FLAGS)
        yield browser
        browser.close()


@contextmanager
def browsers(
    access: dict[str, str], count: int, *, draws: bool = True
) -> Iterator[list[Page]]:
    """Open the dashboard in browsers of their own sessions, drawn and ready.

    Args:
        access: What the station's runtime file says.
        count: How many.
        draws: Whether they fill pixels.

    Raises:
        FileNotFoundError: There is no Chromium.
    """
    with chromium() as browser:
        pages = []
        for _ in range(count):
            context = browser.new_context(viewport={"width": 1280, "height": 800})
            context.set_default_timeout(_PATIENCE * 1e3)
            context.add_init_script(_NOTE_POSES)
            if not draws:
                context.add_init_script(_DRAW_NOTHING)
            pages.append(context.new_page())
            pages[-1].goto(f"{access['ui_url']}/login?token={access['token']}")
        for page in pages:
            page.wait_for_selector("#progress", state="hidden")
        yield pages


def plot_cost(access: dict[str, str], seconds: float) -> float:
    """Return what drawing six traces costs a browser [cores].

    The browser's processes are measured with the dock *Plots* open and folded; the
    difference counts. There is no 3D view in that page.
    """
    keys = [f"position/{JOINT[:-1]}{i}" for i in range(1, 7)]
    kept = json.dumps([{"keys": keys, "xy": False, "span": 30}])
    with chromium() as browser:
        page = browser.new_page()
        page.set_default_timeout(_PATIENCE * 1e3)
        page.route("**/ui/", lambda route: route.fulfill(body=""))
        page.add_init_script(f"localStorage['station.plots-2'] = {kept!r};")
        page.goto(f"{access['ui_url']}/login?token={access['token']}")
        page.wait_for_selector('.dock[data-dock="plots"] .plot')
        page.wait_for_timeout(30_000)  # until the traces are full
        drawn = _browser_load(page, seconds)
        page.locator('.dock[data-dock="plots"] .fold').click()
        return drawn - _browser_load(page, seconds)


def _browser_load(page: Page, seconds: float) -> float:
    """Return the CPU time of Chromium's processes over the time of the wall."""
    used, began = _browser_cpu(), time.monotonic()
    page.wait_for_timeout(seconds * 1e3)
    return (_browser_cpu() - used) / (time.monotonic() - began)


def _browser_cpu() -> float:
    """Return the CPU time that the Chromium of this process has used [s]."""
    stats = {}
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # It has ended meanwhile.
            name, _, rest = path.read_text().partition("(")[2].rpartition(")")
            stats[int(path.parent.name)] = (name, rest.split())
    mine, size = {os.getpid()}, 0
    while len(mine) > size:
        size = len(mine)
        mine |= {pid for pid, (_, rest) in stats.items() if int(rest[1]) in mine}
    ticks = sum(
        int(rest[11]) + int(rest[12])
        for pid, (name, rest) in stats.items()
        if pid in mine and name.startswith("chrom")
    )
    return ticks / _CLOCK


def measure(
    station: RunningStation,
    client: StationClient,
    pages: Sequence[Page],
    seconds: float,
) -> Measured:
    """Measure for a while, while the joint turns."""
    _turn(client, 0.0, -SWEEP, SWEEP / SPEED)
    time.sleep(SETTLING)
    _note(pages, is_on=True)
    client.reset_loop_statistics()
    cpu, began = station.dashboard_cpu(), time.monotonic()
    stamps, angles = _turn(client, -SWEEP, SWEEP, seconds)
    took = time.monotonic() - began
    cpu = (station.dashboard_cpu() - cpu) / took
    loop = client.loop()
    time.sleep(SETTLING)
    _note(pages, is_on=False)
    _turn(client, SWEEP, 0.0, SWEEP / SPEED)
    screens = [_screen(page, stamps, angles, took) for page in pages]
    return Measured(loop, cpu, screens)


def _screen(
    page: Page, stamps: NDArray[np.float64], angles: NDArray[np.float64], took: float
) -> Screen:
    """Return what a page has noted.

    Raises:
        RuntimeError: It has noted nothing.
    """
    noted = _scene(page).evaluate("() => window.__poses")
    reached, drawn = (
        np.array(noted[name]).reshape(-1, 2) for name in ("reached", "drawn")
    )
    if not len(drawn):
        raise RuntimeError(f"no pose of {NODE} came: has Viser's page changed?")
    return Screen(
        len(reached) / took,
        len(drawn) / took,
        _ages(reached, stamps, angles),
        _ages(drawn, stamps, angles),
    )


def _turn(
    client: StationClient, begin: float, end: float, seconds: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Turn the joint steadily; return wall times [s] and its angles then [rad]."""
    rest = _here(client)[1:]
    stamps, angles, offset = [], [], np.inf
    began = time.monotonic()
    with client.stream("joint_states", rate=100.0, reconnect=False) as stream:
        for frame in stream:
            offset = min(offset, time.time() - frame.stamp)
            place = frame.data["name"].index(JOINT)
            stamps.append(frame.stamp)
            angles.append(frame.data["position"][place])
            share = min((time.monotonic() - began) / seconds, 1.0)
            if len(stamps) % 4 == 0 or share == 1.0:
                client.command(CONTROLLER, [begin + share * (end - begin), *rest])
            if share == 1.0:
                break
    return np.array(stamps) + offset, np.array(angles)


def _here(client: StationClient) -> list[float]:
    """Return what the joints are told, or else where they are [rad]."""
    joints = client.joint_states()
    told = client.last_command(CONTROLLER).last
    return list(told) if told else [value or 0.0 for value in joints.position[:7]]


def _ages(
    seen: NDArray[np.float64], times: NDArray[np.float64], angles: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return how old each pose was when it was seen [s].

    Near the ends of the way, where the joint does not turn steadily, an angle says
    little and is left out.
    """
    at, angle = seen[np.abs(seen[:, 1]) < 0.9 * SWEEP].T
    then = np.interp(angle, np.maximum.accumulate(angles), times)
    return at - then if len(at) else np.array([np.nan])


def _scene(page: Page) -> Any:  # noqa: ANN401 - Playwright's frame
    return page.query_selector("#view").content_frame()


def _note(pages: Sequence[Page], *, is_on: bool) -> None:
    for page in pages:
        _scene(page).evaluate(f"() => {{ window.__noting = {str(is_on).lower()}; }}")


def come_back(station: RunningStation, pages: Sequence[Page]) -> Return:
    """Kill and start the station; return how long its parts take to be back.

    Raises:
        RuntimeError: The dashboard has ended with its station.
    """
    cookies = {c["name"]: c["value"] for c in pages[0].context.cookies()}
    for page in pages:
        page.evaluate(_NOTE_RETURN)
    address = f"{station.access['ui_url']}/state"
    dashboard = station.dashboard_pid()
    station.stop(signal.SIGKILL)
    _wait_for_link(address, cookies, [], is_live=False)
    seen: list[float] = []
    looking = threading.Thread(target=_wait_for_link, args=(address, cookies, seen))
    looking.start()
    began = time.time()
    station.start()
    looking.join()
    if not seen or station.dashboard_pid() != dashboard:
        raise RuntimeError("the dashboard did not outlive its station")
    # At once: a page on a busy processor may take its data for stale once more.
    page_back = max(
        page.wait_for_function(
            "() => window.__back", timeout=_PATIENCE * 1e3
        ).json_value()
        for page in pages
    )
    answered = station.answered_at
    return Return(answered - began, seen[0] - answered, page_back - answered)


def _wait_for_link(
    address: str, cookies: dict[str, str], seen: list[float], *, is_live: bool = True
) -> None:
    """Note when the dashboard says that it has the station's data, or has none."""
    deadline = time.monotonic() + _PATIENCE
    with httpx.Client(cookies=cookies, trust_env=False) as client:
        while time.monotonic() < deadline:
            with contextlib.suppress(httpx.TransportError):
                if (client.get(address).json()["link"] == "live") is is_live:
                    seen.append(time.time())
                    return
            time.sleep(0.02)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


if __name__ == "__main__":
    main()
