"""Check whether this machine is fit for a control station."""

import os
import platform
import shutil
import socket
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from station.compiled import present_status
from station.core.installation import install_command
from station.core.scheduling import realtime_interpreter, request_realtime_priority
from station.local.descriptors import most_files, shortage

PERIOD = 0.001
"""Period of the trial loop [s]."""
GOOD_LATENESS, FAIR_LATENESS = 0.0003, 0.001
"""Largest p99 of the lateness of wake-ups of a good and of a fair clock [s]."""
_PACKAGES = ("numpy", "mujoco", "fastapi", "uvicorn", "viser")
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "firefox")
_GOVERNOR = Path("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")


@dataclass(frozen=True, slots=True)
class Finding:
    """Result of a check.

    Attributes:
        check: Subject of the check.
        state: `ok`, `warning` (works, with a drawback) or `problem` (does not work).
        finding: Observation, in one sentence.
        advice: Advice to the user; empty when all is well.
    """

    check: str
    state: str
    finding: str
    advice: str = ""


def check_python() -> Finding:
    """Report the interpreter, and whether it has a global lock."""
    is_locked = getattr(sys, "_is_gil_enabled", lambda: True)()
    name = f"{platform.python_implementation()} {platform.python_version()}"
    lock = "with" if is_locked else "without"
    return Finding("Python", "ok", f"{name}, {lock} interpreter lock")


def check_processors() -> Finding:
    """Check how many processors may be used."""
    count = len(os.sched_getaffinity(0))
    if count < 2:
        return Finding(
            "processors",
            "warning",
            str(count),
            "Give it two: the control loop and everything else share this one.",
        )
    return Finding("processors", "ok", str(count))


def check_governor(path: Path = _GOVERNOR) -> Finding:
    """Check whether the processor slows down when it has little to do."""
    try:
        governor = path.read_text(encoding="ascii").strip()
    except OSError:
        return Finding("frequency governor", "ok", "none to be seen")
    if governor == "powersave":
        advice = "cpupower frequency-set -g performance: it wakes up faster."
        return Finding("frequency governor", "warning", governor, advice)
    return Finding("frequency governor", "ok", governor)


def check_scheduler() -> Finding:
    """Check whether a thread is granted SCHED_FIFO."""
    granted: list[str] = []
    thread = threading.Thread(
        target=lambda: granted.append(request_realtime_priority())
    )
    thread.start()
    thread.join()
    if granted[0].startswith("SCHED_FIFO"):
        return Finding("scheduler", "ok", granted[0])
    return Finding(
        "scheduler",
        "warning",
        granted[0],
        "`ulimit -r 50`, an rtprio line in /etc/security/limits.conf, or CAP_SYS_NICE: "
        "else cycles are late when the machine is busy.",
    )


def check_clock(cycles: int = 1000) -> Finding:
    """Check how late a thread of 1 kHz wakes up.

    Args:
        cycles: Number of wake-ups to measure, >= 1.
    """
    lateness: list[float] = []
    thread = threading.Thread(target=_wake_up, args=(cycles, lateness))
    with realtime_interpreter():
        thread.start()
        thread.join()
    lateness.sort()
    p99 = lateness[int(0.99 * (len(lateness) - 1))]
    median, worst = lateness[len(lateness) // 2], lateness[-1]
    finding = (
        f"wakes {median * 1e3:.2f} ms late, p99 {p99 * 1e3:.2f} ms, "
        f"worst {worst * 1e3:.2f} ms"
    )
    if p99 < GOOD_LATENESS:
        return Finding("clock", "ok", finding)
    advice = "Allow SCHED_FIFO, end busy programs, or lower the rate: --rate 500."
    return Finding(
        "clock", "warning" if p99 < FAIR_LATENESS else "problem", finding, advice
    )


def _wake_up(cycles: int, lateness: list[float]) -> None:
    request_realtime_priority()
    deadline = time.monotonic()
    for _ in range(cycles):
        deadline = max(deadline + PERIOD, time.monotonic())
        time.sleep(max(0.0, deadline - time.monotonic()))
        lateness.append(max(0.0, time.monotonic() - deadline))


def check_descriptors() -> Finding:
    """Check how many files, and so how many connections, a station may open."""
    most, few = most_files(), shortage()
    found = "as many as wanted" if most is None else str(most)
    if few is None:
        return Finding("open files", "ok", found)
    return Finding("open files", "warning", found, few)


def check_packages() -> Finding:
    """Check the packages a station needs."""
    found, missing = [], []
    for name in _PACKAGES:
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            missing.append(name)
    if missing:
        absent = f"missing: {', '.join(missing)}"
        advice = f"Install what a station needs: {install_command('all')}"
        return Finding("packages", "problem", absent, advice)
    return Finding("packages", "ok", ", ".join(found))


def check_extensions() -> Finding:
    """Report whether the control cycle runs compiled."""
    status = present_status()
    if status.is_compiled or status.is_forced:
        return Finding("control cycle", "ok", status.text())
    advice = "The station works, and each cycle takes longer than it would compiled."
    return Finding("control cycle", "warning", status.text(), advice)


def check_browser() -> Finding:
    """Check for a browser, which users of the dashboard and its tests need."""
    for name in _BROWSERS:
        if shutil.which(name):
            return Finding("browser", "ok", name)
    advice = "Open the dashboard from elsewhere; for its tests install chromium."
    return Finding("browser", "warning", "none was found", advice)


def check_port(port: int) -> Finding:
    """Check whether a port is free on this machine."""
    name = f"port {port}"
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError as error:
            advice = "A station may be running already; --port and --ui-port take 0."
            return Finding(name, "warning", f"{error.strerror}", advice)
    return Finding(name, "ok", "free")


CHECKS: tuple[Callable[[], Finding], ...] = (
    check_python,
    check_packages,
    check_extensions,
    check_processors,
    check_governor,
    check_scheduler,
    check_descriptors,
    check_clock,
    check_browser,
    lambda: check_port(8000),
    lambda: check_port(8080),
)
