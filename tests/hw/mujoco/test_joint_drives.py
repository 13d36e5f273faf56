"""Servos that reach their target, keep their bounds, and are stable."""

from itertools import pairwise

import mujoco
import pytest

from station.hw.mujoco.joint_drives import DriveMode, JointDrives
from station.hw.mujoco.world import World

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
        self.world.add_actor(self.drives)
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
    bench.drives.position_target[0] = 1.5
    bench.run(2000)
    assert bench.positions[-1] == pytest.approx(1.5, abs=1e-6)
    assert max(bench.positions) < 1.5 + 1e-3


def test_position_servo_keeps_the_velocity_limit(bench):
    bench.drives.position_target[0] = 1.9
    bench.drives.velocity_limits[0] = 0.5
    bench.run(1500)
    assert max(bench.velocities) == pytest.approx(0.5, rel=1e-3)


def test_velocity_changes_with_bounded_acceleration(bench):
    bench.drives.modes[0] = DriveMode.VELOCITY
    bench.drives.velocity_target[0] = 1.0
    bench.run(400)
    assert bench.velocities[-1] == pytest.approx(1.0, abs=1e-3)
    steps = [after - before for before, after in pairwise(bench.velocities)]
    # 0.3 of the effort over the inertia, and a tenth for the servo's lag
    assert max(steps) <= 1.1 * 0.3 * 20.0 / 0.6 * 0.001


def test_velocity_ends_before_the_range_does(bench):
    bench.drives.modes[0] = DriveMode.VELOCITY
    bench.drives.velocity_target[0] = 3.0
    bench.run(3000)
    assert 1.99 < max(bench.positions) < 2.001


def test_effort_is_passed_on(bench):
    bench.drives.modes[0] = DriveMode.EFFORT
    bench.drives.effort_target[0] = 6.0
    bench.run(100)
    assert bench.velocities[-1] == pytest.approx(6.0 / 0.6 * 0.1, rel=1e-9)


def test_effort_does_not_drive_beyond_the_velocity_limit(bench):
    bench.drives.modes[0] = DriveMode.EFFORT
    bench.drives.velocity_limits[0] = 1.0
    bench.drives.effort_target[0] = 20.0
    bench.run(300)
    # one step of full effort beyond the limit: 20 / 0.6 * 0.001
    assert 1.0 <= max(bench.velocities) < 1.04


def test_reset_forgets_targets(bench):
    bench.drives.position_target[0] = 1.0
    bench.run(50)
    bench.world.reset({"j": -1.0})
    bench.run(100)
    assert bench.positions[-1] == pytest.approx(-1.0, abs=1e-6)
