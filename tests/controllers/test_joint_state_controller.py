"""JointStateController: the original's tests with a stepped clock, and more.

The seven of ros_controllers@678b92a joint_state_controller_test.cpp are here as:
initOk, valuesOk: `test_the_originals_file_publishes_what_the_robot_reports`;
initKo: `test_joint_states_need_a_publish_rate`;
publishOk: `test_the_originals_file_publishes_ten_times_a_second`;
publishKo: `test_the_originals_file_with_no_rate_publishes_nothing`;
extraJointsOk: `test_the_originals_extra_joints_have_constant_values`;
extraJointsKo: `test_the_originals_unusable_extra_joints_are_left_out`.
"""

from pathlib import Path

import pytest
import yaml

from station.controllers.joint_state_controller import JointStateController
from station.core.errors import ParameterError, ResourceNotFoundError

FOLDER = Path(__file__).parents[1] / "data" / "ros_yaml" / "joint_state_controller"


@pytest.fixture
def start_file(make_robot):
    """Return a way to start the controller of one of the original's files."""

    def start(suffix):
        text = (FOLDER / f"joint_state_controller_{suffix}.yaml").read_text()
        values = yaml.safe_load(text)["joint_state_controller"]
        robot = make_robot(["joint1", "joint2"], urdf="")
        return robot, robot.start(JointStateController, **values)

    return start


def _states_of_moving(robot, controller):
    robot.position[:], robot.velocity[:] = [1.0, -1.0], [2.0, -2.0]
    robot.effort[:] = [3.0, -3.0]
    robot.step(controller, period=0.1)
    states = controller.joint_states
    rows = zip(
        states.name, states.position, states.velocity, states.effort, strict=True
    )
    return {name: row for name, *row in rows}


MOVING = {"joint1": [1.0, 2.0, 3.0], "joint2": [-1.0, -2.0, -3.0]}


def test_the_originals_file_publishes_what_the_robot_reports(start_file):
    assert _states_of_moving(*start_file("ok")) == MOVING


def test_the_originals_file_publishes_ten_times_a_second(start_file):
    stamps = _published(*start_file("ok"), duration=1.0, period=0.05)
    # The first one comes at once.
    assert len(stamps) - 1 == pytest.approx(10, abs=1)


def test_the_originals_file_with_no_rate_publishes_nothing(start_file):
    assert _published(*start_file("ko"), duration=1.0, period=0.1) == []


def test_the_originals_extra_joints_have_constant_values(start_file):
    assert _states_of_moving(*start_file("extra_joints_ok")) == MOVING | {
        "extra1": [10.0, 20.0, 30.0],
        "extra2": [-10.0, 0.0, 0.0],
        "extra3": [0.0, 0.0, 0.0],
    }


def test_the_originals_unusable_extra_joints_are_left_out(start_file):
    assert _states_of_moving(*start_file("extra_joints_ko")) == MOVING


def _published(robot, controller, duration, period):
    """Return the stamps of what is published in `duration` [s]."""
    stamps = []
    for _ in range(round(duration / period)):
        before = controller.joint_states
        robot.step(controller, period=period)
        if controller.joint_states is not before:
            stamps.append(controller.joint_states.stamp)
    return stamps


def test_joint_states_need_a_publish_rate(robot):
    with pytest.raises(ParameterError, match="'arm/publish_rate' is missing"):
        robot.load(JointStateController)


def test_the_joint_state_controller_claims_nothing(robot):
    controller = robot.load(JointStateController, publish_rate=50)
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::JointStateInterface"
    assert claimed.resources == ()


def test_joint_states_are_published_in_the_first_cycle_and_then_at_the_rate(robot):
    controller = robot.start(JointStateController, publish_rate=50)
    stamps = _published(robot, controller, duration=1.0, period=0.001)
    assert stamps[0] == pytest.approx(100.001)
    assert 50 <= len(stamps) <= 51


@pytest.mark.parametrize("rate", [0, -10])
def test_a_rate_that_is_not_positive_publishes_nothing(robot, rate):
    controller = robot.start(JointStateController, publish_rate=rate)
    assert _published(robot, controller, duration=1.0, period=0.01) == []


def test_missed_publications_are_not_caught_up(robot):
    controller = robot.start(JointStateController, publish_rate=50)
    _published(robot, controller, duration=0.1, period=0.001)
    robot.time += 1.0
    assert len(_published(robot, controller, duration=0.1, period=0.001)) <= 6


def test_joint_states_are_those_that_the_robot_reports(robot):
    controller = robot.start(JointStateController, publish_rate=50)
    robot.position[:] = [0.1, 0.2, 0.3]
    robot.velocity[:] = [1.0, 2.0, 3.0]
    robot.effort[:] = [10.0, 20.0, 30.0]
    robot.step(controller)
    states = controller.joint_states
    assert states.name == ["elbow", "slide", "wheel"]
    assert states.position == [0.2, 0.1, 0.3]
    assert states.velocity == [2.0, 1.0, 3.0]
    assert states.effort == [20.0, 10.0, 30.0]


def test_a_published_object_never_changes(robot):
    controller = robot.start(JointStateController, publish_rate=1000)
    robot.step(controller)
    first = controller.joint_states
    robot.position[0] = 1.0
    robot.step(controller, count=3)
    assert first.position == [0.0, 0.0, 0.0]


def test_joints_and_their_order_can_be_chosen(robot):
    controller = robot.start(
        JointStateController, publish_rate=50, joints=["wheel", "slide"]
    )
    robot.position[:] = [0.1, 0.2, 0.3]
    robot.step(controller)
    assert controller.joint_states.name == ["wheel", "slide"]
    assert controller.joint_states.position == [0.3, 0.1]


def test_an_unknown_joint_is_refused(robot):
    with pytest.raises(ResourceNotFoundError, match="'knee'"):
        robot.load(JointStateController, publish_rate=50, joints=["knee"])


def test_extra_joints_have_constant_values(robot):
    extra = [
        {"name": "extra1", "position": 10.0, "velocity": 20.0, "effort": 30.0},
        {"name": "extra2", "position": -10},
        {"name": "extra3"},
    ]
    controller = robot.start(JointStateController, publish_rate=50, extra_joints=extra)
    robot.step(controller)
    states = controller.joint_states
    assert states.name[3:] == ["extra1", "extra2", "extra3"]
    assert states.position[3:] == [10.0, -10.0, 0.0]
    assert states.velocity[3:] == [20.0, 0.0, 0.0]
    assert states.effort[3:] == [30.0, 0.0, 0.0]


@pytest.mark.parametrize(
    "extra",
    [
        "a string",
        ["no mapping"],
        [{"position": 1.0}],
        [{"name": "elbow"}],
        [{"name": "extra", "velocity": "fast"}],
    ],
)
def test_unusable_extra_joints_are_left_out_with_a_warning(robot, extra, caplog):
    controller = robot.start(JointStateController, publish_rate=50, extra_joints=extra)
    robot.step(controller)
    assert controller.joint_states.name == ["elbow", "slide", "wheel"]
    assert "ignored" in caplog.text


def test_its_message_can_be_asked_for(robot):
    controller = robot.start(JointStateController, publish_rate=50)
    assert controller.published() == {}
    robot.step(controller)

    message = controller.published()["joint_states"]
    assert message["name"] == ["elbow", "slide", "wheel"]
    assert message["position"] == [0.0, 0.0, 0.0]
