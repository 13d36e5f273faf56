"""The end effector is a spring whose deflection is force over stiffness."""

import numpy as np
import pytest

from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from tests.controllers.impedance_controllers.impedance_station import ImpedanceStation
from tests.franka_station import JOINTS
from tests.system.arm_bench import INSENSITIVE

KIND = "CartesianImpedanceController"
STIFF = {"stiffness": dict.fromkeys("xyz", 1000.0)}
TABLE = {
    "name": "table",
    "type": "box",
    "size": [0.3, 0.4, 0.1],
    "position": [0.4, 0.0, 0.25],
}


def deflection_error(rng):
    """Push at a random pose; return the error of the deflection over its length."""
    away = rng.uniform(-1.0, 1.0, 7) * [2.0, 0.5, 0.5, 0.5, 0.5, 0.5, 1.5]
    start = (np.array(INITIAL_POSITIONS) + away).tolist()
    arm = ImpedanceStation(KIND, STIFF, initial_positions=start)
    before = np.array(arm.state().O_T_EE[12:15])
    force = rng.normal(size=3)
    force *= 15.0 / np.linalg.norm(force)
    arm.push(force.tolist())
    arm.run(1.5)
    moved = np.array(arm.state().O_T_EE[12:15]) - before
    return np.linalg.norm(moved - force / 1000.0) / 0.015


def test_a_force_deflects_it_by_force_over_stiffness():
    assert deflection_error(np.random.default_rng(2)) < 0.02


@pytest.mark.long
def test_so_it_does_at_twenty_poses():
    rng = np.random.default_rng(5)
    assert max(deflection_error(rng) for _ in range(20)) < 0.02


@pytest.mark.slow
def test_a_tenfold_stiffness_in_contact_does_not_make_it_oscillate():
    arm = ImpedanceStation(
        KIND, {"max_force": 150.0}, objects=[TABLE], collision_config=INSENSITIVE
    )
    x, y, _ = arm.state().O_T_EE[12:15]
    arm.station.motion.set_command("it", [x, y, 0.27, 0.0, 1.0, 0.0, 0.0])
    arm.run(3.0)
    for stiffness in (300.0, 3000.0, 300.0, 3000.0):
        arm.set(
            **dict.fromkeys(("stiffness/x", "stiffness/y", "stiffness/z"), stiffness)
        )
        forces = []
        for _ in range(200):
            arm.run(0.01)
            forces.append(-arm.state().O_F_ext_hat_K[2])
        depth = arm.state().O_T_EE[14] - 0.27
        assert forces[-1] == pytest.approx(stiffness * depth, rel=0.02)
        # The force goes its way once: no overshoot, and no way back.
        steps = np.diff(forces) * np.sign(forces[-1] - forces[0])
        assert steps[1:].min() > -0.01
        assert max(abs(v) for v in arm.state().dq) < 1e-3


def test_the_posture_moves_the_elbow_and_not_the_end_effector():
    arm = ImpedanceStation(KIND, {"nullspace": {"stiffness": 40.0}})
    before = arm.state().O_T_EE
    arm.set(**{f"{JOINTS[2]}/posture": 0.3})
    arm.run(2.0)

    after = arm.state()
    assert after.q[2] > 0.05
    assert pytest.approx(before, abs=1e-3) == after.O_T_EE


def test_a_posture_of_the_parameters_is_kept_at_the_start():
    posture = [0.1, *INITIAL_POSITIONS[1:]]
    arm = ImpedanceStation(KIND, {"posture": posture})

    assert arm.station.tuning.gains("it").values[f"{JOINTS[0]}/posture"] == 0.1
