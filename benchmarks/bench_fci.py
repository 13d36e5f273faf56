"""How many commands of an unmodified libfranka arrive in time at the simulated arm.

Run `python benchmarks/bench_fci.py [--seconds 600] [--client pylibfranka]
[--beside-station]` on a machine that does nothing else, after `make setup`, which
brings both clients: panda-python with libfranka 0.9.2 in it, and the maker's own
pylibfranka. The server is `station fci` with its default, which waits for no command,
or `station run` with its dashboard; the client is a process that lets two joints swing
(`RealtimeConfig.kIgnore`), panda-python under its own impedance controller,
pylibfranka under torques that this file computes.

Both are counted by the success rate that the arm tells in its states, every 100
cycles. pylibfranka sees every state, and so the states that it has missed as well.
"""

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from measuring import print_table, print_title

HOST = "127.0.0.77"
PERIOD = 0.02
"""Time between two set-points of panda-python [s]."""
AMPLITUDE = 0.2
"""How far the joints swing [rad]."""
WINDOW = 100
"""Cycles of which the success rate tells the part that brought a command."""
SLOW = 0.5e-3
"""Time from a state to its answer above which the client itself is slow [s]."""
_START = 60.0
# Ideal: else the simulated network loses a command of a thousand by itself.
_CONFIG = """
fci: {{enabled: {is_beside}, host: {host}}}
robot: {{type: franka_hw/FrankaHW, arm: {arm}, realism: ideal}}
"""


@dataclass
class Tally:
    """The counts of a client.

    Attributes:
        cycles: Cycles of the arm that were commanded.
        lost: How many of them had no command.
        lowest: Lowest success rate.
        missed: How often so many states in a row were missed; pylibfranka alone.
        own: In how many of these cases the client itself had been slow.
        error: The error that ended a motion; empty without one.
    """

    cycles: int = 0
    lost: float = 0.0
    lowest: float = 1.0
    missed: Counter[int] = field(default_factory=Counter)
    own: int = 0
    error: str = ""
    _last: int = -1

    def note(self, cycle: int, rate: float) -> None:
        """Count what a state tells.

        Args:
            cycle: Its cycle.
            rate: Its success rate.
        """
        if self._last < 0:
            self._last = cycle
        passed = cycle - self._last
        if passed >= WINDOW:
            self.cycles, self._last = self.cycles + passed, cycle
            self.lost += (1.0 - rate) * passed
            self.lowest = min(self.lowest, rate)


def swing(passed: float) -> list[float]:
    """Return the joints' way at a time [s] since the beginning [rad], shape (7,)."""
    way = AMPLITUDE * math.sin(passed) * min(1.0, passed)
    return [way, 0.0, 0.0, 0.0, 0.0, way, 0.0]


def run_panda_python(seconds: float, tally: Tally) -> None:
    """Let the arm swing under panda-python's impedance controller.

    Args:
        seconds: How long [s].
        tally: The counts.
    """
    from panda_py import Panda, controllers

    panda = Panda(HOST)
    start = panda.q
    controller = controllers.JointPosition()
    panda.start_controller(controller)
    began = time.monotonic()
    while (passed := time.monotonic() - began) < seconds:
        controller.set_control(start + swing(passed))
        state = panda.get_state()
        tally.note(state.time.to_msec(), state.control_command_success_rate)
        try:
            panda.raise_error()
        except RuntimeError as caught:
            tally.error = str(caught)
            break
        time.sleep(PERIOD)
    panda.stop_controller()


def run_pylibfranka(seconds: float, tally: Tally) -> None:
    """Let the arm swing under torques; see `run_panda_python`."""
    import pylibfranka

    robot = pylibfranka.Robot(HOST, pylibfranka.RealtimeConfig.kIgnore)
    control = robot.start_torque_control()
    state, _ = control.readOnce()
    start, cycle, passed = state.q_d, round(state.time.to_sec() * 1e3), 0.0
    begin, is_over, read = cycle, False, time.perf_counter()
    stiffness, damping = [200.0] * 4 + [50.0] * 3, [20.0] * 4 + [5.0] * 3
    while not is_over:
        soft = min(1.0, 4.0 * passed)
        values = zip(
            stiffness, damping, start, swing(passed), state.q, state.dq, strict=True
        )
        command = pylibfranka.Torques([
            soft * (k * (q0 + way - q) - d * dq) for k, d, q0, way, q, dq in values
        ])
        is_over = command.motion_finished = passed >= seconds
        control.writeOnce(command)
        if is_over:
            return
        is_slow = time.perf_counter() - read > SLOW
        try:
            state, _ = control.readOnce()
        except pylibfranka.ControlException as caught:
            tally.error = str(caught)
            return
        read, before = time.perf_counter(), cycle
        cycle = round(state.time.to_sec() * 1e3)
        passed = (cycle - begin) * 1e-3
        tally.note(cycle, state.control_command_success_rate)
        if missed := cycle - before - 1:
            tally.missed[missed] += 1
            tally.own += is_slow


_ARMS = {"panda-python": "panda", "pylibfranka": "fr3"}
CLIENTS = {"panda-python": run_panda_python, "pylibfranka": run_pylibfranka}


def connect(client: str, seconds: float) -> Tally:
    """Be the client: wait for the server, let the arm swing, and return the counts.

    Args:
        client: Its name.
        seconds: How long [s].
    """
    tally, deadline = Tally(), time.monotonic() + _START
    while True:
        try:
            CLIENTS[client](seconds, tally)
        except Exception:  # both have errors of their own for a server that starts
            if tally.cycles or time.monotonic() > deadline:
                raise
            time.sleep(1.0)
        else:
            return tally


def commands(options: argparse.Namespace, folder: Path) -> Iterator[list[str]]:
    """Yield the command of the server, and that of the client."""
    station = [sys.executable, "-m", "station"]
    config = folder / "station.yaml"
    is_beside, arm = options.beside_station, _ARMS[options.client]
    text = _CONFIG.format(host=HOST, is_beside=str(is_beside).lower(), arm=arm)
    config.write_text(text, encoding="utf-8")
    if is_beside:
        yield [*station, "run", str(config), "--port=0", "--ui-port=0"]
    else:
        yield [*station, "fci", str(config), "--host", HOST]
    more = [f"--seconds={options.seconds}", f"--client={options.client}"]
    yield [sys.executable, str(Path(__file__)), "--connect", *more]


def measure(options: argparse.Namespace) -> None:
    """Run server and client, and print what was counted."""
    with tempfile.TemporaryDirectory() as folder:
        serve, ask = commands(options, Path(folder))
        server = subprocess.Popen(serve, stdout=subprocess.DEVNULL)
        try:
            said = subprocess.run(ask, stdout=subprocess.PIPE, text=True, check=True)
        finally:
            server.terminate()
            server.wait()
    seen = json.loads(said.stdout)
    where = "station run" if options.beside_station else "station fci"
    print_title(f"{options.client} at {where}")
    in_time = 1.0 - seen["lost"] / max(1, seen["cycles"])
    print_table(
        ["commanded", "cycles", "lost", "in time", "lowest rate", "ended by"],
        [
            [
                f"{seen['cycles'] / 1e3:.0f} s",
                seen["cycles"],
                round(seen["lost"]),
                f"{in_time:.3%}",
                f"{seen['lowest']:.2f}",
                seen["error"] or "its client",
            ]
        ],
    )
    if options.client == "pylibfranka":
        missed = sorted((int(n), count) for n, count in seen["missed"].items())
        print_table(["states missed in a row", "how often"], missed)
        sys.stdout.write(f"after a slow step of the client itself: {seen['own']}\n")


def main() -> None:
    """Parse the command line and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--client", choices=CLIENTS, default="panda-python")
    parser.add_argument("--beside-station", action="store_true")
    parser.add_argument("--connect", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.connect:
        tally = connect(options.client, options.seconds)
        sys.stdout.write(json.dumps(vars(tally)))
    else:
        measure(options)


if __name__ == "__main__":
    main()
