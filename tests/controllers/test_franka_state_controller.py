"""The state of an arm is published at its rate."""

from dataclasses import fields

import pytest

from station.core.control.switching import SwitchRequest
from station.core.errors import ParameterError
from station.core.franka import RobotState
from station.core.franka.arms import Arms
from tests.franka_station import JOINTS, make_franka_station

TYPE = "franka_control/FrankaStateController"


def test_state_is_published_thirty_times_a_second():
    station = make_franka_station()
    station.load_controller("state", TYPE, {"arm_id": "panda", "joint_names": JOINTS})
    station.switch_controllers(SwitchRequest(("state",), ()))
    station.loop.step(1_000)

    published = station.manager.get_controller("state").franka_states

    assert published.sequence in {28, 29, 30}
    assert published.joint_states.name == JOINTS
    assert published.joint_states.position == published.state.q
    assert published.joint_states_desired.position == published.state.q_d
    assert [child for _, child, _ in published.transforms] == [
        "panda_NE",
        "panda_EE",
        "panda_K",
    ]
    assert published.state is not station.manager.get_controller("state")


def test_all_topics_of_the_original_are_published():
    station = make_franka_station()
    station.load_controller("state", TYPE, {"arm_id": "panda", "joint_names": JOINTS})
    assert station.published("state") == {}
    station.switch_controllers(SwitchRequest(("state",), ()))
    station.loop.step(50)

    told, state = station.published("state"), Arms(station.robots).state("panda")

    assert list(told) == [
        "franka_states", "joint_states", "joint_states_desired", "F_ext", "tf"
    ]  # fmt: skip
    assert set(told["franka_states"]) == {
        "stamp", "sequence", *(one.name for one in fields(RobotState))
    }  # fmt: skip
    assert told["franka_states"]["O_T_EE"] == pytest.approx(state.O_T_EE)
    assert told["franka_states"]["robot_mode"] == "idle"
    assert told["franka_states"]["current_errors"] == []
    assert told["joint_states"]["name"] == JOINTS
    assert told["joint_states_desired"]["position"] == pytest.approx(state.q_d)
    assert told["F_ext"]["frame_id"] == "panda_K"
    frames = [one["child_frame_id"] for one in told["tf"]["transforms"]]
    assert frames == ["panda_NE", "panda_EE", "panda_K"]


def test_seven_joints_are_needed():
    station = make_franka_station()
    with pytest.raises(ParameterError, match="7 different joints"):
        station.load_controller("state", TYPE, {"arm_id": "panda", "joint_names": []})
