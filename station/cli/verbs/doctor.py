"""Verbs `doctor` and `validate`: check this machine, and a robot."""

import os
import platform
import shutil
import socket
import sys
import threading
import time
from argparse import Namespace
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.output import answer_table, say, say_progress
from station.cli.parser import ROBOT, add_base
from station.compiled import present_status
from station.core.installation import install_command
from station.core.scheduling import realtime_interpreter, request_realtime_priority
from station.local.descriptors import most_files, shortage

if TYPE_CHECKING:
    from station.cli.parser import Parser

PERIOD = 0.001
"""Period of the trial loop [s]."""
GOOD_LATENESS, FAIR_LATENESS = 0.0003, 0.001
"""Largest p99 of the lateness of wake-ups of a good and of a fair clock [s]."""
_PACKAGES = ("numpy", "mujoco", "fastapi", "uvicorn", "viser")
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "firefox")
_GOVERNOR = Path("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")


def add_doctor(parser: "Parser") -> None:
    """Add the arguments of `doctor`."""
    parser.add_argument(
        "robot", nargs="?", metavar="ROBOT", help=f"look at this robot: {ROBOT}"
    )
    add_base(parser)


def doctor(options: Namespace) -> int:
    """Print findings and advice; return 1 when a station cannot run here."""
    if options.robot is not None:
        return _examine(options)
    findings = [check() for check in CHECKS]
    rows = [[f.check, f.state, f.finding] for f in findings]
    answer_table(options, findings, ["check", "state", "finding"], rows)
    for finding in () if options.json else findings:
        if finding.advice:
            say(f"{finding.check}: {finding.advice}")
    return int(any(finding.state == "problem" for finding in findings))


def _examine(options: Namespace) -> int:
    """Print the differences of a simulated robot from its description.

    Raises:
        RobotDescriptionError: The robot is unknown or cannot be simulated.
    """
    from station.app.any_robot import examine_robot
    from station.app.panda_fetch import fetch_what_is_missing

    fetch_what_is_missing({"robot_description": options.robot}, say_progress)
    repairs = examine_robot(options.robot, options.base)
    headers = ["element", "what is wrong", "was", "now"]
    rows = [[r.element, r.problem, r.old or "-", r.new] for r in repairs]
    nothing = "This robot is simulated as it is described."
    return answer_table(options, repairs, headers, rows, nothing)


CONFIGURATIONS = frozenset({".yaml", ".yml"})
"""Endings of files that configure a station; everything else names a robot."""


def add_validate(parser: "Parser") -> None:
    """Add the arguments of `validate`."""
    add = parser.add_argument
    add(
        "robot",
        metavar="ROBOT",
        help="example-robot-data:NAME, a URDF, or the configuration of a station",
    )
    add_base(parser)
    add(
        "controllers",
        nargs="*",
        default=[],
        type=Path,
        metavar="ROS_PARAMS.yaml",
        help="parameter files written for ROS",
    )
    add("--page", type=Path, metavar="FILE.html", help="write the scorecard as a page")


def validate(options: Namespace) -> int:
    """Check a robot and its controllers."""
    from station.experiments.validation import validate as check_robot
    from station.trials.trial import Setup

    config = Path(options.robot)
    if config.suffix in CONFIGURATIONS:
        setup = Setup.load(config, controllers=options.controllers)
    else:
        setup = Setup.load(_robot_of(options), controllers=options.controllers)
    card = check_robot(setup, config.name)
    if options.page is not None:
        options.page.write_text(card.to_html(), encoding="utf-8")
    rows = [[check.name, check.outcome, check.detail] for check in card.checks]
    answer_table(options, card.checks, ["check", "outcome", "what was seen"], rows)
    return 0 if card.is_good else 1


def _robot_of(options: Namespace) -> dict[str, object]:
    """Return the configuration of a robot that is given by its URDF only.

    It has the controllers of `run --robot`, unless files of controllers are given.

    Raises:
        RobotDescriptionError: The robot is unknown or cannot be simulated.
    """
    from station.app.any_robot import configure_robot
    from station.app.panda_fetch import fetch_what_is_missing
    from station.core.description.robot_files import PACKAGE_SCHEME

    reference = options.robot
    if not reference.startswith(PACKAGE_SCHEME):
        reference = str(Path(reference).resolve())
    fetch_what_is_missing({"robot_description": reference}, say_progress)
    found = configure_robot(reference, options.base)
    return {"robot": found["robot"]} if options.controllers else found


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
