"""Print what the default Panda does, second by second, while each controller moves it.

Run `python -m tests.system.motion_of_controllers SECONDS`. Time passes by hand, so two
runs print the same if their arithmetic is the same. The output is a JSON object. Its
`mode` says whether it was computed compiled. By the name of each default controller it
has the `seconds`, each a digest of all numbers that the cycles have left behind with
the positions of the joints [rad], and the `end`.
"""

import hashlib
import json
import sys
from math import cos, pi, sin

from station.app.composition import compose
from station.compiled import status
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.franka.arms import Arms
from station.core.numerics.rigid_motion import numbers_of
from station.memory.doubles import doubles, zeros

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
CYCLES = 1000
"""Cycles in a second."""
SENT = 20
"""Cycles from one set-point to the next."""
PERIOD = 3
"""Period of the set-points [s]."""
GOAL = 2
"""Time from one goal to the next [s]."""


class Mover:
    """Moves the robot by what a controller takes.

    Args:
        station: The station; the controller runs.
        name: The controller.
    """

    def __init__(self, station, name):
        self._station = station
        self._name = name
        self._home = station.latest().position[:7]
        self._pose = zeros(7)
        pose = Arms(station.robots).state("panda").O_T_EE
        numbers_of(doubles(pose), doubles([0.0, 0.0, 0.0, 1.0]), self._pose)

    def move(self, cycle):
        """Send what is due after so many cycles, a multiple of `SENT`."""
        motion, name = self._station.motion, self._name
        if "trajectory" in name or "gripper" in name:
            number, rest = divmod(cycle, GOAL * CYCLES)
            if rest == 0:
                motion.submit_goal(name, self._goal((-1) ** number))
        elif name != "joint_state_controller":
            motion.set_command(name, self._set_point(cycle / CYCLES))

    def _set_point(self, time):
        turning = 2.0 * pi / PERIOD
        wave, rate = sin(turning * time), turning * cos(turning * time)
        if self._name == "cartesian_streaming_controller":
            x, y, *rest = self._pose
            return [
                x + 0.03 * (cos(3.0 * time) - 1.0),
                y + 0.03 * sin(3.0 * time),
                *rest,
            ]
        if self._name == "cartesian_jog_controller":
            return [0.02 * wave, 0.03 * rate, 0.02 * rate, 0.0, 0.1 * rate, 0.0]
        if "effort_group_effort" in self._name:
            return [0.5 * wave - 4.0 * dq for dq in self._station.latest().velocity[:7]]
        if "velocity" in self._name or "jog" in self._name:
            return [0.1 * rate] * 7
        return [home + 0.1 * wave for home in self._home]

    def _goal(self, side):
        if "gripper" in self._name:
            return {"command": {"position": 0.02 + 0.01 * side, "max_effort": 10.0}}
        points = [
            {
                "positions": [home + 0.1 * side * share for home in self._home],
                "time_from_start": share * (GOAL - 1),
            }
            for share in (0.5, 1.0)
        ]
        return {"trajectory": {"joint_names": JOINTS, "points": points}}


def move(name, seconds):
    """Return what happens in each second, and what the robot does at the end."""
    station = compose(load_config(), ManualClock()).station
    station.loop.step(1, 1.0 / CYCLES)
    station.switch_controllers(SwitchRequest(start=[name]))
    mover = Mover(station, name)
    records, found = station.snapshots, []
    for second in range(seconds):
        digest = hashlib.sha256()
        for part in range(0, CYCLES, SENT):
            mover.move(second * CYCLES + part)
            station.loop.step(SENT, 1.0 / CYCLES)
            for cycle in range(records.newest - SENT + 1, records.newest + 1):
                at = cycle % records.capacity * records.width
                digest.update(records.memory[at : at + records.width])
        joints = " ".join(value.hex() for value in station.latest().position)
        found.append(f"{digest.hexdigest()} {joints}")
    states = {status.name: status.state.value for status in station.controllers()}
    return {"seconds": found, "end": f"{station.latest().mode} {states[name]}"}


def main(seconds):
    """Print what all controllers of the default configuration do."""
    moved = {name: move(name, seconds) for name in load_config().controllers}
    json.dump({"mode": status().mode, "controllers": moved}, sys.stdout)


if __name__ == "__main__":
    main(int(sys.argv[1]))
