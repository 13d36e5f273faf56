"""The world steps, rests, resets and says when it has diverged."""

from math import pi
from pathlib import Path

import mujoco
import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import HardwareInterfaceError
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.mujoco.world import World
from station.hw.mujoco.world_joints import WorldJoints
from station.hw.mujoco.world_step import Preparation
from station.hw.urdf_loader import load_urdf

ARM = [f"panda_joint{number}" for number in range(1, 8)]
START = [0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4]


def control(world: World, joints: WorldJoints, values: list[float]) -> None:
    world.data.ctrl[np.asarray(joints.places["control"])] = values


@pytest.fixture
def world() -> World:
    spec = new_world(0.001)
    urdf = load_urdf(load_robot_files("example-robot-data:panda"))
    add_robot(spec, urdf, RobotOptions())
    world = World(compile_world(spec))
    world.begin_at(dict(zip(ARM, START, strict=True)))
    return world


class RecordingActor(Preparation):
    """Remembers what it was told."""

    def __init__(self) -> None:
        self.calls: list[str] = []

    def prepare_step(self) -> None:
        """Remember the step."""
        self.calls.append("prepare_step")

    def after_reset(self) -> None:
        """Remember the reset."""
        self.calls.append("after_reset")


def test_step_keeps_the_interpreter_lock(world: World) -> None:
    assert world.keeps_interpreter_lock


def test_compensated_arm_stays_for_ten_seconds(world: World) -> None:
    joints = world.joints(ARM)
    for _ in range(10_000):
        world.step()
    # Nothing pulls but rounding: 1e4 steps of 1e-16.
    assert joints.read_positions() == pytest.approx(START, abs=1e-10)
    assert world.time == pytest.approx(10.0)


def test_energy_is_kept_by_an_undamped_swing(world: World) -> None:
    model, data = world.model, world.data
    model.dof_damping[:] = 0.0
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data.qvel[:7] = [0.3, -0.2, 0.3, 0.2, 0.3, 0.2, 0.3]
    mujoco.mj_forward(model, data)
    before = data.energy[1]
    for _ in range(500):
        world.step()
    # Compensated gravity does no net work; first-order integration errs by ~ dt.
    assert data.energy[1] == pytest.approx(before, rel=0.01)


def test_joints_are_read_and_driven_in_the_order_asked(world: World) -> None:
    backwards = world.joints(ARM[::-1])
    assert backwards.read_positions() == START[::-1]
    control(world, backwards, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])
    world.step()
    assert world.joints(ARM).read_motor_forces() == [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]
    assert backwards.effort_limits == [12.0, 12.0, 12.0, 87.0, 87.0, 87.0, 87.0]


def test_motor_force_saturates_at_the_effort_limit(world: World) -> None:
    joints = world.joints(ARM)
    control(world, joints, [500.0, 0.0, 0.0, 0.0, 0.0, 0.0, -500.0])
    world.step()
    assert joints.read_motor_forces() == [87.0, 0.0, 0.0, 0.0, 0.0, 0.0, -12.0]


def test_stiff_servo_is_stable_and_comes_to_rest(world: World) -> None:
    joints = world.joints(ARM)
    stiffness = [3000.0] * 7
    joints.set_servo(stiffness, [2000.0] * 7)
    target = [q + 0.1 for q in START]
    control(world, joints, [k * q for k, q in zip(stiffness, target, strict=True)])
    for _ in range(8_000):
        world.step()
    assert joints.read_positions() == pytest.approx(target, abs=1e-4)


def test_mechanical_stop_holds_against_full_torque(world: World) -> None:
    joints = world.joints(ARM)
    control(world, joints, [87.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    overshoot = 0.0
    for _ in range(2_000):
        world.step()
        overshoot = max(overshoot, joints.read_positions()[0] - 2.8973)
    # At rest against the stop; the impact at some 10 rad/s may go deeper.
    assert joints.read_positions()[0] - 2.8973 < 1e-3
    assert overshoot < 0.1


@pytest.mark.parametrize("name", ["panda_joint9", "panda_hand_joint", ""])
def test_unknown_joint_is_refused_with_the_known_ones(world: World, name: str) -> None:
    with pytest.raises(HardwareInterfaceError, match=f"joint '{name}'") as caught:
        world.joints([name])
    assert "panda_joint7" in caught.value.remedy


def test_mimic_joint_has_no_motor(world: World) -> None:
    with pytest.raises(HardwareInterfaceError, match="'panda_finger_joint2' has no"):
        world.joints(["panda_finger_joint2"])


def test_actors_act_once_per_step_and_hear_of_a_reset(world: World) -> None:
    actor = RecordingActor()
    world.add_actor(actor, actor)
    world.step()
    world.step()
    world.reset()
    assert actor.calls == ["prepare_step", "prepare_step", "after_reset"]


def test_reset_puts_joints_elsewhere_once(world: World) -> None:
    world.reset({ARM[1]: 0.1})
    assert world.joints(ARM).read_positions() == [START[0], 0.1, *START[2:]]
    world.reset({ARM[0]: 0.2})
    assert world.joints(ARM).read_positions() == [0.2, *START[1:]]


def test_reset_returns_to_the_start(world: World) -> None:
    world.data.qvel[:7] = 1.0
    for _ in range(100):
        world.step()
    steps = world.step_count
    world.reset()
    assert world.joints(ARM).read_positions() == START
    assert world.joints(ARM).read_velocities() == [0.0] * 7
    assert (world.time, world.step_count) == (0.0, steps)


@pytest.mark.parametrize("velocity", [float("nan"), float("inf"), 1e6])
def test_diverged_world_stands_still_until_it_is_reset(
    world: World, velocity: float
) -> None:
    world.data.qvel[2] = velocity
    world.step()
    assert "diverged at" in world.diverged_because
    world.step()
    assert world.joints(ARM).read_positions() == START
    assert (world.time, world.step_count) == (0.0, 2)
    world.reset()
    world.step()
    assert world.diverged_because is None
    assert world.time == pytest.approx(0.001)


def test_divergence_leaves_no_file_behind(
    world: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    world.data.qvel[2] = float("nan")
    world.step()
    assert list(tmp_path.iterdir()) == []
