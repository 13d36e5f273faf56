"""Sensors on links read what physics says."""

from math import cos, inf, pi, sin

import pytest

from station.core.errors import ParameterError
from station.core.hardware.interfaces import (
    ForceTorqueSensorInterface,
    ImuSensorInterface,
    MagneticFieldSensorInterface,
    RangeSensorInterface,
)
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW

GRAVITY = 9.81
# A turning column with a hand of 2 kg, 0.3 m out and fixed by a joint.
ROBOT = """
<robot name="r">
  <link name="base"/>
  <link name="column"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="continuous"><parent link="base"/><child link="column"/>
    <axis xyz="0 0 1"/></joint>
  <link name="flange"/>
  <joint name="f" type="fixed"><parent link="column"/><child link="flange"/>
    <origin xyz="0 0 0.5"/></joint>
  <link name="hand"><inertial><origin xyz="0.3 0 0"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="h" type="fixed"><parent link="flange"/><child link="hand"/></joint>
  <link name="probe"/>
  <joint name="p" type="fixed"><parent link="flange"/><child link="probe"/>
    <origin xyz="0.1 0 0.2" rpy="0 1.0471975512 0"/></joint>
</robot>
"""


@pytest.fixture
def make(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT)

    def make_robot(kind, link, **parameters):
        robot = {
            "robot_description": str(path),
            "sensors": {"s": {"type": kind, "link": link}},
            **parameters,
        }
        tree = ParameterTree({"robot": robot})
        hw = MujocoRobotHW()
        hw.init(Parameters(tree), Parameters(tree, "robot"))
        for _ in range(5):
            hw.write(0.0, 0.001)
            hw.read(0.0, 0.001)
        return hw

    return make_robot


def test_force_torque_sensor_reads_the_weight_that_it_holds(make):
    hw = make("force_torque", "hand")
    sensor = hw.get(ForceTorqueSensorInterface).get_handle("s")
    assert sensor.get_frame_id() == "hand"
    assert sensor.get_force() == pytest.approx([0.0, 0.0, 2.0 * GRAVITY], abs=1e-6)
    # r x F with r along x and F along z
    moment = -0.3 * 2.0 * GRAVITY
    assert sensor.get_torque() == pytest.approx([0.0, moment, 0.0], abs=1e-6)


def test_imu_reads_gravity_and_orientation(make):
    hw = make("imu", "flange", initial_positions={"j": pi / 3.0})
    imu = hw.get(ImuSensorInterface).get_handle("s")
    assert imu.get_linear_acceleration() == pytest.approx([0, 0, GRAVITY], abs=1e-6)
    half = pi / 6.0
    assert imu.get_orientation() == pytest.approx([0, 0, sin(half), cos(half)])


def test_imu_reads_the_rate_of_turn(make):
    hw = make("imu", "flange")
    hw.world.data.qvel[0] = 0.5
    hw.read(0.0, 0.001)
    imu = hw.get(ImuSensorInterface).get_handle("s")
    assert imu.get_angular_velocity() == pytest.approx([0.0, 0.0, 0.5], abs=0.05)


def test_unknown_link_is_refused(make):
    with pytest.raises(ParameterError, match="'tail'") as caught:
        make("imu", "tail")
    assert "flange" in caught.value.remedy


def test_robot_without_sensors_has_no_interface_for_them(make):
    hw = make("imu", "flange", sensors={})
    assert hw.get(ImuSensorInterface) is None
    assert hw.get(ForceTorqueSensorInterface) is None


def test_range_sensor_measures_along_the_x_axis_of_its_link(make):
    # The x axis of the probe, 0.7 m above the floor, points 60 degrees below the level.
    sensor = make("range", "probe").get(RangeSensorInterface).get_handle("s")
    assert sensor.get_frame_id() == "probe"
    assert sensor.get_values() == {"range": pytest.approx(0.7 / sin(pi / 3), abs=1e-6)}


def test_range_sensor_that_sees_nothing_measures_infinity(make):
    level = make("range", "flange").get(RangeSensorInterface).get_handle("s")
    assert level.get_values() == {"range": inf}


def test_magnetometer_turns_with_its_link(make):
    hw = make("magnetometer", "hand", initial_positions={"j": pi / 2})
    values = hw.get(MagneticFieldSensorInterface).get_handle("s").get_values()
    # To the north is the hand's x axis now, and up stays up.
    expected = [21.01e-6, -1.52e-6, -43.94e-6]
    assert [*values.values()] == pytest.approx(expected, abs=1e-10)
    assert [*values] == [f"magnetic_field.{axis}" for axis in "xyz"]


def test_magnetic_field_is_that_of_the_configuration(make):
    hw = make("magnetometer", "probe", magnetic_field=[0.0, 0.0, -5e-5])
    values = hw.get(MagneticFieldSensorInterface).get_handle("s").get_values()
    # The probe leans forward by 60 degrees.
    expected = [5e-5 * sin(pi / 3), 0.0, -5e-5 * cos(pi / 3)]
    assert [*values.values()] == pytest.approx(expected, abs=1e-10)
