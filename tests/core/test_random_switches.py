"""Failure mode 8: random switches under load keep one owner per joint, every cycle."""

import random
import threading

from station.core.clock import SystemClock
from station.core.control.switching import Strictness
from station.core.errors import StationError
from station.core.loop.control_loop import ControlLoop
from station.testing.scripted import ScriptedBench
from tests.waiting import PATIENCE

THREADS = 4
SWITCHES = 250
JOINTS = ("j1", "j2", "j3")
KINDS = ("Effort", "Velocity", "Position")


class Witness:
    """Looks at the end of every cycle who owns what, and which mode the robot is in."""

    def __init__(self, bench):
        self.bench = bench
        self.problems = []
        self.ownerless = 0
        self.names = {}
        write = bench.robot.write

        def watched(time, period):
            self.look()
            write(time, period)

        bench.robot.write = watched

    def look(self):
        """Compare claims of running controllers with the robot's modes."""
        owners = {joint: [] for joint in JOINTS}
        for status in self.bench.manager.list_controllers():
            if status.state.value == "running":
                for claim in status.claimed_resources:
                    for joint in claim.resources:
                        owners[joint].append((status.name, claim.hardware_interface))
        for index, joint in enumerate(JOINTS):
            mode = self.bench.robot.joints.mode[index]
            modes = [interface for _, interface in owners[joint]]
            if modes != ([mode] if mode else []):
                self.problems.append((joint, mode, owners[joint]))
        if not owners["j3"]:
            self.ownerless += 1


def hand_over(bench, seed, outcomes):
    """Switch at random; j3 is only ever handed over, never given up."""
    dice = random.Random(seed)
    names = [f"{joint}_{kind}" for joint in JOINTS[:2] for kind in KINDS]
    for _ in range(SWITCHES):
        if dice.random() < 0.3:
            running = [k for k in KINDS if bench.state(f"j3_{k}") == "running"]
            stop = [f"j3_{k}" for k in running]
            start = [f"j3_{dice.choice(KINDS)}"]
            strictness = Strictness.STRICT
        else:
            start = dice.sample(names, dice.randint(0, 2))
            stop = dice.sample(names, dice.randint(0, 3))
            strictness = dice.choice(list(Strictness))
        try:
            bench.switch(start, stop, strictness)
            outcomes.append("done")
        except StationError as error:
            outcomes.append(error.code)


def test_a_thousand_random_switches_keep_one_owner_per_joint_in_every_cycle():
    bench = ScriptedBench(SystemClock())
    for joint in JOINTS:
        for kind in KINDS:
            bench.load(f"{joint}_{kind}", joint, kind=kind)
    bench.switch(["j3_Effort"])
    witness = Witness(bench)
    loop = ControlLoop(bench.robot, bench.manager, clock=SystemClock())
    outcomes = []
    threads = [
        threading.Thread(target=hand_over, args=(bench, seed, outcomes))
        for seed in range(THREADS)
    ]
    loop.start()
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    loop.stop()

    assert len(outcomes) == THREADS * SWITCHES  # none lost, none stuck
    assert witness.problems == []
    assert witness.ownerless == 0
    assert set(outcomes) <= {"done", "switch_refused", "resource_conflict"}
    assert outcomes.count("done") > SWITCHES
