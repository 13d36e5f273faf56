"""ImuSensorController: what it publishes, and what is not measured."""

import pytest

from station.controllers.sensor_controllers import ImuSensorController
from station.core.errors import ParameterError
from station.core.hardware.interfaces import ImuSensorHandle, ImuSensorInterface

COVARIANCE = [float(number) for number in range(9)]


def _start(robot, **readings):
    interface = ImuSensorInterface()
    interface.register_handle(ImuSensorHandle("base", "base_link", **readings))
    robot.register_interface(interface)
    return robot.start(ImuSensorController, publish_rate=100)


def test_measurements_of_an_imu_are_published(robot):
    controller = _start(
        robot,
        orientation=[0.0, 0.0, 0.0, 1.0],
        angular_velocity=[0.1, 0.2, 0.3],
        angular_velocity_covariance=COVARIANCE,
        linear_acceleration=[0.0, 0.0, 9.81],
    )
    robot.step(controller, count=12)
    reading = controller.readings["base"]
    assert reading.frame_id == "base_link"
    assert reading.orientation == [0.0, 0.0, 0.0, 1.0]
    assert reading.orientation_covariance == [0.0] * 9
    assert reading.angular_velocity == [0.1, 0.2, 0.3]
    assert reading.angular_velocity_covariance == COVARIANCE
    assert reading.linear_acceleration == [0.0, 0.0, 9.81]


def test_what_is_not_measured_is_marked(robot):
    controller = _start(robot)
    robot.step(controller, count=12)
    reading = controller.readings["base"]
    unknown = [-1.0] + [0.0] * 8
    assert reading.orientation == [0.0] * 4
    assert reading.angular_velocity == reading.linear_acceleration == [0.0] * 3
    assert reading.orientation_covariance == unknown
    assert reading.angular_velocity_covariance == unknown
    assert reading.linear_acceleration_covariance == unknown


def test_imus_are_published_at_the_rate(robot):
    controller = _start(robot)
    stamps = set()
    for _ in range(1000):
        robot.step(controller)
        stamps.update(reading.stamp for reading in controller.readings.values())
    assert 98 <= len(stamps) <= 100


def test_imus_need_a_publish_rate(robot):
    robot.register_interface(ImuSensorInterface())
    with pytest.raises(ParameterError, match="'arm/publish_rate' is missing"):
        robot.load(ImuSensorController)


def test_its_messages_can_be_asked_for_by_sensor(robot):
    controller = _start(robot)
    assert controller.published() == {}
    robot.step(controller, count=20)

    assert "angular_velocity" in controller.published()["base"]
