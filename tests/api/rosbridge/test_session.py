"""Operations of rosbridge: topics, services, goals, and what is refused."""

import hashlib
import json
import re
import time

import pytest

from station.core.control.switching import SwitchRequest
from tests.api.conftest import OPERATOR
from tests.api.rosbridge.conftest import JOINTS, RosClient
from tests.waiting import wait_until

# Long enough for a busy machine to see a goal active.
TRAJECTORY = {
    "joint_names": JOINTS,
    "points": [{"positions": [0.1, 0.2], "time_from_start": {"secs": 1, "nsecs": 0}}],
}
ACTION = "/arm/follow_joint_trajectory"


def state_of(station, name):
    return station.controller(name).state.value


@pytest.mark.parametrize(
    ("kind", "stamp"),
    [
        ("sensor_msgs/JointState", {"secs", "nsecs"}),
        ("sensor_msgs/msg/JointState", {"sec", "nanosec"}),
        (None, {"secs", "nsecs"}),
    ],
)
def test_joint_states_come_in_the_style_of_the_type(client, kind, stamp):
    more = {} if kind is None else {"type": kind}
    found = client.subscribe("/joint_states", **more)["msg"]
    assert found["name"] == JOINTS
    assert len(found["position"]) == 2
    assert set(found["header"]["stamp"]) == stamp
    assert ("seq" in found["header"]) is ("secs" in stamp)


def test_a_latched_topic_comes_at_once(client):
    text = client.subscribe("/robot_description")["msg"]["data"]
    assert text.startswith("<robot")


def test_controllers_are_listed_loaded_and_switched(client, station):
    manager = "/controller_manager"
    client.values(
        "/rosapi/set_param",
        {
            "name": "/own",
            "value": json.dumps({
                "type": "position_controllers/JointGroupPositionController",
                "joints": JOINTS,
            }),
        },
    )
    assert client.values(f"{manager}/load_controller", {"name": "own"}) == {"ok": True}
    listed = client.values(f"{manager}/list_controllers")["controller"]
    (own,) = [one for one in listed if one["name"] == "own"]
    assert own["state"] == "initialized"
    assert own["claimed_resources"][0]["resources"] == JOINTS
    assert client.switch(start=["own"])
    assert state_of(station, "own") == "running"
    assert client.switch(stop=["own"])
    assert client.values(f"{manager}/unload_controller", ["own"]) == {"ok": True}


def test_a_switch_that_is_refused_is_not_ok_and_says_why(client, station):
    assert client.switch(start=["pose"])
    assert not client.switch(start=["arm"])
    assert state_of(station, "arm") == "initialized"
    assert "pose" in client.statuses[-1]["msg"]


def test_a_set_point_reaches_its_controller(client, station):
    client.switch(start=["pose"])
    client.send("advertise", topic="/pose/command", type="std_msgs/Float64MultiArray")
    client.send("publish", topic="/pose/command", msg={"data": [0.25, -0.5]})
    client.values("/rosapi/get_time")
    assert wait_until(lambda: station.motion.set_point("pose").values == (0.25, -0.5))
    assert client.statuses == []


def test_a_goal_of_ros2_reports_feedback_and_its_result(client):
    client.switch(start=["arm"])
    client.send(
        "send_action_goal",
        action=ACTION,
        id="g",
        feedback=True,
        action_type="control_msgs/action/FollowJointTrajectory",
        args={"trajectory": TRAJECTORY},
    )
    feedback = client.until("action_feedback")
    assert feedback["values"]["joint_names"] == JOINTS
    assert "sec" in feedback["values"]["header"]["stamp"]
    result = client.until("action_result", id="g")
    assert (result["status"], result["result"]) == (4, True)
    assert result["values"]["error_code"] == 0


def test_motion_primitives_are_an_action_and_are_refused_by_index(client):
    client.switch(start=["arm"])
    motion = {"type": 0, "joint_positions": [0.1, 0.2]}
    for goal, motions in (("g", [motion]), ("h", [motion, {**motion, "type": 3}])):
        client.send(
            "send_action_goal",
            action="/arm/motion_sequence",
            id=goal,
            action_type="control_msgs/action/ExecuteMotionPrimitiveSequence",
            args={"trajectory": {"motions": motions}},
        )
        result = client.until("action_result", id=goal)
        if goal == "g":
            assert (result["status"], result["values"]["error_code"]) == (4, 0)
        else:
            assert "motions/1/type" in str(result["values"])


def test_a_goal_of_actionlib_reports_on_its_topics(client):
    client.switch(start=["arm"])
    assert client.subscribe(f"{ACTION}/status")["msg"]["status_list"] == []
    client.send("unsubscribe", topic=f"{ACTION}/status")
    for name in ("feedback", "result"):
        client.send("subscribe", topic=f"{ACTION}/{name}")
    goal = {"goal_id": {"id": "one"}, "goal": {"trajectory": TRAJECTORY}}
    client.send("publish", topic=f"{ACTION}/goal", msg=goal)
    feedback = client.until("publish", topic=f"{ACTION}/feedback")["msg"]
    assert feedback["status"]["status"] == 1
    assert feedback["feedback"]["joint_names"] == JOINTS
    result = client.until("publish", topic=f"{ACTION}/result")["msg"]
    assert result["status"]["goal_id"]["id"] == "one"
    assert result["status"]["status"] == 3
    assert result["result"]["error_code"] == 0


@pytest.mark.parametrize("way", ["operation", "topic"])
def test_a_goal_is_cancelled(client, way):
    client.switch(start=["arm"])
    slow = {
        "joint_names": JOINTS,
        "points": [
            {"positions": [0.1, 0.2], "time_from_start": {"secs": 60, "nsecs": 0}}
        ],
    }
    client.send("subscribe", topic=f"{ACTION}/result")
    client.send(
        "send_action_goal",
        action=ACTION,
        id="g",
        feedback=True,
        args={"trajectory": slow},
    )
    client.until("action_feedback")
    if way == "operation":
        client.send("cancel_action_goal", action=ACTION, id="g")
    else:
        client.send("publish", topic=f"{ACTION}/cancel", msg={})
    assert client.until("action_result", id="g")["status"] == 5


def test_a_goal_that_is_refused_ends_as_rejected(client):
    client.switch(start=["arm"])
    client.send("subscribe", topic=f"{ACTION}/result")
    goal = {"goal": {"trajectory": {**TRAJECTORY, "joint_names": ["joint1", "nose"]}}}
    client.send("publish", topic=f"{ACTION}/goal", msg=goal)
    result = client.until("publish")["msg"]
    assert (result["status"]["status"], result["result"]["error_code"]) == (5, -2)
    assert "nose" in result["status"]["text"]
    client.send("send_action_goal", action=ACTION, id="g", args=goal["goal"])
    refused = client.until("action_result", id="g")
    assert refused["result"] is False
    assert "nose" in refused["values"]


def test_a_goal_that_nobody_takes_has_no_error_code_of_success(client):
    client.send("subscribe", topic=f"{ACTION}/result")
    goal = {"goal": {"trajectory": TRAJECTORY}}
    client.send("publish", topic=f"{ACTION}/goal", msg=goal)
    found = client.until("publish")["msg"]
    assert (found["status"]["status"], found["result"]["error_code"]) == (5, -1)
    assert "running" in found["result"]["error_string"]


def test_a_time_before_the_start_of_the_station_is_refused_by_its_field(client):
    client.switch(start=["arm"])
    found = client.call("/arm/query_state", {"time": {"secs": 5, "nsecs": 0}})
    assert found["result"] is False
    assert re.match(r"'args/time' is \d+\.\d+ s before the start", found["values"])


def test_a_number_that_json_does_not_have_is_refused_by_its_field(client):
    # Python's json writes NaN and Infinity.
    client.send("publish", topic="/pose/command", msg={"data": [0.1, float("nan")]})
    assert "'msg/data/1' is nan" in client.until("status")["msg"]
    answer = client.call("/rosapi/get_param", {"name": float("inf")})
    assert answer["values"] == "'args/name' is inf; it must be a text."


@pytest.mark.parametrize("op", ["subscribe", "advertise"])
def test_a_misspelt_topic_of_the_station_is_named_with_its_likeness(client, op):
    client.send(op, topic="/pose/comand", type="std_msgs/Float64MultiArray")
    assert "Did you mean '/pose/command'" in client.until("status")["msg"]


def test_a_gain_is_set_by_dynamic_reconfigure(client, station):
    doubles = [{"name": "p", "value": 25.0}]
    for service in ("/single/joint1/pid/set_parameters", "/single/pid/set_parameters"):
        if client.values("/rosapi/service_type", {"service": service})["type"]:
            break
    answer = client.values(service, {"config": {"doubles": doubles}})
    assert {"name": "p", "value": 25.0} in answer["config"]["doubles"]
    assert 25.0 in station.tuning.gains("single").values.values()


REFUSED = {
    "unknown topic": ({"op": "subscribe", "topic": "/joint_stats"}, "/joint_states"),
    "wrong type": (
        {"op": "subscribe", "topic": "/joint_states", "type": "std_msgs/String"},
        "sensor_msgs/JointState",
    ),
    "wrong compression": (
        {"op": "subscribe", "topic": "/joint_states", "compression": "zip"}, "zip"
    ),
    "unknown field": (
        {"op": "publish", "topic": "/pose/command", "msg": {"dat": [1.0]}}, "dat"
    ),
    "wrong value": (
        {"op": "publish", "topic": "/pose/command", "msg": {"data": [1.0, "x"]}},
        "msg/data/1",
    ),
    "not to be published": (
        {"op": "advertise", "topic": "/joint_states"}, "/pose/command"
    ),
    "not running": (
        {"op": "publish", "topic": "/pose/command", "msg": {"data": [1.0, 2.0]}},
        "initialized",
    ),
    "no type": ({"op": "advertise_service", "service": "/x"}, "no field 'type'"),
    "taken": (
        {"op": "advertise_service", "service": "/stop/x", "type": "std_srvs/Empty"},
        "a name of the station",
    ),
    "taken topic": (
        {"op": "advertise", "topic": "/pose/own", "type": "std_msgs/String"},
        "a name of the station",
    ),
    "response": ({"op": "service_response", "service": "/x", "id": "9"}, "'9'"),
    "not offered": ({"op": "unadvertise_action", "action": "/x"}, "/x"),
    "unknown op": ({"op": "dance"}, "dance"),
    "no op": ({"topic": "/x"}, "no field 'op'"),
    "no topic": ({"op": "subscribe"}, "no field 'topic'"),
    "unknown level": ({"op": "set_level", "level": "loud"}, "none, error, warning"),
    "no parts": (
        {"op": "fragment", "num": 0, "total": 0, "data": ""}, "'total' is 0"
    ),
    "unknown goal": ({"op": "cancel_action_goal", "id": "nine"}, "nine"),
    "not authentic": (
        {"op": "auth", "mac": "0", "client": "c", "dest": "d", "rand": "r", "t": 0,
         "level": "all", "end": 0},
        "token",
    ),
    "no time": (
        {"op": "auth", "mac": "0", "client": "c", "dest": "d", "rand": "r", "t": "x",
         "level": "all", "end": 0},
        "'t' is 'x'",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_wrong_is_named_in_a_status(client, case):
    message, named = REFUSED[case]
    client.socket.send(json.dumps({**message, "id": message.get("id", "m")}))
    status = client.until("status")
    assert status["level"] == "error"
    assert named in status["msg"]
    assert status["id"] == message.get("id", "m")


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ('{"op": "dance", "op": "subscribe", "topic": "/tf"}', "op"),
        ('{"op": "publish", "msg": {"data": [1], "data": [2]}}', "data"),
        ('{"op": "publish", "msg": {"data": NaN, "data": ":"}}', "data"),
        (r'{"op": "publish", "msg": {"data": 1, "data": "\u003a"}}', "data"),
    ],
)
def test_a_key_that_comes_twice_is_refused(client, text, key):
    client.socket.send(text)
    assert f"has the key '{key}' twice" in client.until("status")["msg"]


@pytest.mark.parametrize(
    ("message", "told"),
    [
        # rosbridge_library's tests of missing and of invalid arguments
        ({"op": "advertise", "topic": 3, "type": "std_msgs/String"}, "'topic' is 3"),
        ({"op": "publish", "topic": 3}, "'topic' is 3"),
        ({"op": "subscribe", "topic": 3}, "'topic' is 3"),
        ({"op": "call_service"}, "no field 'service'"),
        ({"op": "call_service", "service": 3}, "'service' is 3"),
        ({"op": "advertise_service", "type": 42, "service": None}, "'service' is None"),
        ({"op": "advertise_service", "type": 42, "service": "/x/y"}, "'type' is 42"),
        ({"op": "advertise_action", "type": 42, "action": None}, "'action' is None"),
        ({"op": "service_response"}, "no field 'id'"),
        ({"op": "action_result"}, "no field 'id'"),
        ({"op": "send_action_goal", "action_type": "a/b"}, "no field 'action'"),
        ({"op": "cancel_action_goal"}, "no field 'id'"),
    ],
)
def test_a_missing_or_wrong_name_is_told_as_such(client, message, told):
    client.send(**message)
    assert told in client.until("status")["msg"]


def test_an_identifier_may_stand_behind_the_name_of_a_service(client):
    client.send("call_service", service="/rosapi/get_time#33")
    found = client.until("service_response", id="33")
    assert (found["service"], found["result"]) == ("/rosapi/get_time#33", True)


def test_a_wrong_request_of_a_service_is_named(client):
    service = "/controller_manager/load_controller"
    found = client.call(service, {"nam": "x"})
    assert found["result"] is False
    assert "'nam'" in found["values"]
    assert "'nam'" in client.statuses[-1]["msg"]


def test_a_fault_of_the_station_is_not_the_clients(
    client, station, monkeypatch, caplog
):
    def fail(*_):
        raise KeyError("lost")

    monkeypatch.setattr(type(station), "controllers", fail)
    found = client.call("/controller_manager/list_controllers")
    assert found["result"] is False
    assert "The station failed unexpectedly: KeyError" in found["values"]
    assert "lost" in caplog.text


def test_levels_of_statuses(client):
    client.send("set_level", level="none")
    client.send("dance")
    client.values("/rosapi/get_time")
    assert client.statuses == []


def test_a_message_comes_in_fragments(client):
    text = json.dumps({"op": "call_service", "service": "/rosapi/nodes", "id": "c"})
    half = len(text) // 2
    for num, data in ((1, text[half:]), (0, text[:half])):
        client.send("fragment", id="f", num=num, total=2, data=data)
    assert client.until("service_response")["result"]


def test_a_throttled_topic_is_slower(client):
    client.send("subscribe", topic="/joint_states", throttle_rate=200)
    stamps = []
    for _ in range(4):
        stamp = client.until("publish")["msg"]["header"]["stamp"]
        stamps.append(stamp["secs"] + stamp["nsecs"] / 1e9)
    assert stamps[-1] - stamps[0] == pytest.approx(0.6, abs=0.1)


def test_a_subscription_ends_by_its_identifier(client):
    for identifier in ("a", "b"):
        client.subscribe("/joint_states", id=identifier)
    client.send("unsubscribe", topic="/joint_states", id="a")
    client.until("publish")
    client.send("unsubscribe", topic="/joint_states", id="b")
    client.values("/rosapi/get_time")
    with pytest.raises(TimeoutError):
        client.socket.recv(timeout=0.2)


def test_a_client_proves_the_operators_token_by_a_mac(serve, station):
    _, url = serve()
    with RosClient(url) as client:
        assert not client.call("/stop/release")["result"]
        fields = {
            "client": "c",
            "dest": "d",
            "rand": "r",
            "t": int(time.time()),
            "level": "admin",
            "end": 0,
        }
        text = OPERATOR + "".join(str(value) for value in fields.values())
        mac = hashlib.sha512(text.encode()).hexdigest()
        client.send("auth", mac=mac, **fields)
        assert client.switch(start=["pose"])
    assert state_of(station, "pose") == "running"


def test_anybody_stops_and_an_operator_releases(serve, station):
    _, url = serve()
    station.switch_controllers(SwitchRequest(start=["pose"]))
    with RosClient(url) as viewer:
        assert viewer.values("/stop")["success"]
    assert station.loop.stop_latch.state.value == "stopped"
    with RosClient(f"{url}?token={OPERATOR}") as operator:
        assert operator.values("/stop/release")["success"]
        assert operator.values("/stop/arm")["success"]
        assert operator.switch(start=["pose"])


def test_topics_have_the_types_of_ros_control(client):
    topics = client.values("/rosapi/topics")
    kinds = dict(zip(topics["topics"], topics["types"], strict=True))
    assert kinds["/tf"] == "tf2_msgs/TFMessage"
    assert kinds["/arm/state"] == "control_msgs/JointTrajectoryControllerState"
    assert kinds["/single/state"] == "control_msgs/JointControllerState"
    assert kinds["/pose/state"] == "control_station_msgs/ControllerState"
    assert kinds["/single/command"] == "std_msgs/Float64"


@pytest.mark.parametrize("topic", ["/arm/state", "/single/state", "/pose/state"])
def test_the_states_of_controllers_are_published(client, topic):
    client.switch(start=[topic.split("/")[1]])
    message = client.subscribe(topic)["msg"]
    assert message["header"]["stamp"]["secs"] > 0


def test_transforms_of_moving_and_fixed_joints(client):
    moving = client.subscribe("/tf")["msg"]["transforms"]
    assert [one["child_frame_id"] for one in moving] == JOINTS
    fixed = client.subscribe("/tf_static", type="tf2_msgs/msg/TFMessage")
    assert fixed["msg"]["transforms"] == []


def test_a_name_without_a_slash_is_the_same(client):
    found = client.subscribe("joint_states")
    assert found["topic"] == "joint_states"
    assert client.values("rosapi/topic_type", {"topic": "/tf"})["type"]


def test_queues_together_are_bounded(client):
    client.subscribe("/tf", queue_length=1500)
    client.send("subscribe", topic="/joint_states", queue_length=600)
    assert "2000 messages" in client.until("status")["msg"]
