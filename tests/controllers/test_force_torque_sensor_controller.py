"""ForceTorqueSensorController: what it publishes and when."""

import pytest

from station.controllers.sensor_controllers import (
    ForceTorqueSensorBroadcaster,
    ForceTorqueSensorController,
)
from station.core.errors import ParameterError
from station.core.hardware.interfaces import (
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
)


@pytest.fixture
def force():
    return [1.0, 2.0, 3.0]


@pytest.fixture
def sensing_robot(robot, force):
    interface = ForceTorqueSensorInterface()
    interface.register_handle(
        ForceTorqueSensorHandle("wrist", "hand", force, [4.0, 5.0, 6.0])
    )
    robot.register_interface(interface)
    return robot


def test_every_force_torque_sensor_is_published_at_the_rate(sensing_robot):
    controller = sensing_robot.start(ForceTorqueSensorController, publish_rate=50)
    published = set()
    for _ in range(1000):
        sensing_robot.step(controller)
        published.update(w.stamp for w in controller.wrenches.values())
    assert 48 <= len(published) <= 50
    wrench = controller.wrenches["wrist"]
    assert wrench.frame_id == "hand"
    assert wrench.force == [1.0, 2.0, 3.0]
    assert wrench.torque == [4.0, 5.0, 6.0]


def test_a_published_object_never_changes(sensing_robot, force):
    controller = sensing_robot.start(ForceTorqueSensorController, publish_rate=500)
    sensing_robot.step(controller, count=4)
    first = controller.wrenches
    force[0] = 9.0
    sensing_robot.step(controller, count=4)
    assert first["wrist"].force == [1.0, 2.0, 3.0]
    assert controller.wrenches["wrist"].force == [9.0, 2.0, 3.0]


def test_force_torque_sensors_need_a_publish_rate_and_claim_nothing(sensing_robot):
    with pytest.raises(ParameterError, match="'arm/publish_rate' is missing"):
        sensing_robot.load(ForceTorqueSensorController)
    controller = sensing_robot.load(ForceTorqueSensorController, publish_rate=50)
    assert controller.claims[0].resources == ()


def test_a_rate_of_zero_publishes_nothing(sensing_robot):
    controller = sensing_robot.start(ForceTorqueSensorController, publish_rate=0)
    sensing_robot.step(controller, count=100)
    assert controller.wrenches == {}


def test_its_messages_can_be_asked_for_by_sensor(sensing_robot):
    controller = sensing_robot.start(ForceTorqueSensorController, publish_rate=500)
    assert controller.published() == {}
    sensing_robot.step(controller, count=4)

    message = controller.published()["wrist"]
    assert message["force"] == [1.0, 2.0, 3.0]
    assert set(message) == {"stamp", "frame_id", "force", "torque"}


def test_one_sensor_is_published_corrected_and_filtered(sensing_robot, force):
    smooth = {
        "type": "control_filters/ExponentialFilterDouble",
        "params": {"alpha": 0.5},
    }
    controller = sensing_robot.start(
        ForceTorqueSensorBroadcaster,
        sensor_name="wrist",
        frame_id="tool",
        sensor_filter_chain={"filter1": smooth},
        offset={"force": {"x": 1.0}},
        multiplier={"force": {"x": 2.0}, "torque": {"z": -1.0}},
    )
    sensing_robot.step(controller)
    force[0] = 3.0
    sensing_robot.step(controller)

    published = controller.published()
    assert published["wrench"]["frame_id"] == "tool"
    assert published["wrench"]["force"] == [8.0, 2.0, 3.0]
    assert published["wrench"]["torque"] == [4.0, 5.0, -6.0]
    assert published["wrench_filtered"]["force"] == [6.0, 2.0, 3.0]


def test_without_filters_nothing_is_published_as_filtered(sensing_robot):
    controller = sensing_robot.start(ForceTorqueSensorBroadcaster, sensor_name="wrist")
    sensing_robot.step(controller)

    assert set(controller.published()) == {"wrench"}
