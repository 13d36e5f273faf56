"""All joints at once commanded far beyond their limits, in every direction."""

from collections.abc import Mapping
from math import degrees, inf
from random import Random

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import Joint
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.hw.urdf_loader import load_urdf
from tests.hw.mujoco.test_mujoco_robot_hw import (
    INTERFACES,
    PERIOD,
    UR5_SOFT_LIMITS,
    claim,
    make,
    states,
)

pytestmark = pytest.mark.long

# Poses of the examples; the two without soft limits in their URDF get some.
ROBOTS: Mapping[str, Mapping[str, object]] = {
    "ur5": {
        "base_xyz": [0.0, 0.0, 0.5],
        "initial_positions": {
            "shoulder_lift_joint": -1.2,
            "elbow_joint": 1.4,
            "wrist_1_joint": -1.8,
            "wrist_2_joint": -1.57,
        },
        "joint_limits": UR5_SOFT_LIMITS,
    },
    "panda": {"initial_positions": {"panda_joint4": -2.0, "panda_joint6": 2.0}},
    "kinova": {
        "initial_positions": {
            "j2s6s200_joint_2": 2.9,
            "j2s6s200_joint_3": 1.3,
            "j2s6s200_joint_4": 4.2,
            "j2s6s200_joint_5": 1.4,
        },
    },
    "talos_left_arm": {
        "base_xyz": [0.0, 0.0, 1.2],
        "initial_positions": {"arm_left_2_joint": 0.4, "arm_left_4_joint": -1.2},
    },
}


def joints_of(robot: str) -> dict[str, Joint]:
    description = load_robot_files(f"example-robot-data:{robot}")
    return dict(load_urdf(description).joints)


def check_far_commands(
    robot: str, quantity: str, seed: int, limit_mode: str
) -> MujocoRobotHW:
    """Command every joint far out for a second, and then the other way."""
    hw = make(
        f"example-robot-data:{robot}",
        floor=True,
        limit_mode=limit_mode,
        **ROBOTS[robot],
    )
    joints = joints_of(robot)
    interface = hw.get(INTERFACES[quantity])
    names = interface.get_names()
    claim(hw, quantity, *names)
    handles = [interface.get_handle(name) for name in names]
    random = Random(seed)
    far = [random.choice([-1e4, 1e4]) for _ in names]
    fastest = dict.fromkeys(states(hw), 0.0)
    outside = dict.fromkeys(states(hw), -inf)
    for cycle in range(2000):
        sign = 1.0 if cycle < 1000 else -1.0
        hw.read(0.0, PERIOD)
        for handle, command in zip(handles, far, strict=True):
            handle.set_command(sign * command)
        hw.write(0.0, PERIOD)
        for name, state in states(hw).items():
            limit = joints[name].limit
            fastest[name] = max(fastest[name], abs(state.get_velocity()))
            if limit is not None and limit.lower is not None:
                position = state.get_position()
                beyond = max(limit.lower - position, position - limit.upper)
                outside[name] = max(outside[name], beyond)
    assert hw.mode() == "running"
    assert max(map(degrees, outside.values())) < 0.5
    for name, velocity in fastest.items():
        limit = joints[name].limit
        if limit is not None and limit.velocity > 0.0:
            assert velocity < 1.02 * limit.velocity, name
    clamped = {clamp.last.joint for clamp in hw.clamps()}
    assert clamped == set(names)
    return hw


@pytest.mark.parametrize("quantity", list(INTERFACES))
@pytest.mark.parametrize("robot", list(ROBOTS))
def test_no_joint_leaves_its_bounds(robot: str, quantity: str) -> None:
    check_far_commands(robot, quantity, seed=1, limit_mode="ros_control")


@pytest.mark.parametrize("robot", ["ur5", "talos_left_arm"])
def test_no_joint_limited_by_rate_leaves_its_bounds(robot: str) -> None:
    check_far_commands(robot, "velocity", seed=2, limit_mode="rate")


@pytest.mark.parametrize("limit_mode", ["ros_control", "rate"])
@pytest.mark.parametrize("seed", range(3, 5))
@pytest.mark.parametrize("quantity", list(INTERFACES))
@pytest.mark.parametrize("robot", list(ROBOTS))
def test_in_other_directions(
    robot: str, quantity: str, seed: int, limit_mode: str
) -> None:
    check_far_commands(robot, quantity, seed, limit_mode)


def test_brakes_act_on_far_effort_commands() -> None:
    hw = check_far_commands("panda", "effort", seed=1, limit_mode="ros_control")
    assert hw.world.brakes.braked_steps > 0


def test_lower_velocity_of_the_parameters_counts() -> None:
    limits = {"elbow_joint": {"has_velocity_limits": True, "max_velocity": 0.5}}
    hw = make(joint_limits=limits)
    hw.world.data.joint("elbow_joint").qvel[0] = 2.0
    hw.write(0.0, PERIOD)
    assert states(hw)["elbow_joint"].get_velocity() == pytest.approx(0.0)
    hw.read(0.0, PERIOD)
    assert states(hw)["elbow_joint"].get_velocity() < 0.51
