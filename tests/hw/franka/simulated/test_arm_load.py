"""What a configured load needs."""

import numpy as np
import pytest

from station.core.franka import Frame
from station.hw.franka.arm.franka_kinematics import zero_jacobian
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.simulated.franka_dynamics import ArmLoad

Q = [0.1, -0.5, 0.2, -2.0, 0.3, 1.5, 0.4]


@pytest.fixture
def load() -> ArmLoad:
    arm = ArmLoad()
    arm.load = RigidBody(2.0)
    return arm


def test_weight_of_a_point_load_acts_through_the_jacobian(load: ArmLoad) -> None:
    jacobian = np.reshape(zero_jacobian(Frame.FLANGE, Q), (7, 6))
    assert load.weight(Q) == pytest.approx(2.0 * 9.81 * jacobian[:, 2], abs=1e-9)


def test_acceleration_costs_force(load: ArmLoad) -> None:
    jacobian = np.reshape(zero_jacobian(Frame.FLANGE, Q), (7, 6))[:, :3]
    ddq = np.array([1.0, 0.5, 0, 0, 0, 0.2, 0])
    force = 2.0 * (jacobian.T @ ddq + np.array([0, 0, 9.81]))
    load.note_motion([0.0] * 7, ddq.tolist(), 1.0)
    found = load.torques(Q, [0.0] * 7)
    assert found == pytest.approx(jacobian @ force, abs=1e-9)
