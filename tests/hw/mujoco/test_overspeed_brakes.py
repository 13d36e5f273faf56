"""Brakes: they end overspeed, take energy out, and leave the rest alone."""

import mujoco
import numpy as np
import pytest

from station.hw.mujoco.stops_and_brakes import OVERSPEED, OverspeedBrakes

# Three links in a row, and a ball that flies by itself.
CHAIN = """
<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.001" integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body><joint name="a" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 1 0 0"
      size="0.05"/>
      <body pos="1 0 0"><joint name="b" axis="0 1 0"/><geom type="capsule"
        fromto="0 0 0 1 0 0" size="0.05"/>
        <body pos="1 0 0"><joint name="c" type="slide" axis="1 0 0"/>
          <geom size="0.1"/></body>
      </body>
    </body>
    <body pos="0 0 9"><freejoint/><geom size="0.1"/></body>
  </worldbody>
</mujoco>
"""
LIMITS = {0: 1.0, 1: 2.0, 2: 0.5}
BOUNDS = np.array([OVERSPEED * limit for limit in LIMITS.values()])


class Bench:
    """The chain after one step, and its brakes."""

    def __init__(self) -> None:
        self.model = mujoco.MjModel.from_xml_string(CHAIN)
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:3] = [0.3, -0.8, 0.1]
        mujoco.mj_step(self.model, self.data)
        self.brakes = OverspeedBrakes(self.model, self.data)
        self.brakes.set_limits(LIMITS)
        self.inertia = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, self.inertia)

    def energy(self) -> float:
        return float(self.data.qvel @ self.inertia @ self.data.qvel) / 2.0


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_within_the_bounds_nothing_acts(bench: Bench) -> None:
    velocities = [1.0, -2.0, 0.5, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0]
    bench.data.qvel[:] = velocities
    before = bench.data.qpos.tolist()
    bench.brakes.act()
    assert bench.data.qvel.tolist() == velocities
    assert bench.data.qpos.tolist() == before
    assert bench.brakes.braked_steps == 0


@pytest.mark.parametrize("seed", range(20))
def test_impulses_obey_the_equations(bench: Bench, seed: int) -> None:
    before = np.random.default_rng(seed).normal(0.0, 3.0, bench.model.nv)
    bench.data.qvel[:] = before
    energy = bench.energy()
    position = bench.data.qpos.copy()
    bench.brakes.act()
    after = bench.data.qvel.copy()
    # 1e-5: the tolerance of the search, over the inertia's condition.
    assert np.all(np.abs(after[:3]) <= BOUNDS * (1.0 + 1e-5))
    impulses = bench.inertia @ (after - before)
    assert bench.brakes.forces == pytest.approx(impulses / 0.001, abs=1e-6)
    assert np.all(impulses[3:] == 0.0)
    for impulse, velocity, bound in zip(impulses, after, BOUNDS, strict=False):
        if abs(velocity) < bound * (1.0 - 1e-5):
            assert impulse == pytest.approx(0.0, abs=1e-9)
        else:
            assert impulse * velocity <= 1e-9
    assert bench.energy() <= energy
    moved = bench.data.qpos - position
    assert moved[:3] == pytest.approx(0.001 * (after - before)[:3], abs=1e-12)
    assert np.all(moved[3:] == 0.0)


def test_brake_of_one_joint_moves_coupled_joints(
    bench: Bench,
) -> None:
    bench.data.qvel[:3] = [3.0, 0.0, 0.0]
    bench.brakes.act()
    # The first link is stopped; the second one swings on.
    assert bench.data.qvel[0] == pytest.approx(OVERSPEED)
    assert bench.data.qvel[1] > 0.5


def test_brake_forces_belong_to_the_last_step(bench: Bench) -> None:
    bench.data.qvel[0] = 3.0
    bench.brakes.act()
    assert bench.brakes.forces[0] < 0.0
    bench.data.qvel[:] = 0.0
    bench.brakes.act()
    assert bench.brakes.forces.tolist() == [0.0] * bench.model.nv
    assert bench.brakes.braked_steps == 1


def test_joint_without_a_limit_is_left_alone(bench: Bench) -> None:
    bench.brakes.set_limits({1: np.inf})
    bench.data.qvel[:3] = [0.0, 50.0, 0.0]
    bench.brakes.act()
    assert bench.data.qvel[1] == 50.0


def test_joint_velocity_that_is_not_finite_is_not_braked(bench: Bench) -> None:
    bench.data.qvel[0] = np.nan
    bench.brakes.act()
    assert bench.brakes.braked_steps == 0


def test_what_was_braked_is_reported_joint_by_joint(bench: Bench) -> None:
    assert bench.brakes.clamps("ab") == []
    for velocity in (3.0, -4.0):
        bench.data.qvel[:3] = [velocity, 0.0, 0.0]
        bench.brakes.act()
    (report,) = [one for one in bench.brakes.clamps("ab") if one.last.joint == "a"]
    assert report.hardware_interface == "simulated brakes"
    assert report.count == 2
    assert report.last.asked == -4.0
    assert report.last.given == pytest.approx(-OVERSPEED)


def test_a_brake_carries_no_joint_past_its_stop(bench: Bench) -> None:
    """The second joint stands at its end; slowing the first one down swings it on."""
    model, data = bench.model, bench.data
    model.jnt_limited[1], model.jnt_range[1] = 1, [-3.0, float(data.qpos[1])]
    brakes = OverspeedBrakes(model, data)
    brakes.set_limits(LIMITS)
    data.qvel[:3] = [3.0, 0.0, 0.0]
    position, energy = float(data.qpos[1]), bench.energy()
    brakes.act()
    assert data.qvel[0] == pytest.approx(OVERSPEED)
    assert data.qvel[1] == pytest.approx(0.0, abs=1e-5)
    assert data.qpos[1] == pytest.approx(position, abs=1e-8)
    assert bench.energy() < energy
    assert brakes.forces[0] < 0.0
    assert brakes.forces[1] == 0.0, "the force of a stop is none of a brake"
