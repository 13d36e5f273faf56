"""A robot's base is fixed, floats, or rolls on its wheels."""

import mujoco
import pytest

from station.core.errors import RobotDescriptionError
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.testing import Bench

DRIVE = {
    "left_wheel": "wheel_left_joint",
    "right_wheel": "wheel_right_joint",
}


def bench(robot: str, base: str, **more: object) -> Bench:
    reference = f"example-robot-data:{robot}"
    return Bench(
        MujocoRobotHW(), {"robot_description": reference, "base": base, **more}
    )


def joint(made: Bench, name: str) -> float:
    return float(made.robot.world.data.joint(name).qpos[0])


@pytest.mark.slow
def test_tiago_drives_where_its_odometry_says() -> None:
    made = bench("tiago_no_hand", "planar")
    made.load_controller("drive", "diff_drive_controller/DiffDriveController", **DRIVE)
    made.switch(start=["drive"])
    made.step(1000)
    assert max(abs(joint(made, f"base_{axis}")) for axis in ("x", "y", "yaw")) < 1e-6
    controller = made.manager.get_controller("drive")
    controller.set_points.post([0.3, 0.5], timeout=1e6)
    made.step(2000)
    odometry = controller.odometry
    assert odometry.heading > 0.5
    assert joint(made, "base_x") == pytest.approx(odometry.x, abs=2e-3)
    assert joint(made, "base_y") == pytest.approx(odometry.y, abs=2e-3)
    assert joint(made, "base_yaw") == pytest.approx(odometry.heading, abs=2e-3)


def test_planar_base_without_wheels_is_refused() -> None:
    with pytest.raises(RobotDescriptionError, match="no wheels on both sides"):
        bench("so100", "planar")


@pytest.mark.slow
def test_legged_robot_stands_on_its_feet() -> None:
    made = bench("anymal", "floating")
    height = made.robot.world.data.qpos[2]
    made.step(1000)
    assert made.robot.world.data.qpos[2] == pytest.approx(height, abs=0.01)
    # The floor carries its weight.
    contacts = made.robot.simulated_world().contacts()
    lifted = sum(abs(contact.force[2]) for contact in contacts)
    mass = float(made.robot.world.model.body_mass.sum())
    assert lifted == pytest.approx(mass * 9.81, rel=0.05)


def test_floating_robot_in_the_air_falls() -> None:
    made = bench("so100", "floating", base_xyz=[0.0, 0.0, 1.0])
    made.step(100)
    # Free fall: g t^2 / 2
    fallen = 1.0 - float(made.robot.world.data.qpos[2])
    assert fallen == pytest.approx(0.049, rel=0.03)


def test_a_base_that_moves_is_told_where_it_is() -> None:
    made = bench("solo12", "floating")
    world = made.robot.world
    world.data.joint("base").qpos[:] = [1.0, 2.0, 0.7, 0.0, 0.0, 0.0, 1.0]
    mujoco.mj_kinematics(world.model, world.data)
    (told,) = made.robot.simulated_world().bases()
    assert told.link == "base_link"
    assert told.position == pytest.approx((1.0, 2.0, 0.7))
    assert told.orientation == pytest.approx((0.0, 0.0, 1.0, 0.0))


def test_a_fixed_base_is_not_told() -> None:
    assert bench("ur5", "fixed").robot.simulated_world().bases() == []
