"""Definitions, defaults and bytes of messages, compared with the types of rosbags."""

import json

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from station.api.rosbridge import ros_types
from station.api.rosbridge.ros_types import (
    RosTypeError,
    checked,
    filled,
    find_type,
    in_style,
    serialized,
    type_definitions,
)
from station.core.franka.franka_robot_state import RobotState
from station.records.messages import FRANKA_STATE

STORES = {
    True: get_typestore(Stores.ROS2_HUMBLE),
    False: get_typestore(Stores.ROS1_NOETIC),
}
SHARED = sorted(
    name
    for name in ros_types._TYPES
    if any(name.replace("/", "/msg/") in store.types for store in STORES.values())
)
TRAJECTORY = {
    "header": {"stamp": {"sec": 5, "nanosec": 7}, "frame_id": "world"},
    "joint_names": ["a", "bc"],
    "points": [
        {
            "positions": [1.0, 2.5],
            "velocities": [],
            "time_from_start": {"sec": 1, "nanosec": 500},
        }
    ],
}


def built(store, name, message):
    """Return a message of rosbags."""
    kind = store.types[name]
    values = {}
    for field, (node, inner) in store.fielddefs[name][1]:
        value = message.get(field, 0)
        if node.name == "NAME":
            value = built(store, inner, value)
        elif node.name in {"ARRAY", "SEQUENCE"} and inner[0][0].name == "NAME":
            value = [built(store, inner[0][1], one) for one in value]
        elif node.name in {"ARRAY", "SEQUENCE"} and inner[0][1][0] != "string":
            value = np.array(value, dtype=np.dtype(inner[0][1][0]))
        values[field] = value
    return kind(**values)


@pytest.mark.parametrize("ros2", [True, False])
def test_messages_have_the_fields_of_ros(ros2):
    store = STORES[ros2]
    compared = 0
    for name in SHARED:
        other = store.fielddefs.get(name.replace("/", "/msg/"))
        if other is None:
            continue
        fields = [field.name for field in find_type(name).fields]
        if ros2 and name == "std_msgs/Header":
            fields.remove("seq")
        assert fields == [field for field, _ in other[1]], name
        compared += 1
    assert compared >= 20


@pytest.mark.parametrize("ros2", [True, False])
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("trajectory_msgs/JointTrajectory", TRAJECTORY),
        ("sensor_msgs/JointState", {"name": ["j"], "position": [0.25], "effort": []}),
        ("std_msgs/Float64MultiArray", {"data": [1.0, -2.0]}),
    ],
)
def test_bytes_are_those_of_ros(name, message, ros2):
    store, full = STORES[ros2], checked(name, message)
    kind = name.replace("/", "/msg/")
    expected = built(store, kind, full)
    data = serialized(name, full, ros2=ros2)
    if ros2:
        assert data == bytes(store.serialize_cdr(expected, kind))
    else:
        assert data == bytes(store.serialize_ros1(expected, kind))


def test_a_message_of_ros1_has_its_own_times():
    message = in_style(
        "trajectory_msgs/JointTrajectory",
        checked("trajectory_msgs/JointTrajectory", TRAJECTORY),
        ros2=False,
    )
    assert message["header"]["stamp"] == {"secs": 5, "nsecs": 7}
    assert message["points"][0]["time_from_start"] == {"secs": 1, "nsecs": 500}


@pytest.mark.parametrize(
    ("name", "message", "told"),
    [
        ("sensor_msgs/JointState", {"positions": [1]}, "'positions'"),
        ("sensor_msgs/JointState", {"position": 1.0}, "'msg/position'"),
        ("sensor_msgs/JointState", {"position": [True]}, "'msg/position/0' is True"),
        ("sensor_msgs/JointState", {"position": [None]}, "'msg/position/0' is None"),
        ("sensor_msgs/JointState", {"position": [10**400]}, "a huge number"),
        ("sensor_msgs/JointState", {"name": [3]}, "'msg/name/0'"),
        ("sensor_msgs/JointState", {"header": []}, "'msg/header' is a list"),
        ("rosgraph_msgs/Clock", {"clock": {"hours": 1}}, "'msg/clock'"),
        ("rosgraph_msgs/Clock", {"clock": {"secs": 1.5}}, "'msg/clock/secs' is 1.5"),
        ("rosgraph_msgs/Clock", {"clock": {"secs": 2**40}}, "int32"),
        ("franka_msgs/SetLoadRequest", {"F_x_center_load": [1.0]}, "must have 3"),
        ("controller_manager_msgs/SwitchControllerRequest", {"start_asap": 1}, "true"),
        ("own/Type", {"a": json.loads("[" * 40 + "]" * 40)}, "30 levels"),
        ("std_msgs/Header", {"stamp": {"secs": -5}}, "msg/stamp/secs"),
    ],
)
def test_what_does_not_fit_is_named(name, message, told):
    with pytest.raises(RosTypeError) as refused:
        checked(name, message)
    assert told in str(refused.value)


def test_the_state_of_an_arm_has_the_names_of_libfranka():
    names = [field.name for field in find_type("franka_msgs/FrankaState").fields]
    assert [name.lower() for name in names] == [one.name for one in FRANKA_STATE.fields]
    own = set(RobotState.__dataclass_fields__)
    assert [name for name in names if name not in own] == ["header"]


def test_a_report_is_filled_in_by_the_names_of_its_fields():
    wrench = filled(
        "geometry_msgs/WrenchStamped",
        {"force": [1.0, 2.0, 3.0], "torque": [4.0, 5.0, 6.0], "frame_id": "panda_K"},
        1_500_000_000,
    )
    assert wrench["wrench"]["torque"] == {"x": 4.0, "y": 5.0, "z": 6.0}
    assert wrench["header"]["stamp"] == {"sec": 1, "nanosec": 500_000_000}
    errors = filled("franka_msgs/FrankaState", {"current_errors": ["joint_reflex"]}, 0)
    assert errors["current_errors"]["joint_reflex"] is True
    assert sum(errors["current_errors"].values()) == 1


def test_definitions_name_the_types_inside():
    found = type_definitions("geometry_msgs/msg/PoseStamped")
    assert [one["type"] for one in found] == [
        "geometry_msgs/PoseStamped",
        "std_msgs/Header",
        "geometry_msgs/Pose",
        "geometry_msgs/Point",
        "geometry_msgs/Quaternion",
    ]
    (load,) = type_definitions("franka_msgs/SetLoadRequest")
    assert load["fieldarraylen"] == [-1, 3, 9]
    switch = type_definitions("controller_manager_msgs/SwitchControllerRequest")[0]
    assert dict(zip(switch["constnames"], switch["constvalues"], strict=True)) == {
        "BEST_EFFORT": "1",
        "STRICT": "2",
    }
