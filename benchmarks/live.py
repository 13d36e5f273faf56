"""A whole station in processes of its own, and what loads it: streams and browsers."""

import asyncio
import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

from station.client import AsyncStationClient

RATE = 100.0
"""Rate of a stream [Hz]."""
BROWSER_FLAGS = [
    "--no-sandbox",
    "--use-gl=swiftshader",
    "--enable-unsafe-swiftshader",
]
"""Arguments of Chromium: it draws in software, also where there is a GPU."""
NICENESS = 10
"""Niceness of browsers: drawing in software must not decide what is measured."""
SETTLING = 3.0
"""How long a loop runs before it is measured [s]: clients connect in the first two."""
PATIENCE = 120.0
"""How long station and dashboard may take to start [s]."""


@contextlib.contextmanager
def running_station(
    *arguments: str, has_dashboard: bool = True
) -> Iterator[dict[str, str]]:
    """Run a station; yield what its runtime file says once all of it answers.

    Args:
        arguments: More arguments of `station run`.
        has_dashboard: Whether it has a dashboard.

    Raises:
        RuntimeError: It does not start.
    """
    command = [sys.executable, "-m", "station", "run", "--json", "--port", "0"]
    ui = ["--ui-port", "0"] if has_dashboard else ["--no-ui"]
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / "stdout"
        with output.open("w") as stdout:
            process = subprocess.Popen(
                [*command, *ui, *arguments],
                env={**os.environ, "XDG_RUNTIME_DIR": folder},
                stdout=stdout,
            )
        if os.getpriority(os.PRIO_PROCESS, process.pid) > 0:
            os.setpriority(os.PRIO_PROCESS, process.pid, 0)
        try:
            # One line when the API answers, one more when the dashboard does.
            deadline = monotonic() + PATIENCE
            while len(lines := output.read_text().splitlines()) < 1 + has_dashboard:
                if process.poll() is not None or monotonic() > deadline:
                    raise RuntimeError("the station did not start; see its messages")
                sleep(0.1)
            path = Path(json.loads(lines[0])["runtime_file"])
            yield json.loads(path.read_text())
        finally:
            _end(process)


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a station, and leave none behind: whoever reads its output would wait."""
    process.terminate()
    try:
        process.wait(20.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


async def read_streams(url: str, token: str, clients: int, seconds: float) -> list[int]:
    """Read as many streams for a while; return how many frames each one got."""

    async def read(client: AsyncStationClient) -> int:
        frames = 0
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                async for _ in client.stream("joint_states", rate=RATE):
                    frames += 1
        return frames

    async with AsyncStationClient(url, token) as client:
        return await asyncio.gather(*(read(client) for _ in range(clients)))


@contextlib.contextmanager
def browsers(access: dict[str, str], count: int) -> Iterator[None]:
    """Let browsers look at the dashboard of a station, each with its own profile.

    This process is as nice as they are from then on, since they inherit it.

    Args:
        access: What the station's runtime file says.
        count: How many.

    Raises:
        ImportError: Playwright, a package of the tests, is not installed.
        FileNotFoundError: There is no browser.
    """
    from playwright.sync_api import sync_playwright

    path = shutil.which("chromium") or shutil.which("google-chrome")
    if path is None:
        raise FileNotFoundError("there is no Chromium")
    os.setpriority(os.PRIO_PROCESS, 0, NICENESS)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=BROWSER_FLAGS)
        for _ in range(count):
            page = chromium.new_context().new_page()
            page.goto(f"{access['ui_url']}/login?token={access['token']}")
        yield
        chromium.close()
