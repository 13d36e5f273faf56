"""Whether the default arm stays free of reflexes while nothing touches it.

Run `python benchmarks/bench_free_space.py [--pairs 500] [--seeds 10]`. The arm moves
between all its named poses, and between random poses in the whole range of its joints,
at several speeds and with several seeds of its sensors' noise. Paths on which links
come near each other are left out, and the base stands so high that no pose touches the
floor: every reflex is a false one. Everything is stepped, so the figures do not depend
on the machine.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from itertools import permutations

import numpy as np
from measuring import print_table, print_title
from numpy.typing import NDArray

import station
from station.client.errors import MotionError
from station.client.poses import POSES, joint_positions
from station.core.franka.franka_model import Frame
from station.hw.franka.arm.arm_limits import PANDA_LIMITS, ArmLimits
from station.hw.franka.arm.franka_kinematics import zero_jacobian
from station.hw.franka.arm.self_collision import clearance

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
TOOL = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.1034, 1]
SPEEDS = (0.5, 1.0, 0.25, 2.0)
"""Mean speeds of the joint that has the longest way [rad/s]."""
MARGIN = 0.06
"""Distance of the poses from the limits of the joints [rad]."""
CLEARANCE = 0.03
"""Least distance between links on a path [m]."""

Pose = NDArray[np.float64]


def named_pairs() -> list[tuple[Pose, Pose]]:
    """Return all ordered pairs of named poses."""
    zeros = [0.0] * len(JOINTS)
    poses = [np.array(joint_positions(name, JOINTS, zeros)) for name in POSES]
    return list(permutations(poses, 2))


def random_pairs(seed: int, limits: ArmLimits) -> Iterator[tuple[Pose, Pose]]:
    """Yield random pairs of poses with a free straight way between their joints."""
    generator = np.random.default_rng(seed)
    lower = np.array(limits.lower) + MARGIN
    upper = np.array(limits.upper) - MARGIN
    while True:
        begin, end = generator.uniform(lower, upper, (2, 7))
        shares = np.linspace(0.0, 1.0, 40)
        ways = [(begin + share * (end - begin)).tolist() for share in shares]
        if all(clearance(q, has_hand=True) > CLEARANCE for q in ways):
            yield begin, end


def duration(begin: Pose, end: Pose, speed: float, limits: ArmLimits) -> float:
    """Return how long the way takes at a mean speed that the arm can follow [s]."""
    way = end - begin
    peak = 1.875 * way  # of a quintic from rest to rest
    fastest = max(
        float(np.linalg.norm((jacobian(begin + share * way) @ peak)[:3]))
        for share in np.linspace(0.1, 0.9, 9)
    )
    return max(
        1.0,
        float(np.abs(way).max()) / speed,
        fastest / 1.5,
        float((np.abs(peak) / np.array(limits.velocity)).max()) / 0.85,
    )


def jacobian(q: Pose) -> NDArray[np.float64]:
    """Return the Jacobian of the end effector, shape (6, 7)."""
    return np.reshape(zero_jacobian(Frame.END_EFFECTOR, q.tolist(), TOOL), (7, 6)).T


def move(
    pairs: Sequence[tuple[Pose, Pose]], seed: int, limits: ArmLimits
) -> tuple[int, float, list[str]]:
    """Return the number of motions, their time [s], and what ended some of them."""
    settings = {"robot.realism_seed": seed, "robot.base_xyz": [0.0, 0.0, 2.0]}
    robot, ended, motions, total = station.open(settings=settings), [], 0, 0.0
    for number, (begin, end) in enumerate(pairs):
        robot.reset(dict(zip(JOINTS, begin.tolist(), strict=True)))
        robot.run(0.05)
        speed = SPEEDS[(number + seed) % len(SPEEDS)]
        before = robot.time
        try:
            robot.move_to(end.tolist(), duration=duration(begin, end, speed, limits))
            robot.run(0.3)
        except MotionError as error:
            ended.append(f"seed {seed}, pair {number}: {error}")
            robot.close()
            robot = station.open(settings=settings)
            before = robot.time
        motions, total = motions + 1, total + robot.time - before
    robot.close()
    return motions, total, ended


def main() -> None:
    """Print how many motions ended in a reflex, and why."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=500)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=0)
    options = parser.parse_args()
    source = random_pairs(1, PANDA_LIMITS)
    # Every named pair at every speed.
    pairs = [pair for pair in named_pairs() for _ in SPEEDS]
    pairs += [next(source) for _ in range(options.pairs)]
    rows: list[list[object]] = []
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        motions, total, ended = move(pairs, seed, PANDA_LIMITS)
        rows.append([seed, motions, total / 60.0, len(ended)])
        for line in ended:
            sys.stdout.write(f"{line}\n")
        sys.stdout.flush()
    print_title("Motions of the default arm in free space")
    print_table(["seed", "motions", "minutes", "reflexes"], rows)


if __name__ == "__main__":
    main()
