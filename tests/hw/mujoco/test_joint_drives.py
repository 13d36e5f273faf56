"""Servos reach their target, keep their bounds and are stable, alike in both modes."""

from array import array
from itertools import pairwise
from types import SimpleNamespace

import mujoco
import pytest
from hypothesis import given, settings, strategies as st

from station.hw.mujoco import joint_drives
from station.hw.mujoco.joint_drives import DriveMode, JointDrives
from station.hw.mujoco.world import World
from station.memory.doubles import doubles, put
from tests.both_modes import both
from tests.core.hardware.limits.joints_of_limits import numbers, sizes

# A wheel of inertia 0.5 + 0.1 kg m^2 without weight.
WHEEL = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body><joint name="j" range="-2 2" limited="true" armature="0.1"
      solreflimit="0.002 1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.5 0.5 0.5"/></body>
  </worldbody>
  <actuator>
    <general name="j" joint="j" biastype="affine" forcerange="-20 20"
     forcelimited="true"/>
  </actuator>
</mujoco>
"""
MAX_VELOCITY = 3.0


class Bench:
    """The wheel and its drive, with every state on record."""

    def __init__(self, max_velocity: float = MAX_VELOCITY):
        self.world = World(mujoco.MjModel.from_xml_string(WHEEL))
        self.joints = self.world.joints(["j"])
        self.drives = JointDrives(self.joints, 0.001)
        self.drives.velocity_limits[0] = max_velocity
        self.world.add_actor(self.drives, self.drives)
        self.positions: list[float] = []
        self.velocities: list[float] = []

    def run(self, steps: int) -> None:
        for _ in range(steps):
            self.world.step()
            self.positions += self.joints.read_positions()
            self.velocities += self.joints.read_velocities()


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_position_is_reached_without_overshoot(bench):
    bench.drives.targets["position"][0] = 1.5
    bench.run(2000)
    assert bench.positions[-1] == pytest.approx(1.5, abs=1e-6)
    assert max(bench.positions) < 1.5 + 1e-3


def test_position_servo_keeps_the_velocity_limit(bench):
    bench.drives.targets["position"][0] = 1.9
    bench.drives.velocity_limits[0] = 0.5
    bench.run(1500)
    assert max(bench.velocities) == pytest.approx(0.5, rel=1e-3)


def test_velocity_changes_with_bounded_acceleration(bench):
    bench.drives.modes[0] = DriveMode.VELOCITY
    bench.drives.targets["velocity"][0] = 1.0
    bench.run(400)
    assert bench.velocities[-1] == pytest.approx(1.0, abs=1e-3)
    steps = [after - before for before, after in pairwise(bench.velocities)]
    # 0.3 of the effort over the inertia, and a tenth for the servo's lag
    assert max(steps) <= 1.1 * 0.3 * 20.0 / 0.6 * 0.001


def test_velocity_ends_before_the_range_does(bench):
    bench.drives.modes[0] = DriveMode.VELOCITY
    bench.drives.targets["velocity"][0] = 3.0
    bench.run(3000)
    assert 1.99 < max(bench.positions) < 2.001


def test_effort_is_passed_on(bench):
    bench.drives.modes[0] = DriveMode.EFFORT
    bench.drives.targets["effort"][0] = 6.0
    bench.run(100)
    assert bench.velocities[-1] == pytest.approx(6.0 / 0.6 * 0.1, rel=1e-9)


def test_effort_does_not_drive_beyond_the_velocity_limit(bench):
    bench.drives.modes[0] = DriveMode.EFFORT
    bench.drives.velocity_limits[0] = 1.0
    bench.drives.targets["effort"][0] = 20.0
    bench.run(300)
    # one step of full effort beyond the limit: 20 / 0.6 * 0.001
    assert 1.0 <= max(bench.velocities) < 1.04


def test_reset_forgets_targets(bench):
    bench.drives.targets["position"][0] = 1.0
    bench.run(50)
    bench.world.reset({"j": -1.0})
    bench.run(100)
    assert bench.positions[-1] == pytest.approx(-1.0, abs=1e-6)


MEMORY = ("qpos", "qvel", "bias", "weight", "inertia", "control", "damping")
TARGETS = ("position_target", "velocity_target", "effort_target")
LIMITS = ("velocity_limit", "effort_limit", "lower_limit", "upper_limit")
PLACES = ("qpos", "dof", "inertia", "control", "damping")


@st.composite
def worlds(draw):
    """Return the memory, places and doubles of two joints in a world of three."""
    memory = {name: [draw(numbers) for _ in range(3)] for name in MEMORY}
    memory["inertia"] = [draw(st.floats(1e-6, 1e3)) for _ in range(3)]
    places = {name: draw(st.permutations([0, 1, 2]))[:2] for name in PLACES}
    own = {name: [draw(numbers) for _ in range(2)] for name in TARGETS}
    own |= {name: [draw(sizes) for _ in range(2)] for name in LIMITS}
    own["mode"] = [float(draw(st.integers(0, 2))) for _ in range(2)]
    return memory, places, own


def act(module, world):
    """Return the memory and the doubles after a step, with every sign."""
    memory, places, own = world
    memory = {name: doubles(values) for name, values in memory.items()}
    places = {name: memoryview(array("q", values)) for name, values in places.items()}
    joints = SimpleNamespace(
        names=["joint"] * len(own["mode"]),
        memory=memory,
        places=places,
        effort_limits=own["effort_limit"],
        lower_limits=own["lower_limit"],
        upper_limits=own["upper_limit"],
        read_positions=lambda: own["position_target"],
    )
    drives = module.JointDrives(joints, 0.001)
    put(drives.modes, own["mode"])
    put(drives.velocity_limits, own["velocity_limit"])
    put(drives.targets["velocity"], own["velocity_target"])
    put(drives.targets["effort"], own["effort_target"])
    found = {}
    for step in range(2):  # the second one begins with a desired velocity
        drives.prepare_step()
        found |= {f"{name} {step}": repr([*view]) for name, view in memory.items()}
    return found


def test_both_modes_agree_to_the_bit():
    interpreted, compiled = both("joint_drives")

    @settings(derandomize=True)
    @given(worlds())
    def compare(world):
        assert act(interpreted, world) == act(compiled, world)

    compare()


def test_joint_is_read_and_driven_at_its_places():
    memory = {name: [0.0] * 3 for name in MEMORY} | {"inertia": [0.0, 0.0, 2.0]}
    memory |= {"qpos": [9.0, 0.25, 9.0], "bias": [5.0, 0.0, 0.0]}
    places = {"qpos": [1], "dof": [0], "inertia": [2], "control": [2], "damping": [0]}
    own = {name: [0.0] for name in (*TARGETS, "mode")}
    own |= {name: [1e9] for name in LIMITS} | {"position_target": [0.2500001]}

    after = act(joint_drives, (memory, places, own))

    # A servo of 1000/s over the inertia, 100/s from the target, and the bias.
    speed = 100.0 * (0.2500001 - 0.25)
    assert after["control 0"] == repr([0.0, 0.0, 2000.0 * speed + 5.0])
    assert after["damping 0"] == repr([-2000.0, 0.0, 0.0])
