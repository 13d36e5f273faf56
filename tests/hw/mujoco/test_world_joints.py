"""Joints of the world as plain floats, in a row in memory or not."""

import mujoco
import numpy as np
import pytest

from station.core.errors import HardwareInterfaceError
from station.hw.mujoco.world_joints import WorldJoints, joint_position_address

# Three joints in a chain; `slide` moves along x, `wheel` has no limits.
CHAIN = """
<mujoco>
  <compiler angle="radian"/>
  <worldbody>
    <body><joint name="hinge" range="-1 2" limited="true" damping="0.1"/>
      <geom size="0.1"/>
      <body><joint name="slide" type="slide" axis="1 0 0" armature="0.5"/>
        <geom size="0.1"/>
        <body><joint name="wheel"/><geom size="0.1"/></body>
      </body>
    </body>
    <body pos="0 0 9"><freejoint name="free"/><geom size="0.1"/></body>
  </worldbody>
  <actuator>
    <general name="hinge" joint="hinge" biastype="affine" forcerange="-3 3"
     forcelimited="true"/>
    <general name="slide" joint="slide" biastype="affine"/>
    <general name="wheel" joint="wheel" biastype="affine"/>
  </actuator>
</mujoco>
"""


def control(data: mujoco.MjData, joints: WorldJoints, values: list[float]) -> None:
    data.ctrl[np.asarray(joints.places["control"])] = values


@pytest.fixture
def model() -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(CHAIN)


@pytest.mark.parametrize("names", [["hinge", "slide"], ["wheel", "hinge"]])
def test_values_come_in_the_order_of_the_names(
    model: mujoco.MjModel, names: list[str]
) -> None:
    data = mujoco.MjData(model)
    joints = WorldJoints(model, data, names)
    control(data, joints, [1.0, 2.0])
    mujoco.mj_step(model, data)
    assert joints.read_motor_forces() == [1.0, 2.0]
    assert joints.read_positions() == [data.joint(n).qpos[0] for n in names]
    assert joints.read_velocities() == [data.joint(n).qvel[0] for n in names]


def test_reading_hands_out_copies(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    joints = WorldJoints(model, data, ["hinge", "slide", "wheel"])
    positions = joints.read_positions()
    positions[0] = 9.0
    data.qpos[1] = 0.25
    assert joints.read_positions() == [0.0, 0.25, 0.0]
    assert all(type(value) is float for value in joints.read_positions())


def test_joint_properties_are_read_from_the_model(model: mujoco.MjModel) -> None:
    joints = WorldJoints(model, mujoco.MjData(model), ["hinge", "slide"])
    infinity = float("inf")
    assert joints.lower_limits == [-1.0, -infinity]
    assert joints.upper_limits == [2.0, infinity]
    assert joints.effort_limits == [3.0, infinity]
    assert joints.damping == [0.1, 0.0]
    assert joints.armature == [0.0, 0.5]


def test_inertia_is_the_diagonal_of_the_full_matrix(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    data.qpos[:3] = [0.3, 0.2, 0.1]
    mujoco.mj_forward(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    joints = WorldJoints(model, data, ["wheel", "hinge", "slide"])
    assert joints.read_inertia() == pytest.approx([full[2, 2], full[0, 0], full[1, 1]])


def test_servo_pulls_to_its_target_and_can_be_taken_off(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    joints = WorldJoints(model, data, ["slide"])
    joints.set_servo([100.0], [20.0])
    control(data, joints, [100.0 * 0.1])
    mujoco.mj_forward(model, data)
    assert joints.read_motor_forces() == [10.0]
    joints.set_servo([0.0], [0.0])
    data.qpos[1] = 0.7
    mujoco.mj_forward(model, data)
    assert joints.read_motor_forces() == [10.0]


@pytest.mark.parametrize("name", ["free", "nothing"])
def test_joint_with_several_degrees_of_freedom_is_refused(
    model: mujoco.MjModel, name: str
) -> None:
    with pytest.raises(HardwareInterfaceError, match=f"slide joint '{name}'"):
        joint_position_address(model, name)


def test_motors_give_no_more_than_their_new_limit(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    joints = WorldJoints(model, data, ["hinge", "slide"])
    joints.set_effort_limits([5.0, 2.0])
    control(data, joints, [9.0, -9.0])

    mujoco.mj_step(model, data)

    assert joints.effort_limits == [5.0, 2.0]
    assert joints.read_motor_forces() == [5.0, -2.0]
