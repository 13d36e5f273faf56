"""Pushes act where and how long they are asked to."""

import mujoco
import numpy as np
import pytest

from station.core.errors import HardwareInterfaceError
from station.hw.mujoco.world import AppliedPush, Push, World, as_push

# A rod of 1 m that hangs on a hinge about y, its centre of mass 0.5 m below.
ROD = """
<mujoco>
  <option timestep="0.001" gravity="0 0 0"/>
  <worldbody>
    <body name="rod" pos="0 0 2">
      <joint name="hinge" axis="0 1 0" damping="0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -1" size="0.02" mass="1"/>
    </body>
  </worldbody>
  <actuator><motor name="hinge" joint="hinge"/></actuator>
</mujoco>
"""


@pytest.fixture
def world():
    return World(mujoco.MjModel.from_xml_string(ROD))


def angular_acceleration(world):
    world.step()
    return world.data.qvel[0] / world.timestep


@pytest.mark.parametrize(
    ("push", "torque"),
    [
        (Push("rod", (1.0, 0.0, 0.0)), -0.5),
        (Push("rod", (1.0, 0.0, 0.0), point=(0.0, 0.0, -1.0)), -1.0),
        (Push("rod", (1.0, 0.0, 0.0), point=(0.0, 0.0, 0.0)), 0.0),
        (Push("rod", (0.0, 0.0, 0.0), (0.0, 2.0, 0.0)), 2.0),
    ],
)
def test_force_turns_the_rod_as_its_lever_says(world, push, torque):
    inertia = world.data.M[0]
    world.push(push, 1)
    assert angular_acceleration(world) * inertia == pytest.approx(torque, rel=1e-6)


def test_force_turns_with_the_frame_it_is_given_in(world):
    world.reset({"hinge": np.pi / 2})
    world.push(Push("rod", (1.0, 0.0, 0.0), frame="rod"), 1)
    assert angular_acceleration(world) * world.data.M[0] == pytest.approx(
        -0.5, rel=1e-6
    )
    world.reset({"hinge": np.pi / 2})
    world.push(Push("rod", (1.0, 0.0, 0.0)), 1)  # along the rod now
    assert angular_acceleration(world) == pytest.approx(0.0, abs=1e-9)


def test_push_ends_after_its_steps(world):
    world.push(Push("rod", (1.0, 0.0, 0.0)), 3)
    moved = []
    for _ in range(5):
        before = world.data.qvel[0]
        world.step()
        moved.append(abs(world.data.qvel[0] - before) > 1e-6)
    assert moved == [True] * 3 + [False] * 2


def test_pushes_can_be_ended_at_once(world):
    world.push(Push("rod", (1.0, 0.0, 0.0)), 1_000)
    world.end_pushes()
    assert angular_acceleration(world) == 0.0


def test_bodies_must_exist(world):
    for push in (Push("nose", (1.0, 0, 0)), Push("rod", (1.0, 0, 0), frame="nose")):
        with pytest.raises(HardwareInterfaceError, match="no body 'nose'"):
            AppliedPush(world.model, world.data, push, 1)


def test_numbers_are_copied():
    force = [1.0, 2.0, 3.0]
    push = as_push("rod", force, [0.0] * 3, point=force)
    force[0] = 9.0
    assert (push.force, push.point) == ((1.0, 2.0, 3.0), (1.0, 2.0, 3.0))
