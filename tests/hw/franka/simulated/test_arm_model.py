"""The model of an arm is its dynamics and kinematics under libfranka's names."""

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka.franka_model import Frame
from station.hw.franka.arm.franka_kinematics import IDENTITY, zero_jacobian
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.simulated.arm_model import ArmModel
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics

Q = [0.1, -0.5, 0.2, -2.0, 0.3, 1.5, 0.4]
INERTIA = [0.001, 0, 0, 0, 0.0025, 0, 0, 0, 0.0017]


def test_load_is_passed_on():
    description = load_robot_files("example-robot-data:panda")
    model, dynamics = ArmModel(description), FrankaDynamics(description)
    load = RigidBody(0.73, (-0.01, 0.0, 0.03), tuple(INERTIA))
    arguments = (INERTIA, 0.73, [-0.01, 0.0, 0.03])

    assert model.mass(Q, *arguments) == dynamics.mass(Q, load)
    assert model.coriolis(Q, Q, *arguments) == dynamics.coriolis(Q, Q, load)
    assert model.gravity(Q, *arguments[1:]) == pytest.approx(dynamics.gravity(Q, load))


def test_a_jacobian_follows_joints_and_tool():
    model = ArmModel(load_robot_files("example-robot-data:panda"))
    tool, turned = [*IDENTITY], [*IDENTITY]
    tool[14] = 0.1
    frames = (Frame.FLANGE, Frame.END_EFFECTOR)
    for q in (Q, Q, Q[::-1]):
        for frame in frames:
            for end in (tool, IDENTITY, tool):
                found = model.zero_jacobian(frame, q, end, turned)
                expected = zero_jacobian(frame, q, end, turned)
                assert found == expected
                found[0] = 1.0  # the caller's own
