"""franka_control's services, and the actions of hand and recovery, over rosbridge."""

from functools import partial

import pytest

from station.app.composition import compose
from station.config import load_config
from station.core.franka.franka_robot_state import RobotMode
from tests.waiting import wait_until

ARM, HAND = "/franka_control", "/franka_gripper"
THRESHOLDS = {
    f"{bound}_{kind}_thresholds_{phase}": [level] * (7 if kind == "torque" else 6)
    for kind in ("torque", "force")
    for phase in ("acceleration", "nominal")
    for bound, level in (("lower", 20.0), ("upper", 30.0))
}


@pytest.fixture
def station():
    """Return a station of one arm with its hand, whose world is quick."""
    config = load_config({
        "robot": {"type": "franka_hw/FrankaHW", "realism": "ideal"},
        "station": {"real_time_factor": 10.0},
    })
    station = compose(config).station
    station.loop.start()
    yield station
    station.loop.stop()
    station.loop.hw.close()


def goal(client, action, args=None):
    """Send a goal; return its result."""
    client.send("send_action_goal", action=action, id=action, args=args or {})
    return client.until("action_result", id=action)


def test_setters_change_the_arm_and_refuse_in_words(client, station):
    state = station.loop.hw.arm.state
    load = {"mass": 0.5, "F_x_center_load": [0.0, 0.0, 0.1], "load_inertia": [0.0] * 9}

    assert client.values(f"{ARM}/set_load", load)["success"]
    assert client.values(f"{ARM}/set_full_collision_behavior", THRESHOLDS)["success"]
    refused = client.values(f"{ARM}/set_load", {**load, "mass": -1.0})

    assert state.m_load == 0.5
    assert not refused["success"]
    assert "mass" in refused["error"]


def test_the_arm_is_disconnected_and_connected(client):
    for service, refusal in (("disconnect", "not connected"), ("connect", "already")):
        assert client.values(f"{ARM}/{service}")["success"]
        again = client.values(f"{ARM}/{service}")

        assert not again["success"]
        assert refusal in again["message"]


def test_the_hand_opens_and_tells_a_grasp_of_nothing(client):
    opened = goal(client, f"{HAND}/move", {"width": 0.06, "speed": 0.1})
    fingers = client.subscribe(f"{HAND}/joint_states")["msg"]["position"]
    closed = goal(client, f"{HAND}/grasp", {"width": 0.02, "speed": 0.1, "force": 5.0})

    assert (opened["status"], opened["values"]["success"]) == (4, True)
    assert fingers == pytest.approx([0.03, 0.03], abs=1e-3)
    assert not closed["values"]["success"]


def test_the_arm_recovers_from_an_error(client, station):
    arm, none = station.loop.hw.arm, [0.0, 0.0, 0.0]
    push = partial(
        arm.simulation().apply_force, "panda_hand", [0.0, 0.0, -90.0], none, 0.2
    )
    station.loop.run_in_cycle(push)
    assert wait_until(lambda: arm.state.robot_mode is RobotMode.REFLEX)

    assert goal(client, f"{ARM}/error_recovery")["status"] == 4
    assert arm.state.robot_mode is RobotMode.IDLE
