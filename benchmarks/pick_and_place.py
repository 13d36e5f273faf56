"""Pick a cube and place it, over REST alone, from random start poses of the arm.

Run `python benchmarks/pick_and_place.py [--poses 50] [--seed 1] [--factor 2]`. It
starts a station with a cube, as `station run` does, and drives it by the client of this
project, which speaks REST. Each trial resets the world with the arm at a seeded pose,
picks the cube, and places it at a seeded place. It succeeds when the cube lies within
2 cm of that place. At least 96 % should, and none may take longer than 60 s.
"""

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path
from time import monotonic, sleep

from station.client import ApiError, Pose, StationClient

ROOT = Path(__file__).parents[1]
READY = (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785)
NEAR = 0.02
"""How far from its place the cube may lie [m]."""
DOWN = (1.0, 0.0, 0.0, 0.0)
PATIENCE = 60.0


def run_trial(station: StationClient, chance: random.Random) -> str:
    """Pick and place once; return what went wrong, empty for nothing."""
    pose = {
        f"panda_joint{number}": angle + chance.uniform(-0.3, 0.3)
        for number, angle in enumerate(READY, 1)
    }
    place = (chance.uniform(0.35, 0.55), chance.uniform(-0.3, 0.3))
    try:
        station.simulation.reset(pose)
        arm = station.robot()
        arm.gripper.open()
        station.move_to("ready")
        for height in (0.2, 0.02):
            station.move_to(Pose((0.5, 0.0, height), DOWN))
        arm.gripper.close()
        station.move_to(Pose((0.5, 0.0, 0.2), DOWN))
        for height in (0.2, 0.025):
            station.move_to(Pose((*place, height), DOWN))
        arm.gripper.open()
        station.move_to(Pose((*place, 0.2), DOWN))
    except (ApiError, TimeoutError) as error:
        return str(error)
    x, y, z = (value or 0.0 for value in station.scene()[0].position)
    missed = max(abs(x - place[0]), abs(y - place[1]))
    return (
        "" if missed < NEAR and z < 0.03 else f"the cube is at {x:.2f} {y:.2f} {z:.2f}"
    )


def main() -> int:
    """Run the trials; 1 if fewer than 96 % succeed or one hangs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--poses", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--factor", type=float, default=1.0)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "XDG_RUNTIME_DIR": folder}
        out = Path(folder, "stdout")
        command = [sys.executable, "-m", "station", "run", "--json", "--port", "0"]
        command += ["--no-ui", "--real-time-factor", str(options.factor)]
        with out.open("w") as file:
            process = subprocess.Popen(
                [*command, str(ROOT / "examples/cube.yaml")],
                env=environment,
                stdout=file,
            )
        try:
            results = _run_all(out, options.poses, chance, process)
        finally:
            process.terminate()
            process.wait(30)
    good = sum(not problem for problem, _ in results)
    longest = max(seconds for _, seconds in results)
    for number, (problem, _) in enumerate(results):
        if problem:
            sys.stdout.write(f"trial {number}: {problem}\n")
    sys.stdout.write(f"{good} of {len(results)} succeed, longest {longest:.1f} s\n")
    return int(good < 0.96 * len(results) or longest > PATIENCE)


def _run_all(
    out: Path, count: int, chance: random.Random, process: "subprocess.Popen[bytes]"
) -> list[tuple[str, float]]:
    """Return what went wrong in each trial, and how long it took [s]."""
    deadline = monotonic() + 90.0
    while not out.read_text().strip():
        if process.poll() is not None or monotonic() > deadline:
            sys.exit("the station does not start")
        sleep(0.1)
    access = json.loads(
        Path(json.loads(out.read_text().splitlines()[0])["runtime_file"]).read_text()
    )
    results = []
    with StationClient(access["url"], token=access["token"]) as station:
        for _ in range(count):
            begin = monotonic()
            results.append((run_trial(station, chance), monotonic() - begin))
    return results


if __name__ == "__main__":
    sys.exit(main())
