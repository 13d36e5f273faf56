"""Seeded motions of a simulated arm past objects; MuJoCo and Coal are their judges.

A command makes 40 motions of each of five kinds, or of some, twice each:

    python -m tests.hw.franka.guarded_motions 40
"""

import sys
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import product
from math import pi

import mujoco
import numpy as np

from station.core.franka.franka_robot_state import RobotMode
from station.core.geometry.scene import SceneObject
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.arm_limits import PANDA_LIMITS
from station.hw.franka.franka_combined_hw import FrankaCombinedHW
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.simulated.franka_world import placement_of, simulate
from tests.hw.coal_judge import CoalJudge

TOLERANCE = 1e-3
"""A pose is sampled every 10 ms, and MuJoCo's distances end within 1e-6 m."""
ARM_MARGIN = 0.05
# Bare motions that come as near as that may be slowed: the capsules are thicker than
# the links, and the guard looks ahead of the motion.
_CLEAR = 0.13
PERIOD = 0.001
MARGIN = 0.03
KINDS = ("position", "velocity", "pose", "twist", "torque")
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
READY = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
# Stiffness and damping of the impedance controller in the torque motions.
K = np.array([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0])
D = np.array([50.0, 50.0, 50.0, 50.0, 30.0, 25.0, 15.0])
_INTERFACES = {
    "position": "PositionJointInterface",
    "velocity": "VelocityJointInterface",
    "torque": "EffortJointInterface",
    "pose": "FrankaPoseCartesianInterface",
    "twist": "FrankaVelocityCartesianInterface",
}


def _thing(name, kind, size, position, rpy=(0.0, 0.0, 0.0), role="keep_out"):
    return SceneObject(
        name, kind, size, position, rpy, role=role, margin=MARGIN, solid=False
    )


SCENE = [
    _thing("table", "box", (0.5, 1.4, 0.2), (0.75, 0.0, 0.0)),
    _thing("pillar", "cylinder", (0.06, 1.4), (0.35, 0.55, 0.7)),
    _thing("post", "capsule", (0.05, 1.0), (0.3, -0.55, 0.5)),
    _thing("ball", "sphere", (0.12,), (0.75, 0.15, 0.6)),
    _thing("bar", "capsule", (0.03, 0.8), (0.75, -0.3, 0.75), (pi / 2, 0.0, 0.3)),
    _thing("shelf", "box", (0.3, 0.5, 0.04), (0.45, 0.0, 1.05), (0.2, 0.1, 0.0)),
    _thing("case", "box", (0.2, 0.2, 0.5), (-0.45, 0.35, 0.6), (0.0, 0.3, 0.5)),
    _thing("drum", "cylinder", (0.15, 0.4), (-0.4, -0.4, 0.5), (0.4, 0.0, 0.0)),
    _thing("ground", "half_space", (), (0.0, 0.0, -0.1)),
    _thing("wall", "half_space", (), (0.0, 0.95, 0.0), (pi / 2, 0.0, 0.0)),
]


@dataclass
class Outcome:
    """How a motion went.

    Attributes:
        q: Joint positions in each cycle [rad], shape (n, 7).
        closest: Least distance to an object that MuJoCo finds [m].
        by_coal: The same by Coal, at as many poses as were asked for [m].
        mode: Mode of the arm at the end.
        refusal: Why the motion ended early.
        interventions: Cycles in which the guard changed a command.
    """

    q: np.ndarray
    closest: float
    by_coal: float
    mode: RobotMode
    refusal: str | None
    interventions: int


class Motions:
    """One arm that makes motions, with or without its guard."""

    def __init__(self, scene=SCENE, **parameters) -> None:
        tree = ParameterTree({
            "robot": {
                "arm_id": "panda",
                "robot_description": "example-robot-data:panda",
                "realism": "ideal",
                **parameters,
            }
        })
        self._running: list[ControllerInfo] = []
        self.hw = FrankaHW()
        self.hw.init(Parameters(tree), Parameters(tree, "robot"))
        self.guarded = self.hw.guards()[0].prepare(scene, None)
        self.bare = self.hw.guards()[0].prepare([], None)
        self.world = self.hw.simulated_world()
        solid = [replace(one, solid=True) for one in scene]
        self.model = simulate(
            [placement_of(self.hw.parameters)], objects=solid
        ).world.model
        self.data = mujoco.MjData(self.model)
        self.coal = CoalJudge(scene)
        names = {one.name for one in scene}
        self.pairs = [
            (arm, thing)
            for thing in range(self.model.ngeom)
            if self.model.body(self.model.geom_bodyid[thing]).name in names
            for arm in range(self.model.ngeom)
            if self.model.body(self.model.geom_bodyid[arm]).name.startswith("panda")
            and not self.model.body(self.model.geom_bodyid[arm]).name.endswith("link0")
        ]

    def closest(self, q) -> float:
        """Return the least distance of the arm to an object by MuJoCo [m]."""
        for name, value in zip(JOINTS, q, strict=True):
            self.data.joint(name).qpos[0] = value
        for finger in (1, 2):
            self.data.joint(f"panda_finger_joint{finger}").qpos[0] = 0.04
        mujoco.mj_kinematics(self.model, self.data)
        return min(
            mujoco.mj_geomDistance(self.model, self.data, a, b, 0.2, None)
            for a, b in self.pairs
        )

    def start(self, seed: int) -> np.ndarray:
        """Return a start pose that is clear of everything."""
        random = np.random.default_rng(seed)
        while True:
            q = READY + random.uniform(-0.5, 0.5, 7)
            if self.closest(q) > MARGIN + 0.07:
                return q

    def begin(self, kind: str, seed: int, *, guarded: bool) -> np.ndarray:
        """Put the arm to the start of a motion and switch to its kind of command."""
        q0, hw = self.start(seed), self.hw
        if self._running:
            hw.do_switch([], self._running)
        if hw.robot_state.robot_mode is RobotMode.REFLEX:
            hw.arm.automatic_error_recovery()
        while hw.robot_state.robot_mode is not RobotMode.IDLE:
            hw.read(0.0, PERIOD)
        self.world.reset(dict(zip(JOINTS, q0.tolist(), strict=True)))
        (self.guarded if guarded else self.bare)()
        resources = ["panda_robot"] if kind in ("pose", "twist") else JOINTS
        interface = next(
            one for one in hw.interface_types() if one.__name__ == _INTERFACES[kind]
        )
        claims = (InterfaceResources(interface.type_name, tuple(resources)),)
        self._running = [ControllerInfo(kind, "test/Controller", claims)]
        for _ in range(50):
            hw.read(0.0, PERIOD)
            hw.write(0.0, PERIOD)
        hw.prepare_switch(self._running, [])
        hw.do_switch(self._running, [])
        self.handles = [hw.get(interface).get_handle(name) for name in resources]
        return q0

    def aim(self, q0: np.ndarray, seed: int):
        """Return the way of the joints and of the end effector, and its pose."""
        random = np.random.default_rng(1000 + seed)
        lower, upper = np.array(PANDA_LIMITS.lower), np.array(PANDA_LIMITS.upper)
        while True:
            way = random.uniform(-1.0, 1.0, 7)
            way *= np.array([1.2, 0.8, 0.8, 0.8, 1, 0.8, 1])
            way = np.clip(q0 + way, lower + 0.15, upper - 0.15) - q0
            # Half of the motions end in an object.
            if seed % 2 or self.closest(q0 + way) < MARGIN:
                break
        turn = random.uniform(-1.0, 1.0, 6) * np.array([0.4, 0.4, 0.4, 0.3, 0.3, 0.3])
        pose0 = np.array(self.hw.robot_state.O_T_EE)
        if seed % 2 == 0:
            goal = np.array(SCENE[seed // 2 % 4].pose().xyz) - pose0[12:15]
            turn[:3] = goal * min(1.0, 0.45 / np.linalg.norm(goal))
        return way, turn, pose0

    def run(
        self, kind: str, seed: int, *, guarded: bool, time: float = 1.6, every: int = 0
    ) -> Outcome:
        """Make a motion.

        Args:
            kind: Kind of command.
            seed: Of the motion.
            guarded: Whether the guard watches.
            time: How long the command changes [s].
            every: Cycles between two looks of Coal; 0 for none.
        """
        q0, hw = self.begin(kind, seed, guarded=guarded), self.hw
        way, turn, pose0 = self.aim(q0, seed)
        found = []
        cycles = round(time / PERIOD)
        for cycle in range(cycles + 300):
            t = min(1.0, cycle / cycles)
            share = t**3 * (10.0 - 15.0 * t + 6.0 * t * t)
            rate = 30.0 * t * t * (1.0 - t) ** 2 / time
            state = hw.robot_state
            if kind == "position":
                values = q0 + share * way
            elif kind == "velocity":
                values = rate * way
            elif kind == "torque":
                values = K * (q0 + share * way - state.q) + D * (
                    rate * way - np.array(state.dq)
                )
            elif kind == "pose":
                values = pose0.copy()
                values[12:15] += share * turn[:3]
            else:
                values = rate * turn
            if kind in ("pose", "twist"):
                values = [[*values]]
            for handle, value in zip(self.handles, values, strict=True):
                handle.set_command(value)
            hw.write(0.0, PERIOD)
            hw.read(0.0, PERIOD)
            found.append(hw.robot_state.q)
        closest = min(self.closest(q) for q in found[::10])
        guard = hw.guards()[0].guard
        return Outcome(
            np.array(found),
            closest,
            min(map(self.coal.closest, found[::every])) if every else np.inf,
            hw.robot_state.robot_mode,
            hw._sender.refusal,
            guard.interventions,
        )


class TwoArms:
    """Two arms side by side that swing at each other by torques."""

    def swing(self, seed: int, *, guarded: bool) -> float:
        """Return the least distance of the two by MuJoCo in a motion [m]."""
        random = np.random.default_rng(seed)
        sides = {"left": (0.0, 0.0, 0.0), "right": (0.0, 0.7, 0.0)}
        arms = {
            name: {
                "arm_id": name,
                "robot_description": "example-robot-data:panda",
                "realism": "ideal",
                "base_xyz": list(place),
                "initial_positions": READY.tolist(),
            }
            for name, place in sides.items()
        }
        tree = ParameterTree({"robot": {"robot_hardware": [*arms], **arms}})
        hw = FrankaCombinedHW()
        hw.init(Parameters(tree), Parameters(tree, "robot"))
        for guard in hw.guards() if guarded else ():
            guard.prepare([], ARM_MARGIN)()
        world = hw.simulated_world().world
        model, data = world.model, mujoco.MjData(world.model)
        geoms = {
            side: [
                one
                for one in range(model.ngeom)
                if model.body(model.geom_bodyid[one]).name.startswith(side)
                and model.geom_contype[one]
            ]
            for side in sides
        }
        interface = next(
            one for one in hw.interface_types() if one.__name__ == _INTERFACES["torque"]
        )
        names = [f"{side}_joint{k}" for side in sides for k in range(1, 8)]
        claims = (InterfaceResources(interface.type_name, tuple(names)),)
        running = [ControllerInfo("torque", "test/Controller", claims)]
        for _ in range(50):
            hw.read(0.0, PERIOD)
            hw.write(0.0, PERIOD)
        hw.prepare_switch(running, [])
        hw.do_switch(running, [])
        handles = [hw.get(interface).get_handle(name) for name in names]
        closest = np.inf
        turns = [sign * random.uniform(0.8, 1.3) for sign in (1.0, -1.0)]
        others = random.uniform(-0.2, 0.2, (2, 6))
        way = np.concatenate([[turns[0]], others[0], [turns[1]], others[1]])
        stiff, damped = np.tile(K, 2), np.tile(D, 2)
        begin = np.tile(READY, 2)
        for cycle in range(1500):
            t = min(1.0, cycle / 1200)
            share, rate = t**3 * (10 - 15 * t + 6 * t * t), 25 * t * t * (1 - t) ** 2
            states = [robot.robot_state for robot in hw.arms]
            q = np.concatenate([one.q for one in states])
            dq = np.concatenate([one.dq for one in states])
            values = stiff * (begin + share * way - q) - damped * (dq - rate * way)
            for handle, value in zip(handles, values.tolist(), strict=True):
                handle.set_command(value)
            hw.write(0.0, PERIOD)
            hw.read(0.0, PERIOD)
            if cycle % 10 == 0:
                data.qpos[:] = world.data.qpos
                mujoco.mj_kinematics(model, data)
                for one, other in product(geoms["left"], geoms["right"]):
                    far = mujoco.mj_geomDistance(model, data, one, other, 0.3, None)
                    closest = min(closest, far)
        return closest


def check(
    motions: Motions, kinds: Iterable[str], seeds: Iterable[int], every: int
) -> tuple[int, int]:
    """Return how many motions came too near without the guard, and how many were free.

    Checks that none comes too near with it, and that free ones are the same bits.

    Args:
        motions: Makes them.
        kinds: Kinds of commands.
        seeds: Seeds of the motions.
        every: Cycles between two looks of Coal.
    """
    near = free = 0
    for kind in kinds:
        for seed in seeds:
            bare = motions.run(kind, seed, guarded=False)
            guarded = motions.run(kind, seed, guarded=True, every=every)
            where = f"{kind} {seed}"
            assert guarded.closest >= MARGIN - TOLERANCE, where
            assert guarded.by_coal >= MARGIN - TOLERANCE, where
            # What the arm can follow is slowed, not ended; torques may end in a reflex.
            if kind != "torque" and bare.mode is RobotMode.MOVE:
                assert guarded.mode is RobotMode.MOVE, f"{where}: {guarded.refusal}"
            near += bare.closest < MARGIN
            if guarded.interventions == 0:
                free += 1
                assert guarded.q.tobytes() == bare.q.tobytes(), where
            else:
                assert bare.closest <= _CLEAR, f"{where} was slowed, far away"
    return near, free


if __name__ == "__main__":
    made = Motions()
    for one in sys.argv[2:] or KINDS:
        found = check(made, [one], range(int(sys.argv[1])), every=10)
        sys.stdout.write(f"{one}: {found[0]} bare ones too near, {found[1]} free\n")
        sys.stdout.flush()
