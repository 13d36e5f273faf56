"""What several arms in one world cost, and whether 200 random switches go well.

Run `python benchmarks/bench_arms.py [--arms 1 2 4] [--switches 200] [--seed 1]`. The
cycle is stepped, without deadlines. For the cost, every arm holds a position controller
of its own, and the step of MuJoCo alone is timed beside the cycles, in the same world;
low quantiles of the thread's processor time count, so that the figures hold on a
machine that is busy with other things as well. The switches are between the example
controllers of one arm: after each of them the motion is watched for some cycles. No arm
may raise an error, and no joint may exceed its limits of velocity or jump between two
cycles.
"""

import argparse
import logging
import random
import sys
from collections.abc import Callable
from copy import copy
from pathlib import Path
from time import thread_time

import mujoco
import numpy as np
from measuring import print_table, print_title, simulated_world

from station.app.composition import compose
from station.config import load_config
from station.core import StationError, SwitchRequest
from station.core.facade.station import Station

EXAMPLES = Path(__file__).parents[1] / "examples/franka_examples.yaml"
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
TOLERANCE = 1.02
"""Share of a velocity limit up to which two cycles may differ."""
BLOCKS, CYCLES = 40, 100
QUANTILE = 0.2
WATCHED = (20, 400)
"""Fewest and most cycles after a switch."""


def make_arms(count: int) -> Station:
    """Return a station with some arms in one world, each with its own controller."""
    names = [f"panda_{number + 1}" for number in range(count)]
    robot: dict[str, object] = {
        "type": "franka_hw/FrankaCombinedHW",
        "robot_hardware": names,
    }
    controllers: dict[str, dict[str, object]] = {}
    for number, name in enumerate(names):
        joints = [f"{name}_joint{joint}" for joint in range(1, 8)]
        robot[name] = {
            "type": "franka_hw/FrankaCombinableHW",
            "arm_id": name,
            "robot_description": "example-robot-data:panda",
            "base_xyz": [0.0, 1.2 * number, 0.0],
        }
        # Two arms are combined by torques; see franka_hw/FrankaCombinedHW.
        controllers[f"{name}_controller"] = {
            "type": "effort_controllers/JointGroupPositionController",
            "joints": joints,
            **{joint: {"pid": {"p": 300, "i": 0, "d": 20}} for joint in joints},
        }
    config = load_config({"robot": robot, "controllers": controllers, "start": []})
    station = compose(config).station
    station.loop.step(100)
    station.switch_controllers(SwitchRequest(start=tuple(controllers)))
    station.loop.step(500)
    return station


def cost(station: Station) -> tuple[float, float]:
    """Return what a cycle costs, and MuJoCo's step, low quantiles of blocks [us]."""
    model = simulated_world(station).model
    data = copy(simulated_world(station).data)
    cycles, steps = [], []
    for _ in range(BLOCKS):
        cycles.append(_time(lambda: station.loop.step(CYCLES)))
        steps.append(_time(lambda: mujoco.mj_step(model, data, CYCLES)))
    return float(np.quantile(cycles, QUANTILE)), float(np.quantile(steps, QUANTILE))


def _time(cycles: Callable[[], None]) -> float:
    begin = thread_time()
    cycles()
    return (thread_time() - begin) / CYCLES * 1e6


def switch_at_random(count: int, seed: int) -> list[str]:
    """Switch between the example controllers; return what went wrong.

    Args:
        count: Number of switches.
        seed: Seed of the order and of the pauses.
    """
    station = compose(load_config(EXAMPLES)).station
    chance = random.Random(seed)
    names = [c.name for c in station.controllers() if c.claimed_resources]
    problems: list[str] = []
    running: tuple[str, ...] = ()
    station.loop.step(100)
    for number in range(count):
        wanted = chance.choice([name for name in names if name not in running])
        request = SwitchRequest(start=(wanted,), stop=running)
        try:
            station.switch_controllers(request)
        except StationError as error:
            problems.append(f"switch {number} to {wanted}: {error.message}")
            continue
        running = (wanted,)
        problem = _watch(station, chance.randint(*WATCHED))
        if problem:
            problems.append(f"switch {number} to {wanted}: {problem}")
            break
    return problems


def _watch(station: Station, cycles: int) -> str:
    """Return what goes wrong in some cycles after a switch; empty for nothing."""
    limits = {one.joint: one.limits.max_velocity for one in station.hardware().limits}
    most = np.array([limits[name] or np.inf for name in JOINTS])
    before = _positions(station)
    for cycle in range(cycles):
        station.loop.step(1)
        now = _positions(station)
        if (np.abs(now - before) > TOLERANCE * most * 0.001).any():
            speeds = np.abs(now - before) / 0.001
            return f"cycle {cycle}: a jump, {np.round(speeds, 2).tolist()} rad/s"
        before = now
    mode = station.latest().mode
    faults = [f"{c.name}: {c.fault}" for c in station.controllers() if c.fault]
    fine = faults or mode in ("move", "idle")
    return " ".join(faults) if fine else f"the arm is in {mode}"


def _positions(station: Station) -> np.ndarray:
    return np.array(station.latest().position[: len(JOINTS)])


def main() -> int:
    """Measure and switch; 1 if something went wrong."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arms", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--switches", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    logging.disable(logging.CRITICAL)
    print_title("What a cycle of several arms costs")
    rows = []
    for count in options.arms:
        cycle, step = cost(make_arms(count))
        rest = cycle - step
        rows.append([count, cycle, step, cycle / count, rest / count])
    headers = ["arms", "cycle [us]", "mj_step [us]", "per arm [us]", "without mj_step"]
    print_table(headers, rows)
    problems = switch_at_random(options.switches, options.seed)
    sys.stdout.write(f"{options.switches} switches: {problems or 'nothing wrong'}\n")
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
