"""Chains on whole robots: a UR5 gives way to a push, a TIAGo drives by PIDs."""

import numpy as np
import pytest

from station.core.description.robot_files import load_robot_files
from station.core.hardware.interfaces import ForceTorqueSensorInterface
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.hw.mujoco.world import Push
from station.testing import Bench

pytestmark = pytest.mark.long

UR5, TIAGO = "example-robot-data:ur5", "example-robot-data:tiago_no_hand"
STIFFNESS = 200.0
JOINTS = [
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
]
WRIST = {"id": "wrist_3_link"}


def bench_of(reference, **robot):
    return Bench(
        MujocoRobotHW(),
        {"robot_description": reference, **robot},
        root_parameters={"robot_description": load_robot_files(reference).xml},
    )


def test_a_push_moves_a_ur5_by_force_over_stiffness_and_it_comes_back():
    home = [0.0, -1.57, 1.57, -1.57, -1.57, 0.0]
    bench = bench_of(
        UR5,
        base_xyz=[0.0, 0.0, 0.5],
        initial_positions=dict(zip(JOINTS, home, strict=True)),
        sensors={"ft": {"type": "force_torque", "link": "wrist_3_link"}},
    )
    sensor = bench.robot.get(ForceTorqueSensorInterface).get_handle("ft")
    bench.step(100)
    weight = sum(part * part for part in sensor.get_force()) ** 0.5
    bench.load_controller(
        "admittance",
        "admittance_controller/AdmittanceController",
        joints=JOINTS,
        command_interfaces=["position"],
        chainable_command_interfaces=["position"],
        kinematics={"base": "base_link", "tip": "wrist_3_link", "alpha": 0.0005},
        ft_sensor={"name": "ft", "frame": WRIST},
        control={"frame": {"id": "base_link"}},
        fixed_world_frame={"frame": {"id": "base_link"}},
        gravity_compensation={
            "frame": WRIST,
            "CoG": {"pos": [0.0, 0.0, 0.0], "force": weight},
        },
        admittance={
            "selected_axes": [True] * 6,
            "mass": [5.0, 5.0, 5.0, 1.0, 1.0, 1.0],
            "damping_ratio": [1.5] * 6,
            "stiffness": [STIFFNESS] * 3 + [50.0] * 3,
            "joint_damping": 1.0,
        },
    )
    bench.load_controller(
        "jtc",
        "position_controllers/JointTrajectoryController",
        joints=[f"admittance/{joint}" for joint in JOINTS],
    )
    bench.switch(start=["admittance", "jtc"])
    bench.step(1000)
    body = bench.robot.world.model.body("wrist_3_link").id
    before = bench.robot.world.data.xpos[body].copy()
    for force in ((20.0, 0.0, 0.0), (0.0, 12.0, -16.0)):
        bench.robot.world.push(Push("wrist_3_link", force), 10**6)
        bench.step(6000)
        wanted = np.array(force) / STIFFNESS
        error = bench.robot.world.data.xpos[body] - before - wanted
        assert np.linalg.norm(error) < 0.02 * np.linalg.norm(wanted)
        bench.robot.world.push(Push("wrist_3_link", force), 0)
        bench.step(6000)
        assert bench.robot.world.data.xpos[body] == pytest.approx(before, abs=1e-3)
    assert bench.state("admittance") == bench.state("jtc") == "running"


def test_a_tiago_drives_by_pids_between_base_and_wheels():
    bench = bench_of(TIAGO, base="planar")
    wheels = {side: f"wheel_{side}_joint" for side in ("left", "right")}
    for side, wheel in wheels.items():
        bench.load_controller(
            f"pid_{side}",
            "pid_controller/PidController",
            dof_names=[wheel],
            command_interface="velocity",
            reference_and_state_interfaces=["velocity"],
            gains={wheel: {"p": 0.5, "i": 2.5, "feedforward_gain": 0.95}},
            enable_feedforward=True,
        )
    base = bench.load_controller(
        "base",
        "diff_drive_controller/DiffDriveController",
        **{f"{side}_wheel": f"pid_{side}/{wheel}" for side, wheel in wheels.items()},
        wheel_separation=0.4044,
        wheel_radius=0.0985,
    )
    bench.switch(start=["pid_left", "pid_right", "base"])
    bench.step(2)
    base.set_points.post([0.3, 0.2])
    bench.step(4000)

    speed, turn = 0.3 / 0.0985, 0.5 * 0.2 * 0.4044 / 0.0985
    left = bench.manager.get_controller("pid_left").sample
    right = bench.manager.get_controller("pid_right").sample
    # The wheels run as the kinematics of the base says, by their PIDs' own commands.
    assert left.desired + right.desired == pytest.approx([speed - turn, speed + turn])
    assert left.actual + right.actual == pytest.approx(
        [speed - turn, speed + turn], rel=5e-3
    )
