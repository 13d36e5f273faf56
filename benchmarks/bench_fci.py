"""How many commands of an unmodified libfranka arrive in time at the simulated arm.

Run `python benchmarks/bench_fci.py [--seconds 600]` on a machine that does nothing
else, after `make setup`, which brings panda-python with libfranka 0.9.2 in it. The
server is `station fci` with its default, which waits for no command; the client is a
process that lets two joints swing under panda-python's impedance controller
(`RealtimeConfig.kIgnore`).
"""

import argparse
import importlib.util
import json
import math
import re
import subprocess
import sys
import time
from pathlib import Path

from measuring import print_table, print_title

HOST = "127.0.0.77"
PERIOD = 0.02
"""Time between two set-points of the client [s]."""
AMPLITUDE = 0.2
"""How far the joints swing [rad]."""
_COUNTS = re.compile(
    r"(\d+) cycles in ([\d.]+) s; (\d+) of them commanded by clients, (\d+) commands"
)


def swing(seconds: float) -> dict[str, object]:
    """Be the client: let the arm swing, and return what it said.

    Args:
        seconds: How long [s].
    """
    import numpy as np
    from panda_py import Panda, controllers

    panda = Panda(HOST)
    start, lowest, error = panda.q, 1.0, ""
    controller = controllers.JointPosition()
    panda.start_controller(controller)
    began = time.monotonic()
    while (passed := time.monotonic() - began) < seconds:
        offset = AMPLITUDE * math.sin(passed) * min(1.0, passed)
        controller.set_control(start + np.array([offset, 0, 0, 0, 0, offset, 0]))
        state = panda.get_state()
        if passed > 1.0:
            lowest = min(lowest, state.control_command_success_rate)
        try:
            panda.raise_error()
        except RuntimeError as caught:
            error = str(caught)
            break
        time.sleep(PERIOD)
    panda.stop_controller()
    return {"lowest": lowest, "error": error, "lasted": time.monotonic() - began}


def measure(seconds: float) -> None:
    """Run server and client, and print what they counted.

    Args:
        seconds: How long the arm is commanded [s].

    Raises:
        SystemExit: The server has not said what it counted.
    """
    command = [sys.executable, "-m", "station", "fci", "--host", HOST]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        granted = server.stdout.readline().strip() if server.stdout else ""
        client = subprocess.run(
            [sys.executable, str(Path(__file__)), "--client", f"--seconds={seconds}"],
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
    finally:
        server.terminate()
        said, _ = server.communicate()
    seen = json.loads(client.stdout)
    counted = _COUNTS.search(said)
    if counted is None:
        raise SystemExit(f"The server did not count: {said}")
    commanded, lost = int(counted[3]), int(counted[4])
    print_title(granted)
    print_table(
        ["commanded [s]", "commands", "lost", "arrived", "lowest rate", "ended by"],
        [
            [
                f"{seen['lasted']:.0f}",
                commanded,
                lost,
                f"{1.0 - lost / max(1, commanded):.4%}",
                f"{seen['lowest']:.2f}",
                seen["error"] or "its client",
            ]
        ],
    )


def main() -> None:
    """Parse the command line and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--client", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if importlib.util.find_spec("panda_py") is None:
        sys.stdout.write("panda-python is not installed: make setup\n")
    elif options.client:
        sys.stdout.write(json.dumps(swing(options.seconds)))
    else:
        measure(options.seconds)


if __name__ == "__main__":
    main()
