"""How a simulated Franka errs, beside what has been published of a real one.

Run `python benchmarks/bench_realism.py [--minutes 10] [--seed 1]`. Everything is
stepped, so the figures do not depend on the machine. The first tables compare noise,
friction, the torque that breaks a resting joint free, the turn of the motors against
the links, the delay of commands, and the delay until a collision is noticed. Then the
arm moves at random under the default configuration: a reflex is a false one, because
nothing is in its way.
"""

import argparse
import sys
from math import exp, radians
from random import Random

import numpy as np
from measuring import print_table, print_title, simulated_world

from station.app.composition import compose
from station.config import load_config
from station.core import SnapshotRing, SwitchRequest
from station.core.facade.station import Station
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.hw.franka.simulated.realism import TYPICAL
from station.hw.mujoco.world import Push

CONTROLLER = "effort_joint_trajectory_controller"
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
PUSH = "push"
BREAKAWAY = (0.8315, 0.99845, 0.8923, 1.29255, 0.81225, 0.58725, 0.4132)
"""Measured by [2] of `realism.py` [Nm]."""
RAMP, TURNED = 0.0005, radians(0.5)
"""How it was measured: torque added per cycle [Nm], and the turn that ends it [rad]."""
ONE_MOMENT = {
    "q": (0.0167305, -0.762614, -0.0207622, -2.34352, -0.0305686, 1.53975, 0.753872),
    "theta": (0.01673, -0.763341, -0.0207471, -2.34041, -0.0304783, 1.54006, 0.753865),
    "tau_J": (-0.00359774, -5.08582, 0.105732, 21.8135, 0.63253, 2.18121, -0.0481953),
}
"""Of a Panda, in [3] of `realism.py`."""
REACH = 0.35
"""Largest distance of random goals from the ready pose [rad]; beyond, links meet."""


def make_station() -> Station:
    """Return a station of the default configuration that keeps few snapshots."""
    return compose(load_config(), snapshots=SnapshotRing(16)).station


def state_of(station: Station) -> RobotState:
    """Return the live state of the arm.

    Raises:
        TypeError: It is no Franka.
    """
    hw = station.loop.hw
    if not isinstance(hw, FrankaHW):
        raise TypeError("the default configuration has another robot")
    return hw.robot_state


def errors_of(station: Station) -> str:
    """Return why the arm is in its reflex."""
    hw = station.loop.hw
    return "; ".join(map(str, hw.arm.errors())) if isinstance(hw, FrankaHW) else ""


def measure_noise() -> list[list[object]]:
    """Return noise at rest beside the noise of the published recording."""
    station = make_station()
    state = state_of(station)
    rows = []
    for _ in range(5000):
        station.loop.step()
        rows.append([*state.dq, *state.tau_J, *state.tau_ext_hat_filtered])
    found = np.diff(np.array(rows), axis=0).std(axis=0) / np.sqrt(2.0)
    level = np.abs(np.array(rows)[1000:, 14:]).max(axis=0)
    return [
        ["velocity noise [rad/s]", *found[:7], "recording"],
        ["  published", *TYPICAL.velocity_noise, ""],
        ["torque noise [Nm]", *found[7:14], "recording"],
        ["  published", *TYPICAL.torque_noise, ""],
        ["largest |tau_ext| at rest [Nm]", *level, "not published"],
    ]


def measure_friction(velocity: float) -> list[list[object]]:
    """Return the torque that a constant velocity takes, and the published curve."""
    world = simulated_world(make_station())
    world.data.qvel[:7] = velocity
    world.step()
    published = [
        a / (1.0 + exp(-b * (velocity + c))) - a / (1.0 + exp(-b * c))
        for a, b, c in zip(
            TYPICAL.friction_level,
            TYPICAL.friction_slope,
            TYPICAL.friction_shift,
            strict=True,
        )
    ]
    found = (-world.data.qfrc_applied[:7]).tolist()
    label = f"friction at {velocity:g} rad/s [Nm]"
    return [[label, *found, "Gaz et al. 2019"], ["  published", *published, ""]]


def push_joints(station: Station) -> None:
    """Let every joint give the effort that it is told."""
    kind = "effort_controllers/JointGroupEffortController"
    station.parameters.set(PUSH, {"type": kind, "joints": JOINTS})
    station.load_controller(PUSH)
    station.switch_controllers(SwitchRequest(start=(PUSH,)))
    station.loop.step(1500)


def measure_breakaway(joint: int) -> float:
    """Return the torque that turns a resting joint, mean of both ways [Nm]."""
    found = []
    for sign in (1.0, -1.0):
        station = make_station()
        push_joints(station)
        state, begin, torques = state_of(station), 0.0, [0.0] * 7
        begin = state.q[joint]
        while abs(state.q[joint] - begin) < TURNED:
            torques[joint] += sign * RAMP
            station.motion.set_command(PUSH, torques)
            station.loop.step()
        found.append(abs(torques[joint]))
    return sum(found) / 2.0


def measure_stiffness() -> list[list[object]]:
    """Return the torque over the turn of the motor against the link."""
    station = make_station()
    state = state_of(station)
    station.loop.step(100)
    rows: list[list[object]] = []
    for label, moment in (
        ("tau_J over theta - q [Nm/rad]", {n: getattr(state, n) for n in ONE_MOMENT}),
        ("  published", ONE_MOMENT),
    ):
        found = [
            tau / (theta - q) if abs(tau) > 0.05 else float("nan")
            for q, theta, tau in zip(*moment.values(), strict=True)
        ]
        rows.append([label, *found, "echo_robot_state" if not rows else ""])
    return rows


def measure_delay() -> int:
    """Return how many cycles after the state that it answers a torque acts."""
    station = make_station()
    push_joints(station)
    data = simulated_world(station).data
    station.motion.set_command(PUSH, [0.5] * 7)
    cycles = 0
    while not data.qfrc_actuator[:7].any():
        station.loop.step()
        cycles += 1
    # The first cycle computed the command, the last one contains the step.
    return cycles - 2


def measure_detection(force: float) -> int:
    """Return after how many milliseconds a blow on the hand raises a reflex."""
    station = make_station()
    station.switch_controllers(SwitchRequest(start=(CONTROLLER,)))
    station.loop.step(1000)
    simulated_world(station).push(Push("panda_hand", (0.0, force, 0.0)), 200)
    state = state_of(station)
    for cycle in range(200):
        if state.robot_mode is RobotMode.REFLEX:
            return cycle
        station.loop.step()
    return -1


def move_at_random(minutes: float, seed: int) -> list[object]:
    """Return what happened in some minutes of random motion."""
    station, dice = make_station(), Random(seed)
    state = state_of(station)
    station.switch_controllers(SwitchRequest(start=(CONTROLLER,)))
    errors, reflexes, goals, largest = [], 0, 0, 0.0
    while station.loop.time < 60.0 * minutes:
        goal = [q + dice.uniform(-REACH, REACH) for q in INITIAL_POSITIONS]
        way = max(abs(a - b) for a, b in zip(goal, state.q, strict=True))
        duration = max(0.5, way / dice.uniform(0.2, 1.0))
        # As planners send them, with the end at rest: no step in the velocity.
        point = {
            "positions": goal,
            "velocities": [0.0] * 7,
            "time_from_start": duration,
        }
        trajectory = {"joint_names": JOINTS, "points": [point]}
        station.motion.submit_goal(CONTROLLER, {"trajectory": trajectory})
        goals += 1
        for _ in range(int(1000 * duration)):
            station.loop.step()
            sample = station.manager.samples().get(CONTROLLER)
            if sample is None:
                break
            errors.append(sum(e * e for e in sample.error) / 7.0)
            largest = max(largest, *map(abs, state.tau_ext_hat_filtered))
        reflexes += state.robot_mode is RobotMode.REFLEX
        if reflexes:
            sys.stdout.write(
                f"A reflex at {station.loop.time:.1f} s: {errors_of(station)}\n"
            )
            break
    error = 1000.0 * (sum(errors) / len(errors)) ** 0.5
    return [station.loop.time / 60.0, goals, reflexes, error, largest]


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print_title("A simulated Panda beside published figures")
    rows = measure_noise()
    for velocity in (0.05, 0.5, -0.5):
        rows += measure_friction(velocity)
    broken = [measure_breakaway(joint) for joint in range(7)]
    rows.append(["breakaway torque [Nm]", *broken, "franka_emulator"])
    rows.append(["  published", *BREAKAWAY, ""])
    rows += measure_stiffness()
    print_table(["quantity", *(f"joint {n}" for n in range(1, 8)), "source"], rows)
    sys.stdout.write(
        f"\nA command acts {measure_delay()} ms after the state that it answers; on a "
        "real arm it arrives within\nthat millisecond, and acts in the next.\n"
    )
    delays = [[force, measure_detection(force)] for force in (40.0, 60.0, 100.0)]
    sys.stdout.write("\nThe data sheet names 50 ms until the arm reacts.\n")
    print_table(["blow on the hand [N]", "reflex after [ms]"], delays)
    sys.stdout.write("\nRandom motion, default configuration:\n")
    headers = ["minutes", "goals", "reflexes", "RMS error [mrad]", "tau_ext [Nm]"]
    print_table(headers, [move_at_random(options.minutes, options.seed)])


if __name__ == "__main__":
    main()
