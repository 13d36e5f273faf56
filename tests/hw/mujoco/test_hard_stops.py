"""Fast joints stop at the ends of their range."""

from math import degrees

import mujoco
import pytest

from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.hw.mujoco.stops_and_brakes import HardStops
from station.hw.mujoco.world import World
from station.testing import Bench

ARM = """<robot name="r"><link name="base"/>
<link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="hand"><inertial><origin xyz="0.1 0 0"/><mass value="0.5"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="{effort}" velocity="{fast}"/>
</joint><joint name="k" type="continuous"><parent link="arm"/><child link="hand"/>
<origin xyz="0.4 0 0"/><axis xyz="0 0 1"/></joint></robot>"""


def make(tmp_path, effort: float, fast: float) -> Bench:
    path = tmp_path / "r.urdf"
    path.write_text(ARM.format(effort=effort, fast=fast), encoding="utf-8")
    bench = Bench(MujocoRobotHW(), {"robot_description": str(path)})
    kind = "effort_controllers/JointEffortController"
    bench.load_controller("push", kind, joint="j")
    return bench


def energy(world: World) -> float:
    mujoco.mj_energyVel(world.model, world.data)
    return float(world.data.energy[1])


@pytest.mark.parametrize(
    ("effort", "fast"), [(100.0, 30.0), (5.0, 52.0), (5000.0, 10_000.0)]
)
def test_stop_yields_by_less_than_half_a_degree(tmp_path, effort, fast) -> None:
    bench = make(tmp_path, effort, fast)
    bench.switch(start=["push"])
    joint = bench.robot.world.data.joint("j")
    worst = 0.0
    for sign in (1.0, -1.0):
        bench.manager.get_controller("push").set_points.post([sign * effort])
        for _ in range(1500):
            bench.step()
            worst = max(worst, abs(float(joint.qpos[0])) - 1.0)
    assert float(joint.qpos[0]) == pytest.approx(-1.0, abs=0.01)
    assert degrees(worst) < 0.5


def test_impact_removes_energy(tmp_path) -> None:
    """A plastic impact: what the other joint keeps is less than there was."""
    world = make(tmp_path, 5.0, 30.0).robot.world
    world.data.joint("j").qpos[0] = 0.99
    world.data.joint("j").qvel[0] = 25.0
    before = energy(world)
    HardStops(world.model, world.data, ["j"]).prepare_step()
    assert world.data.joint("j").qvel[0] == pytest.approx(10.0)
    assert 0.0 < energy(world) < before
