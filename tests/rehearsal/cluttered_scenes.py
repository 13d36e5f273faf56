"""Seeded scenes around a simulated arm, each with a goal that has to be gone around.

A command plans in many of them and follows each path, judged by MuJoCo's contacts:

    python -m tests.rehearsal.cluttered_scenes 50
"""

import resource
import sys
from dataclasses import dataclass

import numpy as np

import station
from station.core.errors import NoPathError
from station.rehearsal.planning import MARGIN, Wish, plan
from station.rehearsal.rehearsals import Rehearsals

ARM = "position_joint_trajectory_controller"
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
READY = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
_REACH = np.array([1.4, 0.7, 0.8, 0.7, 1.0, 0.8, 1.0])
PATIENCE = 20.0
"""Time after which a scene counts as one without a path [s]."""


def things(seed: int) -> list[dict[str, object]]:
    """Return six to ten bodies around the arm, as in `scene/objects`."""
    random = np.random.default_rng(seed)
    found = []
    for number in range(random.integers(6, 11)):
        angle, far = random.uniform(-2.0, 2.0), random.uniform(0.35, 0.75)
        place = [far * np.cos(angle), far * np.sin(angle), random.uniform(0.1, 0.9)]
        kind = str(random.choice(["box", "sphere", "capsule", "cylinder"]))
        size = {
            "box": random.uniform(0.06, 0.3, 3).tolist(),
            "sphere": [random.uniform(0.04, 0.12)],
            "capsule": [random.uniform(0.02, 0.06), random.uniform(0.2, 0.6)],
            "cylinder": [random.uniform(0.03, 0.08), random.uniform(0.2, 0.8)],
        }[kind]
        turned = random.uniform(-0.8, 0.8, 3).tolist()
        found.append({
            "name": f"thing{number}",
            "type": kind,
            "size": [float(one) for one in size],
            "position": [float(one) for one in place],
            "rpy": turned,
        })
    return found


@dataclass
class Scene:
    """A station with a scene, its arm at a start, and a goal."""

    robot: "station.InProcessStation"
    goal: np.ndarray

    @classmethod
    def of(cls, seed: int) -> "Scene":
        """Return the scene of a seed: start and goal clear, the line between not."""
        robot = station.open({"scene": {"objects": things(seed)}})
        near = robot.facade.loop.hw.simulated_world().nearness(JOINTS, MARGIN)
        random = np.random.default_rng(1000 + seed)
        while True:
            start, goal = (READY + random.uniform(-_REACH, _REACH) for _ in range(2))
            line = (start + share * (goal - start) for share in np.linspace(0, 1, 40))
            blocked = [bool(near(pose)) for pose in line]
            if not blocked[0] and not blocked[-1] and any(blocked):
                break
        robot.facade.loop.hw.simulated_world().world.model.geom_margin[:] = 0.0
        robot.reset(dict(zip(JOINTS, start.tolist(), strict=True)))
        robot.run(0.05)
        # Where the arm stood before, things may have been inside of it.
        robot.facade.robots.recover("panda")
        robot.switch(start=[ARM])
        robot.run(0.05)
        return cls(robot, goal)

    def wish(self, timeout: float = 2.0) -> Wish:
        """Return the wish for a path to the goal."""
        return Wish(
            ARM, dict(zip(JOINTS, self.goal.tolist(), strict=True)), None, timeout
        )

    def follow(self) -> tuple[bool, set[tuple[str, str]]]:
        """Plan, follow; return whether the goal succeeded, and what touched."""
        found = Rehearsals(self.robot.facade).plan(self.wish())
        world = self.robot.facade.loop.hw.simulated_world()
        goal = self.robot.facade.motion.submit_goal(ARM, found.goal)
        touched = set()
        for _ in range(int(1000 * found.duration) + 300):
            self.robot.step()
            touched |= {one.bodies for one in world.contacts()}
        return goal.status.value == "succeeded", touched


def _time_of_copies() -> float:
    """Return the processor time of all copies so far [s], whatever else runs."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(count: int) -> int:
    """Print one line per scene and the sums; return whether they are good."""
    times, failed, hopeless = [], 0, 0
    for seed in range(count):
        scene = Scene.of(seed)
        begun = _time_of_copies()
        try:
            plan(scene.robot.facade, scene.wish())
            times.append(_time_of_copies() - begun)
            succeeded, touched = scene.follow()
            said = f"{1e3 * times[-1]:.0f} ms"
            if not succeeded or touched:
                failed += 1
                said += f", {'touched ' + str(touched) if touched else 'aborted'}"
        except NoPathError as error:
            try:
                plan(scene.robot.facade, scene.wish(PATIENCE))
                failed += 1
                said = f"failed, although there is a path: {error}"
            except NoPathError:
                hopeless += 1
                said = f"no path: {error}"
        sys.stdout.write(f"{seed}: {said}\n")
        sys.stdout.flush()
    good = count - hopeless - failed
    middle = 1e3 * np.median(times)
    sys.stdout.write(f"{good} of {count - hopeless}, median {middle:.0f} ms\n")
    return int(good < 0.98 * (count - hopeless))


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1])))
