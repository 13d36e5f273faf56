"""One arm is pushed, the other one follows."""

import numpy as np
import pytest

from station.core.errors import ControllerStateError
from station.core.franka.arms import Arms
from tests.conformance.benches import CONTROLLER_PARAMETERS
from tests.controllers.franka_example_controllers.two_arm_station import (
    joints_of,
    start_two_armed_example,
)

START = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
AWAY = [0.05, 0.04, -0.05, 0.05, 0.03, -0.04, 0.05]


def start(follower_at=tuple(START + AWAY)):
    params = {
        role: {
            **CONTROLLER_PARAMETERS[role],
            "arm_id": role,
            "joint_names": joints_of(role),
        }
        for role in ("leader", "follower")
    }
    arms = {
        "leader": {"base_xyz": [0.0, 0.6, 0.0]},
        "follower": {
            "base_xyz": [0.0, -0.6, 0.0],
            "initial_positions": list(follower_at),
        },
    }
    return start_two_armed_example("TeleopJointPD", params, arms)


def apart(station):
    q = [Arms(station.robots).state(role).q for role in ("leader", "follower")]
    return np.abs(np.subtract(*q)).max()


def phase(station):
    return station.published("example")["phase"]["data"]


@pytest.mark.slow
def test_follower_comes_to_the_leader_and_then_follows_its_pushes():
    station = start()
    station.loop.step(500)
    assert phase(station) == "align"
    held = Arms(station.robots).state("leader").q
    station.loop.step(1_500)
    assert phase(station) == "track"
    assert Arms(station.robots).state("leader").q == pytest.approx(held, abs=1e-3)
    assert apart(station) < 1e-3

    Arms(station.robots).apply_force(
        "leader", "leader_hand", [0, 0, 8.0], [0, 0, 0], 0.7
    )
    for _ in range(10):
        station.loop.step(100)
        assert apart(station) < 0.02
    station.loop.step(1_000)

    assert station.latest().mode == "move"
    assert np.abs(np.subtract(Arms(station.robots).state("leader").q, held)).max() > 0.2
    assert apart(station) < 0.005


@pytest.mark.slow
def test_what_the_follower_touches_is_felt_at_the_leader():
    station = start(tuple(START))
    station.loop.step(500)
    before = Arms(station.robots).state("leader").O_T_EE[13]
    Arms(station.robots).apply_force(
        "follower", "follower_hand", [0, 9, 0], [0, 0, 0], 1.0
    )
    station.loop.step(1_000)

    assert station.published("example")["follower_contact"]["data"] > 0.9
    # Half of the force, and nobody holds the leader.
    assert Arms(station.robots).state("leader").O_T_EE[13] - before > 0.01


def test_follower_is_commanded_by_its_pd_law():
    station = start()
    station.loop.step(200)
    told = station.controller_sample("example")
    velocity = station.manager.get_controller("example")._motion.dq
    state = Arms(station.robots).state("follower")

    p, d = (
        np.array(CONTROLLER_PARAMETERS["follower"][key])
        for key in ("p_gains", "d_gains")
    )
    tau = p * np.subtract(told.desired, state.q) + d * (velocity - state.dq)
    assert list(station.loop.hw.arms[1].commands.efforts) == pytest.approx(tau)


def test_joint_beyond_its_soft_limits_is_refused():
    controller = start(tuple(START)).manager.get_controller("example")
    controller._leader.state.get_robot_state().doubles("q")[3] = 0.0

    with pytest.raises(ControllerStateError, match="'leader_joint4' is at 0"):
        controller.starting(1.0)


def test_torques_decay_while_an_arm_has_an_error():
    station = start()
    station.loop.step(200)
    controller = station.manager.get_controller("example")
    before = np.array(station.loop.hw.arms[1].commands.efforts)
    controller._leader.state.get_robot_state().current_errors[3] = True
    controller.update(1.0, 0.001)

    after = list(station.loop.hw.arms[1].commands.efforts)
    assert np.abs(before).max() > 0.1
    assert after == pytest.approx(0.95 * before)
