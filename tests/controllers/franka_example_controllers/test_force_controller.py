"""The arm presses on a table with the weight of a mass."""

import mujoco
import numpy as np
import pytest

from station.core.franka import Frame
from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)

# The fingertips of the start pose are 9 mm below the end effector frame.
TABLE = {
    "name": "table",
    "type": "table",
    "size": [0.3, 0.3, 0.05],
    "position": [0.3069, 0.0, 0.4774],
}


def force_on_table(station):
    """Return the contact force on the table [N], shape (3,), of the last step."""
    world = station.loop.hw.simulated_world().world
    table = world.model.body("table").id
    total, wrench = np.zeros(3), np.zeros(6)
    for number in range(world.data.ncon):
        contact = world.data.contact[number]
        bodies = [world.model.geom_bodyid[g] for g in (contact.geom1, contact.geom2)]
        if table in bodies:
            mujoco.mj_contactForce(world.model, world.data, number, wrench)
            force = contact.frame.reshape(3, 3).T @ wrench[:3]
            total += force if bodies[1] == table else -force
    return total


@pytest.mark.slow
@pytest.mark.parametrize(("k_p", "k_i"), [(0.0, 0.0), (0.5, 0.5)])
def test_table_carries_the_weight(k_p, k_i):
    station = start_example("Force", objects=[TABLE])
    # What the table carries at the start is no part of what the integrator sees.
    unseen = force_on_table(station)[2] if k_i else 0.0
    station.tuning.set_gains("example", {"desired_mass": 1.0, "k_p": k_p, "k_i": k_i})
    run_without_errors(station, 8.0)

    pressed = force_on_table(station)

    assert pressed[2] == pytest.approx(unseen - 9.81, rel=0.01)
    assert abs(pressed[0]) < 0.1
    assert abs(pressed[1]) < 0.1
    felt = Arms(station.robots).state("panda").O_F_ext_hat_K
    assert felt[2] == pytest.approx(pressed[2], rel=0.02)


def test_torques_follow_the_formula():
    station = start_example("Force")
    gains = {"desired_mass": 2.0, "k_p": 1.5, "k_i": 2.0}
    state = Arms(station.robots).state("panda")
    bias = np.subtract(
        state.tau_J, Arms(station.robots).model("panda", Frame.FLANGE).gravity
    )
    station.tuning.set_gains("example", gains)
    present, integral = dict.fromkeys(gains, 0.0), np.zeros(7)
    for _ in range(200):
        station.loop.step()
        state = Arms(station.robots).state("panda")
        model = Arms(station.robots).model("panda", Frame.END_EFFECTOR)
        jacobian = np.reshape(model.zero_jacobian, (7, 6)).T
        tau_d = jacobian.T @ [0, 0, -9.81 * present["desired_mass"], 0, 0, 0]
        error = tau_d - (np.array(state.tau_J) - model.gravity - bias)
        integral += 0.001 * error
        tau = tau_d + present["k_p"] * error + present["k_i"] * integral
        for name, value in gains.items():
            present[name] = 0.001 * value + 0.999 * present[name]

    assert np.abs(tau).max() > 0.1
    assert list(station.loop.hw.commands.efforts) == pytest.approx(tau, abs=0.01)


def test_start_presses_with_nothing():
    station = start_example("Force")
    before = Arms(station.robots).state("panda").q
    station.loop.step(100)

    assert Arms(station.robots).state("panda").q == pytest.approx(before, abs=1e-4)
    assert station.tuning.gains("example").values["desired_mass"] == 0.0
    assert station.tuning.gains("example").schema["desired_mass"].maximum == 2.0
