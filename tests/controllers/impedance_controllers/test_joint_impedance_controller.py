"""The joints are springs whose deflection is torque over stiffness."""

import numpy as np
import pytest

from tests.controllers.impedance_controllers.impedance_station import ImpedanceStation

KIND = "JointImpedanceController"
STIFFNESS = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0]


def test_a_force_deflects_every_joint_by_its_torque_over_its_stiffness():
    arm = ImpedanceStation(KIND)
    before = np.array(arm.state().q)
    arm.push([3.0, 10.0, -5.0])
    arm.run(2.0)

    # The arm estimates the force with which it presses: the other sign.
    torques = -np.array(arm.state().tau_ext_hat_filtered)
    assert np.abs(torques).max() > 2.0
    expected = torques / STIFFNESS
    assert np.array(arm.state().q) - before == pytest.approx(expected, abs=1e-5)


def test_the_joints_go_to_the_set_point_without_overshoot():
    arm = ImpedanceStation(KIND)
    goal = [q + 0.1 for q in arm.state().q]
    arm.station.motion.set_command("it", goal)
    path = []
    for _ in range(200):
        arm.run(0.01)
        path.append(arm.state().q)

    assert path[-1] == pytest.approx(goal, abs=1e-3)
    assert (np.max(path, axis=0) - goal).max() < 2e-3
