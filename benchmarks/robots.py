"""Does every robot of example-robot-data start, stand still, and reach a goal?

Run `python benchmarks/robots.py [NAME ...] [--workers 2] [--table FILE]`.
Each robot is looked at twice. A station in this process is stepped as fast as the
processor can: one second without a command, and, with self-collision and floor left
out, every motor's full effort against both mechanical stops. Then `station run --robot`
is started as a user does, and gets a goal for its joint trajectory controller over
REST, after another second without a command. `--table` replaces the table
between the lines `<!-- robots -->` and `<!-- end of robots -->` of that file.
"""

import argparse
import json
import logging
import subprocess
import sys
from dataclasses import asdict, dataclass
from math import degrees
from multiprocessing.pool import ThreadPool
from pathlib import Path
from time import monotonic, sleep

STILL = {"rotation": 0.01, "slide": 0.001}
"""What a joint may move in the first second without a command [rad], [m]."""
SHARE = 0.1
"""Length of the goal's motion, of the range; at most 0.2 rad, or 2 cm."""
PATIENCE = 60.0
"""How long a goal of 3 s may take on a machine that is busy [s]."""
TOO_LONG = 600.0
"""After how long a robot is given up [s]."""
STOPS = 0.5
"""What a mechanical stop may yield [degrees]."""
BEGIN, END = "<!-- robots -->", "<!-- end of robots -->"


@dataclass
class Row:
    """What was seen of one robot.

    Attributes:
        robot: Its name.
        joints: Joints that move.
        motors: Joints with a motor.
        repairs: Repairs of the description, without what every robot gets.
        moved: Largest motion in the first second [rad or m].
        goal: `reached`, or why not.
        yielded: How far the stops yield at full effort [degrees].
        refused: Why it does not start; empty if it does.
    """

    robot: str
    joints: int = 0
    motors: int = 0
    repairs: int = 0
    moved: float = 0.0
    goal: str = "-"
    yielded: float = 0.0
    refused: str = ""

    def is_good(self) -> bool:
        """Return whether nothing is wrong."""
        return (
            not self.refused
            and self.moved <= STILL["rotation"]
            and self.goal in ("reached", "no motors")
            and self.yielded <= STOPS
        )


def examine(name: str) -> Row:
    """Return what one robot does."""
    from station.core.errors import StationError

    row = Row(name)
    try:
        goal = _stand_still(row)
        row.yielded = _push_against_stops(name) if row.motors else 0.0
        _move_over_rest(row, goal)
    except StationError as error:
        row.refused = error.message.rpartition("/")[2]
    return row


def _stand_still(row: Row) -> dict | None:
    """Count its parts and leave it alone; return a goal, None without trajectories."""
    import numpy as np

    from station.app.any_robot import TRAJECTORIES, configure_robot
    from station.app.composition import compose
    from station.config import load_config

    config = configure_robot(f"example-robot-data:{row.robot}")
    station = compose(load_config(config)).station
    world = station.loop.hw.world
    start = world.data.qpos.copy()
    row.joints, row.motors = world.model.njnt, world.model.nu
    row.repairs = sum(not one.is_addition for one in station.loop.hw.repairs())
    station.loop.step(1000)
    row.moved = float(np.abs(np.append(world.data.qpos - start, 0.0)).max())
    if TRAJECTORIES not in config["controllers"]:
        row.goal = "no motors" if row.motors == 0 else "wheels alone"
        return None
    return _goal(station, config)


def _move_over_rest(row: Row, goal: dict | None) -> None:
    """Start the robot as a user does, leave it alone, and send it the goal."""
    from live import running_station

    from station.app.any_robot import TRAJECTORIES
    from station.client import ApiError, MotionError, StationClient

    robot = f"example-robot-data:{row.robot}"
    with (
        running_station("--robot", robot, has_dashboard=False) as access,
        StationClient(access["url"], token=access["token"]) as station,
    ):
        first = station.joint_states()
        deadline = monotonic() + PATIENCE
        while (last := station.joint_states()).stamp < first.stamp + 1.0:
            sleep(0.1)
            if monotonic() > deadline:
                row.goal = "its time does not pass"
                return
        pairs = zip(first.position, last.position, strict=True)
        row.moved = max(row.moved, *(abs(a - b) for a, b in pairs), 0.0)
        if goal is None:
            return
        try:
            ended = station.start_goal(TRAJECTORIES, goal).ended(PATIENCE)
        except (ApiError, MotionError) as error:
            row.goal = str(error)
            return
        reason = "" if ended.result is None else ended.result.message
        row.goal = "reached" if ended.status == "succeeded" else reason or ended.status


def _goal(station: object, config: dict) -> dict:
    """Return a goal a little nearer to the middle of every range."""
    from station.app.any_robot import TRAJECTORIES

    world = station.loop.hw.world
    joints = config["controllers"][TRAJECTORIES]["joints"]
    targets = []
    for name in joints:
        joint = world.model.joint(name)
        position = float(world.data.joint(name).qpos[0])
        low, high = joint.range if joint.limited else (-3.0, 3.0)
        most = 0.02 if int(joint.type[0]) == 2 else 0.2
        length = min(most, SHARE * (high - low))
        away = 1.0 if position <= (low + high) / 2.0 else -1.0
        targets.append(position + away * length)
    point = {"positions": targets, "time_from_start": 3.0}
    return {
        "trajectory": {"joint_names": joints, "points": [point]},
        "goal_time_tolerance": 2.0,
    }


def _push_against_stops(name: str) -> float:
    """Return how far the stops yield [degrees]; slides, in mm, count as well."""
    import numpy as np

    from station.app.any_robot import configure_robot
    from station.app.composition import compose
    from station.config import load_config
    from station.core import SwitchRequest

    config = configure_robot(f"example-robot-data:{name}")
    config["robot"] |= {"self_collision": "off", "floor": False}
    station = compose(load_config(config)).station
    model, data = station.loop.hw.world.model, station.loop.hw.world.data
    motors = [model.actuator(i).name for i in range(model.nu)]
    limited = [n for n in motors if model.joint(n).limited and model.joint(n).type == 3]
    if not limited:
        return 0.0
    station.parameters.set(
        "push",
        {"type": "effort_controllers/JointGroupEffortController", "joints": limited},
    )
    station.load_controller("push")
    station.switch_controllers(SwitchRequest(start=("push",)))
    low, high = np.array([model.joint(n).range for n in limited]).T
    most = np.array([model.actuator(n).forcerange[1] for n in limited])
    places = [int(model.joint(n).qposadr[0]) for n in limited]
    worst = 0.0
    for sign in (1.0, -1.0):
        station.motion.set_command("push", (sign * most).tolist())
        for _ in range(3000):
            station.loop.step(1)
            position = data.qpos[places]
            worst = max(
                worst, float(np.max(np.maximum(low - position, position - high)))
            )
    return degrees(worst)


def table(rows: list[Row]) -> str:
    """Return the rows in Markdown."""
    lines = [
        "| robot | joints | motors | repairs | moves by itself | goal | stops yield |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        if row.refused:
            lines.append(f"| {row.robot} | refused: {row.refused} | | | | | |")
            continue
        lines.append(
            f"| {row.robot} | {row.joints} | {row.motors} | {row.repairs} | "
            f"{row.moved:.4f} | {row.goal} | {row.yielded:.2f}° |"
        )
    return "\n".join(lines)


def _in_a_process(name: str) -> Row:
    try:
        done = subprocess.run(
            [sys.executable, __file__, name, "--one"],
            capture_output=True,
            text=True,
            check=False,
            timeout=TOO_LONG,
        )
    except subprocess.TimeoutExpired:
        return _tell(Row(name, refused=f"not done after {TOO_LONG:g} s"))
    if done.returncode:
        reason = (done.stderr.strip().splitlines() or ["?"])[-1]
        return _tell(Row(name, refused=reason))
    return _tell(Row(**json.loads(done.stdout)))


def _tell(row: Row) -> Row:
    """Write a row as soon as it is known, and return it."""
    sys.stderr.write(f"{table([row]).splitlines()[-1]}\n")
    return row


def main() -> int:
    """Examine robots; 1 if one is not good."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--table", type=Path, metavar="FILE")
    parser.add_argument("--one", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        logging.disable(logging.CRITICAL)
        sys.stdout.write(json.dumps(asdict(examine(options.names[0]))))
        return 0
    from station.core.description.robot_files import known_robots

    names = options.names or sorted(known_robots())
    with ThreadPool(options.workers) as pool:
        rows = pool.map(_in_a_process, names, chunksize=1)
    text = table(rows)
    sys.stdout.write(f"{text}\n")
    if options.table is not None:
        page = options.table.read_text(encoding="utf-8")
        before, _, rest = page.partition(BEGIN)
        after = rest.partition(END)[2]
        options.table.write_text(
            f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8"
        )
    started = sum(not row.refused for row in rows)
    bad = [row.robot for row in rows if not row.is_good()]
    sys.stdout.write(f"{started} of {len(rows)} start; not good: {bad or 'none'}\n")
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
