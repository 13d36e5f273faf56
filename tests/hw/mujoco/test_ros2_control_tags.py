"""A URDF with `<ros2_control>` elements is simulated as these elements say."""

from math import inf

import pytest

from station.app.any_robot import configure_robot
from station.core.errors import ResourceNotFoundError, RobotDescriptionError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    ForceTorqueSensorInterface,
    GpioCommandInterface,
    GpioStateInterface,
    GpsSensorInterface,
    JointStateInterface,
    MagneticFieldSensorInterface,
    PositionJointInterface,
    RangeSensorInterface,
    VelocityJointInterface,
)
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW

INERTIAL = """<inertial><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>"""
# Joints a, b and c turn about upright axes; d mimics c.
ROBOT = '<robot name="r"><link name="base"/>' + "".join(
    f"""<link name="link_{name}">{INERTIAL}</link>
    <joint name="{name}" type="revolute"><parent link="{parent}"/>
    <child link="link_{name}"/><axis xyz="0 0 1"/><origin xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="50" velocity="3"/>{mimic}</joint>"""
    for name, parent, mimic in (
        ("a", "base", ""),
        ("b", "link_a", ""),
        ("c", "link_b", ""),
        ("d", "link_c", '<mimic joint="c" multiplier="-1"/>'),
    )
)
PLUGIN = "<hardware><plugin>{}</plugin></hardware>"
MUJOCO = PLUGIN.format("mujoco_ros2_control/MujocoSystemInterface")
TAG = f"""<ros2_control name="sim" type="system">{MUJOCO}
  <joint name="a"><command_interface name="position">
      <param name="min">-0.5</param><param name="max">9</param></command_interface>
    <command_interface name="velocity"><param name="min">-1</param>
      <param name="max">2</param></command_interface>
    <state_interface name="position"><param name="initial_value">0.25</param>
    </state_interface></joint>
  <joint name="b"><command_interface name="torque"><limits enable="false"/>
    </command_interface><command_interface name="stiffness"/></joint>
  <joint name="d" mimic="false"/>
  <sensor name="ft"><param name="frame_id">link_b</param>
    <state_interface name="force.x"/><state_interface name="torque.x"/></sensor>
  <sensor name="link_c"><state_interface name="magnetic_field.x"/></sensor>
  <sensor name="eye"><state_interface name="range"/></sensor>
  <sensor name="gps"><state_interface name="latitude">
    <param name="initial_value">48.1</param></state_interface></sensor>
  <sensor name="camera"/>
  <sensor name="lost"><state_interface name="force.x"/></sensor>
  <gpio name="io"><command_interface name="out" data_type="bool"/>
    <state_interface name="out"/><state_interface name="in">
    <param name="initial_value">7</param></state_interface></gpio>
</ros2_control>
<gazebo reference="a"><sensor name="eye" type="ray"/></gazebo>"""


@pytest.fixture
def make(tmp_path):
    def write(tag, robot=ROBOT):
        path = tmp_path / "r.urdf"
        path.write_text(f"{robot}{tag}</robot>")
        return str(path)

    def make_robot(tag=TAG, **parameters):
        robot = {"robot_description": write(tag), **parameters}
        tree = ParameterTree({"robot": robot})
        hw = MujocoRobotHW()
        hw.init(Parameters(tree), Parameters(tree, "robot"))
        return hw

    make_robot.write = write
    return make_robot


def test_only_the_named_command_interfaces_are_offered(make):
    hw = make()
    assert hw.get(PositionJointInterface).get_names() == ["a"]
    assert hw.get(VelocityJointInterface).get_names() == ["a"]
    assert hw.get(EffortJointInterface).get_names() == ["b"]
    assert set(hw.get(JointStateInterface).get_names()) == {"a", "b", "c", "d"}
    with pytest.raises(ResourceNotFoundError, match="'c'"):
        hw.get(PositionJointInterface).get_handle("c")
    everything = make(ros2_control="ignore")
    assert everything.get(EffortJointInterface).get_names() == ["a", "b", "c"]


def test_the_narrower_limits_count_and_the_report_tells_their_source(make):
    by_joint = {each.joint: each for each in make().joint_limits()}
    a, b, c = (by_joint[name] for name in "abc")
    assert (a.limits.min_position, a.limits.max_position) == (-0.5, 2.0)
    assert (a.limits.max_velocity, a.limits.max_effort) == (1.0, 50.0)
    assert a.sources["position"] == a.sources["velocity"] == "urdf ros2_control"
    assert a.sources["effort"] == "urdf limit"
    assert b.limits.max_effort is None
    assert (c.limits.max_velocity, c.sources["velocity"]) == (3.0, "urdf limit")


def test_a_robot_begins_as_the_elements_say_and_the_configuration_wins(make):
    def position(hw, name):
        return hw.get(JointStateInterface).get_handle(name).get_position()

    assert position(make(), "a") == pytest.approx(0.25)
    assert position(make(initial_positions={"a": 0.1}), "a") == pytest.approx(0.1)
    far = TAG.replace("0.25", "3")
    with pytest.raises(RobotDescriptionError, match=r"'a' .* begins at 3"):
        make(far)


def test_mimic_rules_are_switched_off_and_added(make):
    hw = make(initial_positions={"c": 0.5, "d": 0.2})  # d is a joint of its own
    assert hw.get(JointStateInterface).get_handle("d").get_position() == (
        pytest.approx(0.2)
    )
    older = f"""<ros2_control name="x" type="system">{MUJOCO}
      <joint name="a"/><joint name="b"><param name="mimic">a</param>
      <param name="multiplier">2</param></joint></ros2_control>"""
    hw = make(older, initial_positions={"a": 0.3})
    assert hw.get(JointStateInterface).get_handle("b").get_position() == (
        pytest.approx(0.6)
    )


def test_sensors_and_gpios_are_those_of_the_elements(make):
    hw = make()
    handle = hw.get(ForceTorqueSensorInterface).get_handle("ft")
    assert handle.get_frame_id() == "link_b"
    assert hw.get(RangeSensorInterface).get_handle("eye").get_frame_id() == "link_a"
    assert hw.get(MagneticFieldSensorInterface).get_names() == ["link_c"]
    gps = hw.get(GpsSensorInterface).get_handle("gps").get_values()
    assert gps["latitude"] == 48.1
    assert hw.get(GpioStateInterface).get_handle("io/in").get_value() == 7.0
    out = hw.get(GpioCommandInterface).get_handle("io/out")
    out.set_command(5.0)
    hw.write(0.0, 0.001)
    assert hw.get(GpioStateInterface).get_handle("io/out").get_value() == 1.0
    hw.simulated_world().reset({})
    assert out.get_command() == 0.0
    hw.read(0.0, 0.001)
    assert hw.get(RangeSensorInterface).get_handle("eye").get_values() == {"range": inf}


def test_what_is_left_out_is_told_by_name(make):
    told = {
        each.element: (each.problem, each.new)
        for each in make().repairs()
        if each.kind == "ros2_control"
    }
    assert "stiffness" in told["joint 'b'"][0]
    assert told["sensor 'camera'"][1] == told["sensor 'lost'"][1] == "left out"
    assert "frame_id" in told["sensor 'lost'"][0]
    assert told["sensor 'gps'"][1] == "constant"
    assert set(told) == {
        "joint 'b'", "sensor 'camera'", "sensor 'lost'", "sensor 'gps'",
    }  # fmt: skip
    # What the configuration says of a sensor goes before.
    known = make(sensors={"lost": {"type": "force_torque", "link": "link_a"}})
    assert known.get(ForceTorqueSensorInterface).get_names() == ["ft", "lost"]


def test_a_driver_is_simulated_and_named_and_refused_when_strict(make):
    tag = f"""<ros2_control name="ur" type="system">
      {PLUGIN.format("ur_robot_driver/URPositionHardwareInterface")}
      <joint name="a"><command_interface name="position"/></joint></ros2_control>"""
    (repair,) = (each for each in make(tag).repairs() if each.kind == "ros2_control")
    assert repair.old == "ur_robot_driver/URPositionHardwareInterface"
    assert repair.new == "simulated by MuJoCo"
    with pytest.raises(RobotDescriptionError, match="real hardware"):
        make(tag, strict=True)


def test_a_rate_of_its_own_is_told_and_refused_where_all_must_be_simulated(make):
    tag = TAG.replace('type="system"', 'type="system" is_async="true" rw_rate="50"')
    told = {each.problem: each.old for each in make(tag).repairs()}
    assert told["its rw_rate is not that of a simulation"] == "50"
    assert told["its is_async is not that of a simulation"] == "true"
    with pytest.raises(RobotDescriptionError, match="hardware 'sim': its is_async"):
        make(tag, strict=True)


def test_a_wrong_element_is_refused_with_its_file(make):
    with pytest.raises(RobotDescriptionError, match=r"r\.urdf: <ros2_control"):
        make('<ros2_control name="x" type="system"/>')


def test_transmissions_of_the_elements_are_used(make):
    tag = f"""<ros2_control name="x" type="system">{MUJOCO}
      <joint name="a"/><joint name="b"/>
      <transmission name="both"><plugin>transmission_interface/DifferentialTransmission
      </plugin><joint name="a" role="joint1"><mechanical_reduction>2
      </mechanical_reduction></joint><joint name="b" role="joint2"/>
      <actuator name="m1" role="actuator1"/><actuator name="m2" role="actuator2"/>
      </transmission>
      <transmission name="one"><plugin>transmission_interface/SimpleTransmission
      </plugin>
      <joint name="c" role="joint1"><mechanical_reduction>50</mechanical_reduction>
      </joint></transmission></ros2_control>"""
    hw = make(tag)
    found = {each.name: each for each in hw.transmissions()}
    assert found["both"].actuators == ("m1", "m2")
    assert found["one"].joints == ("c",)
    assert not [each for each in hw.repairs() if each.kind == "transmission"]


def test_controllers_of_a_robot_without_configuration_fit_the_elements(make):
    found = configure_robot(make.write(TAG))["controllers"]
    assert found["joint_trajectory_controller"]["joints"] == ["a"]
    assert found["effort_group_controller"]["joints"] == ["b"]
