"""One arm is pushed, the other one follows.

Walls before joint limits: a damper, then a spring.
"""

import numpy as np
import pytest

from station.controllers.franka_example_controllers.teleop_joint_pd_controller import (
    JointWall,
    WallShape,
    wall_torques,
)
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


SHAPE = WallShape(0.1, 0.2, 1000.0, 30.0, 10.0)


def make_wall(q=0.0):
    wall = JointWall("elbow", -1.0, 2.0, SHAPE)
    wall.start_at(q)
    return wall


@pytest.mark.parametrize(
    ("q", "dq", "expected"),
    [
        (0.0, 1.0, 0.0),
        (1.69, 1.0, 0.0),
        (1.75, 0.5, -10.0 * 0.5),
        (1.95, 0.5, 1000.0 * -0.05 - 30.0 * 0.5),
        (2.05, 0.0, 1000.0 * -0.15),
        (-0.75, -0.5, 10.0 * 0.5),
        (-0.95, -0.5, 1000.0 * 0.05 + 30.0 * 0.5),
    ],
)
def test_torque_depends_on_the_zone(q, dq, expected):
    assert make_wall().torque(q, dq) == pytest.approx(expected)


def test_joint_that_starts_in_the_wall_is_not_pushed_out():
    wall = make_wall(1.94)  # 0.06 of 0.3 left: the zones have a fifth of their width

    assert wall.torque(1.94, 0.0) == 0.0
    assert wall.torque(1.99, 0.0) == pytest.approx(1000.0 * -0.01)


def test_wall_grows_while_the_joint_leaves_it():
    wall = make_wall(1.94)
    wall.torque(1.85, -0.1)  # half of the width
    assert wall.torque(1.97, 0.1) == pytest.approx(1000.0 * -0.02 - 30.0 * 0.1)
    wall.torque(1.5, -0.1)

    assert wall.torque(1.95, 0.0) == pytest.approx(1000.0 * -0.05)


def test_lower_wall_grows_the_other_way_round():
    wall = make_wall(-0.94)
    wall.torque(-0.94, -0.1)
    assert wall.torque(-0.94, 0.0) == 0.0
    wall.torque(-0.6, 0.1)

    assert wall.torque(-0.95, 0.0) == pytest.approx(1000.0 * 0.05)


def test_joint_beyond_its_limits_is_refused():
    with pytest.raises(ControllerStateError, match=r"'elbow' is at 2\.1000 rad"):
        make_wall(2.1)


def test_torques_of_all_joints_are_returned():
    walls = [make_wall(), make_wall()]

    assert wall_torques(walls, [0.0, 2.05], [0.0, 0.0]) == pytest.approx([0.0, -150.0])
