"""What a simulated robot may be told."""

import pytest

from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.mujoco_robot_parameters import (
    LimitMode,
    SensorRequest,
    SensorType,
    read_parameters,
)


def read(**parameters: object):
    values = {"robot_description": "arm.urdf", **parameters}
    return read_parameters(Parameters(ParameterTree(values)))


def test_all_but_the_description_have_defaults():
    found = read()
    assert found.robot_description == "arm.urdf"
    assert (found.timestep, found.armature, found.has_floor) == (0.001, 0.1, True)
    assert found.gravity_compensation is True
    assert found.limit_mode is LimitMode.ROS_CONTROL


def test_sensors_are_read():
    found = read(sensors={"ft": {"type": "force_torque", "link": "tool0"}})
    assert found.sensors == (SensorRequest("ft", SensorType.FORCE_TORQUE, "tool0"),)


@pytest.mark.parametrize(
    ("key", "value", "named"),
    [
        ("robot_description", 5, "robot_description"),
        ("armature", -0.1, "armature"),
        ("timestep", 0.0, "timestep"),
        ("timestep", 0.5, "timestep"),
        ("base_rpy", [90.0, 0.0, 0.0], "base_rpy"),
        ("base_xyz", [1.0, 2.0], "base_xyz"),
        ("limit_mode", "none", "limit_mode"),
        ("initial_positions", {"j": "up"}, "initial_positions/j"),
        ("sensors", {"s": {"type": "nose", "link": "l"}}, "sensors/s/type"),
        ("sensors", {"s": {"type": "imu"}}, "sensors/s/link"),
        ("sensors", {"s": {"type": "imu", "link": "l", "x": 1}}, "sensors/s/x"),
        ("colour", "red", "colour"),
    ],
)
def test_impossible_values_are_refused_by_name(key, value, named):
    with pytest.raises(ParameterError, match=named):
        read(**{key: value})
