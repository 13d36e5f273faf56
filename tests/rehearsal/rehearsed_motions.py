"""Seeded motions, half of which trip, each rehearsed and then made.

A command makes many of them on one stepped arm:

    python -m tests.rehearsal.rehearsed_motions 200
"""

import sys
from collections import Counter

import numpy as np

import station
from station.core.errors import StationError
from station.rehearsal.rehearsals import Rehearsals
from tests.rehearsal.test_rehearsals import (
    EFFORT,
    EFFORTS,
    POSITION,
    READY,
    WALL,
    begin,
    goal,
    live_end,
    moved,
    set_point,
    tight,
)


def motion(seed: int) -> tuple[str, list[dict], str | None, str | None]:
    """Return a controller, its steps, the cause of the end and its joint, if any."""
    random = np.random.default_rng(seed)
    joint = int(random.integers(1, 8))
    name, sign = f"panda_joint{joint}", random.choice([-1.0, 1.0])
    if seed % 2 == 0:
        controller = str(random.choice([POSITION, EFFORT]))
        way = random.uniform(-0.15, 0.15, 7)
        pose = [q + float(w) for q, w in zip(READY, way, strict=True)]
        return controller, goal(controller, pose, random.uniform(0.8, 1.5)), None, None
    kind = seed // 2 % 4
    if kind == 0:
        bend = random.uniform(0.8, 1.0)
        steps = goal(POSITION, moved(j2=bend, j4=bend), random.uniform(1.2, 1.8))
        return POSITION, steps, "reflex", None
    if kind == 1:
        pose = moved(**{f"j{joint}": float(0.4 * sign)})
        limits = tight(name, float(random.uniform(2e-4, 4e-4)))
        return EFFORT, goal(EFFORT, pose, 0.7, **limits), "tolerance", name
    if kind == 2:
        # Joint 2 would throw the arm into the wall.
        thrown = 3 if joint == 2 else joint
        torques = [0.0] * 7
        torques[thrown - 1] = float(sign * (40.0 if thrown < 5 else 9.0))
        return EFFORTS, set_point(EFFORTS, torques), "limit", None
    pose = moved(**{f"j{joint}": float(7.0 * sign)})
    return POSITION, goal(POSITION, pose, 2.0), "refused", None


def main(count: int) -> int:
    """Rehearse and make the motions; return how many went another way."""
    robot, wrong, causes = station.open({"scene": {"objects": [WALL]}}), 0, Counter()
    for seed in range(count):
        controller, steps, cause, joint = motion(seed)
        begin(robot, controller)
        told = Rehearsals(robot.facade).rehearse(steps, None if cause else 1.7)
        error = told.error
        found = None if error is None else str(error.cause)
        causes[found] += 1
        try:
            digest, bad, errors = live_end(robot, steps, told.cycles)
            cycle = None if error is None else error.cycle
            same = (digest, bad) == (told.digest, cycle)
            same = same and (found not in {"reflex", "limit"} or error.code in errors)
        except StationError as refusal:
            same = error is not None and error.code == refusal.code
        is_joint = joint is None or (error is not None and error.where == joint)
        if not same or not is_joint or found != cause:
            wrong += 1
            sys.stdout.write(
                f"{seed}: {found} and not {cause}, same: {same}; {error}\n"
            )
            sys.stdout.flush()
    sys.stdout.write(f"{count - wrong} of {count} as rehearsed: {dict(causes)}\n")
    return wrong


if __name__ == "__main__":
    sys.exit(min(main(int(sys.argv[1])), 1))
