"""Robots of a URDF keep clear of a scene; MuJoCo and Coal judge how near they come."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from station.core.errors import ParameterError, SwitchRefusedError
from station.core.geometry.scene import SceneObject
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.joint_command_modes import COMMAND_INTERFACES
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.hw.mujoco.robot_guard import _points
from station.memory.doubles import doubles
from tests.hw.coal_judge import CoalJudge

PERIOD, MARGIN = 0.001, 0.03
UR5 = "example-robot-data:ur5"
START = [0.0, -1.2, 1.2, 0.0, 0.5, 0.0]
BALL = SceneObject(
    "ball", "sphere", (0.1,), (0.35, 0.45, 0.35), role="keep_out", margin=MARGIN,
    solid=False,
)  # fmt: skip
FAR = replace(BALL, position=(-2.0, 0.0, 0.0))


class Bench:
    """A UR5 without a floor, commanded through one interface."""

    def __init__(self, description=UR5, **parameters):
        tree = ParameterTree({
            "robot": {"robot_description": description, "floor": False, **parameters}
        })
        self.hw = MujocoRobotHW()
        self.hw.init(Parameters(tree), Parameters(tree, "robot"))
        self.names = self.hw._names
        self.model = self.hw.world.model

    def begin(self, kind, scene):
        (guard,) = self.hw.guards()
        guard.prepare(scene, None)()
        self.switch(kind)
        interface = COMMAND_INTERFACES[kind]
        return [self.hw.get(interface).get_handle(name) for name in self.names]

    def switch(self, kind):
        claim = InterfaceResources(
            COMMAND_INTERFACES[kind].type_name, tuple(self.names)
        )
        start = [ControllerInfo(kind, "test/Controller", (claim,))]
        self.hw.prepare_switch(start, [])
        self.hw.do_switch(start, [])

    def distance_to(self, thing):
        """Return the least distance to a sphere that MuJoCo finds [m]."""
        data = self.hw.world.data
        found = []
        for geom in np.flatnonzero(self.model.geom_contype).tolist():
            if not self.model.body_weldid[self.model.geom_bodyid[geom]]:
                continue
            points, _ = _points(self.model, geom)
            axes = data.geom_xmat[geom].reshape(3, 3)
            local = (np.array(thing.position) - data.geom_xpos[geom]) @ axes
            found.append(_distance(points, local))
        return min(found) - thing.size[0]

    def run(self, kind, scene, way, seconds=0.5):
        """Move the joints there and further; return the ways and the least distance."""
        self.hw.simulated_world().reset(dict(zip(self.names, START, strict=True)))
        handles, q, closest = self.begin(kind, scene), [], np.inf
        cycles = round(seconds / PERIOD)
        for cycle in range(cycles + 200):
            t = min(1.0, cycle / cycles)
            share = t**3 * (10.0 - 15.0 * t + 6.0 * t * t)
            rate = 30.0 * t * t * (1.0 - t) ** 2 / seconds
            for handle, begin, step in zip(handles, START, way, strict=True):
                value = begin + share * step if kind == "position" else rate * step
                handle.set_command(value)
            self.hw.write(0.0, PERIOD)
            self.hw.read(0.0, PERIOD)
            q.append([*self.hw._joints.position])
            if cycle % 20 == 0:
                closest = min(closest, self.distance_to(BALL))
        return np.array(q), closest


def _distance(points, target):
    """Return the distance of a point to a convex hull, by Frank and Wolfe's steps."""
    at = points[np.argmin(np.linalg.norm(points - target, axis=1))]
    for _ in range(60):
        corner = points[np.argmin(points @ (at - target))]
        step = corner - at
        share = np.clip(step @ (target - at) / max(step @ step, 1e-15), 0.0, 1.0)
        at = at + share * step
    return np.linalg.norm(at - target)


@pytest.fixture(scope="module")
def bench():
    return Bench()


def test_a_robot_without_roles_is_near_nothing():
    (guard,) = Bench().hw.guards()

    assert guard.report() is None
    assert guard.nearest_at({"elbow_joint": 1.0}) is None


@pytest.mark.parametrize("kind", ["position", "velocity"])
def test_a_motion_into_the_ball_ends_at_its_margin(bench, kind):
    way = [1.0, 0.1, -0.1, 0.2, 0.0, 0.0]
    _, bare = bench.run(kind, [], way)
    q, closest = bench.run(kind, [BALL], way)
    told = bench.hw.guards()[0].report()
    assert bare < 0.0
    assert closest >= MARGIN - 1e-3
    by_coal = min(map(CoalJudge([BALL], UR5, ()).closest, q[::20]))
    assert by_coal == pytest.approx(closest, abs=1e-3)
    assert told.interventions > 0
    assert told.object == "ball"
    assert MARGIN - 1e-3 <= told.distance < MARGIN + 0.05


@pytest.mark.parametrize("kind", ["position", "velocity"])
def test_a_clear_motion_is_the_same_to_the_last_bit(bench, kind):
    way = [-0.8, 0.1, 0.2, 0.3, 0.1, 0.2]
    bare, _ = bench.run(kind, [], way)
    watched, _ = bench.run(kind, [BALL], way)
    assert bench.hw.guards()[0].report().interventions == 0
    assert watched.tobytes() == bare.tobytes()


def test_efforts_are_refused_by_the_names_of_the_joints(bench):
    bench.begin("position", [BALL])
    with pytest.raises(SwitchRefusedError, match=r"elbow_joint.* by efforts"):
        bench.switch("effort")
    bench.begin("position", [])
    bench.switch("effort")
    with pytest.raises(ParameterError, match=r"elbow_joint.* by efforts"):
        bench.hw.guards()[0].prepare([BALL], None)
    bench.switch("position")


@pytest.mark.parametrize(("before", "speed"), [([], 0.03), ([FAR], 0.5)])
def test_a_lag_is_no_speed_when_an_object_appears(bench, before, speed):
    bench.hw.simulated_world().reset(dict(zip(bench.names, START, strict=True)))
    handles, guard = bench.begin("position", before), bench.hw.guards()[0]
    for cycle in range(200):
        if cycle == 190:
            guard.prepare([replace(FAR, name="other")], None)()
        for handle, begin in zip(handles, START, strict=True):
            handle.set_command(begin + speed * PERIOD * cycle)
        bench.hw.write(0.0, PERIOD)
        if cycle >= 190:
            assert np.array(guard.guard.dq_d) == pytest.approx(speed, rel=0.2)
        bench.hw.read(0.0, PERIOD)


@pytest.mark.parametrize("name", ["double_pendulum", "simple_humanoid"])
def test_a_robot_without_motors_or_collision_geometry_has_no_guard(name):
    bench = Bench(f"example-robot-data:{name}")
    assert bench.hw.unguarded()


# A gripper with joints that follow another one; a branching robot that slides, too.
@pytest.mark.parametrize(
    "name",
    ["ur5_gripper", pytest.param("tiago_no_hand", marks=pytest.mark.slow)],
)
def test_capsules_enclose_the_links_wherever_they_are(name):
    bench = Bench(f"example-robot-data:{name}")
    (guard,) = bench.hw.guards()
    guard.prepare([FAR], None)()
    random, data = np.random.default_rng(3), mujoco.MjData(bench.model)
    near = guard.guard.clearances
    geoms = [
        geom
        for geom in np.flatnonzero(
            bench.model.geom_contype | bench.model.geom_conaffinity
        ).tolist()
        if bench.model.body_weldid[bench.model.geom_bodyid[geom]]
    ]
    for _ in range(5):
        q = random.uniform(-0.5, 0.5, len(guard._names))
        data.qpos[guard._qpos] = q
        for name, joint in guard._urdf.joints.items():
            if joint.mimic is not None:
                leader = data.joint(joint.mimic.joint).qpos[0]
                data.joint(name).qpos[0] = (
                    joint.mimic.multiplier * leader + joint.mimic.offset
                )
        mujoco.mj_kinematics(bench.model, data)
        near.measure(doubles(q), 0.0)
        ends = np.array(near.segments).reshape(-1, 2, 3)
        assert len(ends) == len(geoms)
        for k, geom in enumerate(geoms):
            points, reach = _points(bench.model, geom)
            points = points @ data.geom_xmat[geom].reshape(3, 3).T
            points = points + data.geom_xpos[geom]
            axis = ends[k, 1] - ends[k, 0]
            share = (points - ends[k, 0]) @ axis / max(axis @ axis, 1e-12)
            foot = ends[k, 0] + np.clip(share, 0.0, 1.0)[:, None] * axis
            far = np.linalg.norm(points - foot, axis=1) + reach
            assert far.max() <= near.capsules[7 * k + 6] + 1e-9
