"""The state of an arm is published at its rate."""

import pytest

from station.core.errors import ParameterError
from station.core.switching import SwitchRequest
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


def test_its_messages_can_be_asked_for():
    station = make_franka_station()
    station.load_controller("state", TYPE, {"arm_id": "panda", "joint_names": JOINTS})
    assert station.published("state") == {}
    station.switch_controllers(SwitchRequest(("state",), ()))
    station.loop.step(10)

    messages = station.published("state")

    assert set(messages) == {"joint_states", "joint_states_desired", "F_ext"}
    assert messages["joint_states"]["name"] == JOINTS
    assert messages["F_ext"]["frame_id"] == "panda_K"
    assert len(messages["F_ext"]["force"]) == len(messages["F_ext"]["torque"]) == 3


def test_seven_joints_are_needed():
    station = make_franka_station()
    with pytest.raises(ParameterError, match="must name 7"):
        station.load_controller("state", TYPE, {"arm_id": "panda", "joint_names": []})
