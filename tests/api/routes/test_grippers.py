"""The gripper over HTTP."""

import pytest

from station.client import ApiError
from station.wire import GripperGraspRequest, GripperMoveRequest
from tests.hw.franka.grasp_scene import WIDTH, make_grasp_station, run_until_done

ROUTE = "/api/v1/robots/panda/gripper"


@pytest.fixture
def station():
    return make_grasp_station()


@pytest.fixture
def gripper(client):
    return client.robot("panda").gripper


def test_state_has_all_of_franka_gripper(gripper):
    state = gripper.state()

    assert (state.arm_id, state.activity, state.is_grasped) == ("panda", "idle", False)
    assert state.width == pytest.approx(0.08, abs=1e-4)
    assert state.max_width == pytest.approx(0.08)
    assert state.temperature > 0.0
    assert state.time > 0.0
    assert (state.command, state.last) == (None, None)


def test_a_command_answers_at_once_and_the_state_tells_its_end(gripper, station):
    begun = gripper.grasp(GripperGraspRequest(width=WIDTH, force=20.0))
    run_until_done(station)
    state = gripper.state()

    assert (begun.command.action, begun.command.status) == ("grasp", "active")
    assert begun.command.request["force"] == 20.0
    assert begun.activity == "grasping"
    assert (state.last.id, state.last.status) == (begun.command.id, "succeeded")
    assert (state.activity, state.is_grasped) == ("holding", True)


def test_a_failed_grasp_says_why(gripper, station):
    gripper.grasp(GripperGraspRequest(width=0.05, force=20.0))
    run_until_done(station)

    last = gripper.state().last
    assert last.status == "aborted"
    assert "came to rest at 0.03" in last.message


@pytest.mark.parametrize(
    ("what", "body", "status"),
    [
        ("homing", None, 202),
        ("move", {"width": 0.04}, 202),
        ("grasp", {"width": 0.04, "force": 5.0, "epsilon": {"inner": 0.01}}, 202),
        ("stop", None, 200),
        ("move", {"width": 0.2}, 422),
        ("move", {"width": "0.02"}, 422),
        ("move", {}, 422),
        ("grasp", {"width": 0.04}, 422),
        ("grasp", {"width": 0.04, "force": -1.0}, 422),
        ("open", {}, 404),
    ],
)
def test_routes_have_their_status(operator, what, body, status):
    answer = operator.post(f"{ROUTE}/{what}", json=body)

    assert answer.status_code == status


def test_the_station_s_stop_refuses_commands_but_stop(client, gripper, station):
    client.stop("test")
    station.loop.step()
    with pytest.raises(ApiError) as caught:
        gripper.move(GripperMoveRequest(width=0.0))

    assert caught.value.status == 423
    assert gripper.stop().activity == "idle"


def test_a_controller_of_the_fingers_is_named(client, gripper):
    params = {"joints": ["panda_finger_joint1", "panda_finger_joint2"]}
    group = "position_controllers/JointGroupPositionController"
    client.load_controller("hand", group, params)
    client.switch_controllers(start=["hand"])

    assert gripper.state().activity == "controlled"
    with pytest.raises(ApiError, match="controller 'hand' claims") as caught:
        gripper.homing()
    assert (caught.value.status, caught.value.code) == (409, "gripper_command_refused")


def test_an_unknown_arm_is_refused(client):
    with pytest.raises(ApiError, match="no arm 'left'") as caught:
        client.robot("left").gripper.state()
    assert caught.value.status == 404
