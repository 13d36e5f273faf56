"""What a cycle costs elsewhere: robosuite, gymnasium-robotics, plain MuJoCo in Python.

Run `python benchmarks/bench_peers.py [--json]`. Each program is installed from PyPI
into an environment of its own below `build/peers`, on the version of MuJoCo that it
supports, and measured as bench_cycle.py measures the station: whole cycles in turns
with bare steps of the same model on the same MuJoCo. Cycles are counted per step of the
simulation. A program that cannot be installed is left out.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import venv
from dataclasses import dataclass
from pathlib import Path

import mujoco
from cycle_scenarios import make_panda
from measuring import print_table, print_title, simulated_world

FOLDER = Path(__file__).parent
ENVIRONMENTS = FOLDER.parent / "build" / "peers"
INDEX = "https://pypi.org/simple"


@dataclass(frozen=True, slots=True)
class Peer:
    """A program to compare with.

    Attributes:
        name: How it is called.
        script: What measures it, below `benchmarks/peers`.
        requirements: What is installed for it; nothing where the station's own
            environment has it.
    """

    name: str
    script: str
    requirements: tuple[str, ...] = ()


PEERS = (
    Peer("MuJoCo", "mujoco_peer.py"),
    Peer("robosuite", "robosuite_peer.py", ("robosuite==1.5.2", "mujoco==3.3.2")),
    Peer(
        "gymnasium-robotics",
        "gymnasium_robotics_peer.py",
        ("gymnasium-robotics==1.4.2", "mujoco==3.3.2"),
    ),
)


def environment_of(peer: Peer) -> Path:
    """Return the interpreter of a program's environment; make the environment first.

    Raises:
        CalledProcessError: The program cannot be installed.
    """
    if not peer.requirements:
        return Path(sys.executable)
    folder = ENVIRONMENTS / peer.name
    python = folder / "bin" / "python"
    installed = folder / "installed.txt"
    wanted = "\n".join(peer.requirements)
    if installed.is_file() and installed.read_text() == wanted:
        return python
    sys.stderr.write(f"{peer.name}: installing {', '.join(peer.requirements)}\n")
    venv.create(folder, clear=True, with_pip=True)
    pip = [python, "-m", "pip", "install", "--quiet", "--index-url", INDEX]
    subprocess.run([*pip, *peer.requirements], check=True, stdout=sys.stderr)
    installed.write_text(wanted)
    return python


def measure(peer: Peer, model: Path, start: str) -> list[dict[str, object]]:
    """Return the rows of a program.

    Args:
        peer: The program.
        model: The compiled model of the Panda.
        start: Where its joints start, as JSON.

    Raises:
        CalledProcessError: It cannot be installed, or does not run.
    """
    command = [environment_of(peer), FOLDER / "peers" / peer.script, model, start]
    environment = {**os.environ, "PYTHONPATH": str(FOLDER)}
    result = subprocess.run(
        command, env=environment, stdout=subprocess.PIPE, text=True, check=True
    )
    # The rows are the last line; what a program prints at its start comes before.
    return json.loads(result.stdout.splitlines()[-1])


def main() -> None:
    """Print the table, or JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    names = [peer.name for peer in PEERS]
    parser.add_argument("--peers", nargs="+", choices=names, default=names)
    parser.add_argument("--json", action="store_true", help="print rows as JSON")
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "panda.mjb"
        world = simulated_world(make_panda())
        mujoco.mj_saveModel(world.model, str(model), None)
        start = json.dumps(world.data.qpos.tolist())
        for peer in PEERS:
            if peer.name not in options.peers:
                continue
            try:
                rows += measure(peer, model, start)
            except (subprocess.CalledProcessError, OSError) as error:
                sys.stderr.write(f"{peer.name} is left out: {error}\n")
    if options.json:
        sys.stdout.write(json.dumps(rows, indent=1) + "\n")
        return
    print_title("One cycle over one step of the simulation elsewhere [us]")
    print_table(list(rows[0]), [list(row.values()) for row in rows])


if __name__ == "__main__":
    main()
