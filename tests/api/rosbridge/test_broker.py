"""What clients offer to each other, and what they may not take."""

import base64

import pytest

from station.api.rosbridge.broker import MOST_OFFERS
from tests.api.conftest import OPERATOR
from tests.api.rosbridge.conftest import RosClient

TRIGGER = {"service": "/own/ask", "type": "std_srvs/Trigger"}
GROUP = "position_controllers/JointGroupPositionController"


@pytest.fixture
def two(serve):
    """Return two clients that may only look."""
    _, url = serve()
    with RosClient(url) as one, RosClient(url) as other:
        yield one, other


def settled(client):
    """Wait until the station has heard all that a client has said."""
    client.values("/rosapi/get_time")


@pytest.mark.parametrize(
    ("kind", "sent", "got"),
    [
        ("std_msgs/String", {"data": "a"}, {"data": "a"}),
        ("own_msgs/Thing", {"deep": [{"n": 1}]}, {"deep": [{"n": 1}]}),
        ("std_msgs/Header", {"stamp": {"sec": 5}}, {"secs": 5, "nsecs": 0}),
    ],
)
def test_a_topic_of_one_client_reaches_another(two, kind, sent, got):
    one, other = two
    other.send("subscribe", topic="/chatter", type=kind)
    settled(other)
    assert other.statuses == []
    one.send("advertise", topic="/chatter", type=kind)
    one.send("publish", topic="/chatter", msg=sent)
    found = other.until("publish", topic="/chatter")["msg"]
    assert found.get("stamp", found) == got
    topics = one.values("/rosapi/topics_for_type", {"type": kind})
    assert "/chatter" in topics["topics"]


def test_bytes_of_a_type_that_only_clients_know_are_refused(two):
    one, _ = two
    wish = {"topic": "/thing", "type": "own_msgs/Thing", "compression": "cbor-raw"}
    one.send("subscribe", **wish)
    assert "own_msgs/Thing" in one.until("status")["msg"]
    assert "/thing" not in one.values("/rosapi/topics")["topics"]


def test_a_name_that_looks_like_a_slip_is_told(two):
    one, _ = two
    one.send("subscribe", topic="/joint_stats", type="sensor_msgs/JointState")
    assert "'/joint_states'" in one.until("status")["msg"]


def test_rosapi_tells_who_has_to_do_with_a_topic(two):
    one, other = two
    one.send("advertise", topic="/chatter", type="std_msgs/String")
    other.send("subscribe", topic="/chatter")
    settled(other)
    settled(one)
    asked, node = {"topic": "/chatter"}, ["/rosbridge_websocket"]
    assert one.values("/rosapi/publishers", asked)["publishers"] == node
    assert one.values("/rosapi/subscribers", asked)["subscribers"] == node
    assert one.values("/rosapi/publishers", {"topic": "/tf"})["publishers"] == [
        "/station"
    ]
    details = one.values("/rosapi/node_details", {"node": node[0]})
    assert details["publishing"] == details["subscribing"] == ["/chatter"]


def test_a_topic_ends_with_the_last_who_has_to_do_with_it(two):
    one, other = two
    one.send("advertise", topic="/chatter", type="std_msgs/String")
    settled(one)
    other.send("subscribe", topic="/chatter")
    settled(other)
    one.send("unadvertise", topic="/chatter")
    settled(one)
    assert "/chatter" in one.values("/rosapi/topics")["topics"]
    other.send("unsubscribe", topic="/chatter")
    settled(other)
    assert "/chatter" not in one.values("/rosapi/topics")["topics"]


def test_what_is_latched_comes_to_who_subscribes_later(two):
    one, other = two
    kind = "std_msgs/String"
    one.send("advertise", topic="/map", type=kind, latch=True)
    one.send("publish", topic="/map", msg={"data": "x"})
    settled(one)
    assert other.subscribe("/map")["msg"] == {"data": "x"}


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"header": {}},
        {"header": {"frame_id": "map"}},
        {"header": {"stamp": "now"}},
    ],
)
def test_a_header_without_a_time_gets_the_present_one(two, given):
    # ROSBRIDGE_PROTOCOL.md 3.3.3 and rosbridge_library's test_message_conversion.py
    one, other = two
    kind = "geometry_msgs/PointStamped"
    other.send("subscribe", topic="/point", type=kind)
    settled(other)
    one.send("advertise", topic="/point", type=kind)
    one.send("publish", topic="/point", msg=given)
    found = other.until("publish", topic="/point")["msg"]["header"]
    now = other.values("/rosapi/get_time")["time"]["secs"]
    assert now - 5 <= found["stamp"]["secs"] <= now
    assert found["frame_id"] == given.get("header", {}).get("frame_id", "")


def test_bytes_are_base64_with_or_without_line_ends(two):
    one, other = two
    kind = "sensor_msgs/CompressedImage"
    other.send("subscribe", topic="/image", type=kind)
    settled(other)
    one.send("advertise", topic="/image", type=kind)
    one.send("publish", topic="/image", msg={"data": "AQID\nBAU=\n"})
    found = other.until("publish", topic="/image")["msg"]["data"]
    assert base64.b64decode(found) == bytes([1, 2, 3, 4, 5])


def test_a_service_of_one_client_is_called_by_another(two):
    one, other = two
    one.send("advertise_service", **TRIGGER)
    settled(one)
    other.send("call_service", service="/own/ask", id="c")
    asked = one.until("call_service", service="/own/ask")
    values = {"success": False, "message": "no"}
    one.send("service_response", id=asked["id"], **TRIGGER, values=values, result=True)
    assert other.until("service_response", id="c")["values"] == values


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        ({"values": {"succes": True}, "result": True}, "no field 'succes'"),
        ({"values": "I am tired", "result": False}, "I am tired"),
        (None, "withdrawn"),
    ],
)
def test_a_call_that_fails_is_answered_with_the_reason(two, answer, why):
    one, other = two
    one.send("advertise_service", **TRIGGER)
    settled(one)
    other.send("call_service", service="/own/ask", id="c")
    asked = one.until("call_service", service="/own/ask")
    if answer is None:
        one.socket.close()
    else:
        one.send("service_response", id=asked["id"], service="/own/ask", **answer)
    found = other.until("service_response", id="c")
    assert found["result"] is False
    assert why in found["values"]


def test_nobody_answers_for_another_client(two):
    one, other = two
    one.send("advertise_service", **TRIGGER)
    settled(one)
    other.send("call_service", service="/own/ask", id="c")
    number = one.until("call_service")["id"]
    other.send(
        "service_response", id=number, service="/own/ask", values={}, result=True
    )
    assert number in other.until("status")["msg"]
    other.send("advertise_service", **TRIGGER)
    assert "Another client offers" in other.until("status")["msg"]


def test_an_action_of_one_client_is_used_by_another(two):
    one, other = two
    kind = "example_interfaces/action/Fibonacci"
    one.send("advertise_action", action="/fib", type=kind)
    settled(one)
    goal = {"action": "/fib", "action_type": kind, "args": {"order": 3}}
    other.send("send_action_goal", **goal, id="g", feedback=True)
    asked = one.until("send_action_goal")
    assert asked["args"] == {"order": 3}
    told = {"action": "/fib", "id": asked["id"], "values": {"sequence": [0, 1]}}
    one.send("action_feedback", **told)
    assert other.until("action_feedback", id="g")["values"] == {"sequence": [0, 1]}
    other.send("cancel_action_goal", action="/fib", id="g")
    assert one.until("cancel_action_goal")["id"] == asked["id"]
    one.send("action_result", **told, status=5, result=True)
    result = other.until("action_result", id="g")
    assert (result["status"], result["values"]) == (5, {"sequence": [0, 1]})


def test_parameters_of_clients_are_not_those_of_the_station(two, station):
    one, other = two
    one.values("/rosapi/set_param", {"name": "/own/colour", "value": '"red"'})
    found = other.values("/rosapi/get_param", {"name": "own/colour"})
    assert found == {"value": '"red"'}
    assert "/own/colour" in other.values("/rosapi/get_param_names")["names"]
    assert not station.parameters.has("own/colour")
    other.values("/rosapi/delete_param", {"name": "/own/colour"})
    assert not one.values("/rosapi/has_param", {"name": "/own/colour"})["exists"]
    large = {"name": "/own/text", "value": f'"{"x" * 30_000}"'}
    for number in range(4):
        found = one.call("/rosapi/set_param", {**large, "name": f"/own/{number}"})
    assert "characters" in found["values"]


def test_a_name_that_the_station_gets_is_taken_from_clients(serve, station):
    _, url = serve()
    with RosClient(f"{url}?token={OPERATOR}") as one:
        one.send("advertise", topic="/later/command", type="std_msgs/String")
        one.send("advertise_service", service="/later/ask", type="std_srvs/Trigger")
        settled(one)
        params = {"type": GROUP, "joints": ["joint1"]}
        station.load_controller("later", None, params)
        one.send("publish", topic="/later/command", msg={"data": "x"})
        statuses = [one.until("status")["msg"] for _ in range(3)]
    assert sum("is a name of the station now" in one for one in statuses) == 2
    assert "/later/ask" in "".join(statuses)


def test_what_a_client_offers_is_bounded(two):
    one, _ = two
    for number in range(MOST_OFFERS + 1):
        one.send("advertise", topic=f"/own/t{number}", type="std_msgs/String")
    assert f"{MOST_OFFERS} topics" in one.until("status")["msg"]
    found = one.values("/rosapi/topics_for_type", {"type": "std_msgs/String"})
    assert len([name for name in found["topics"] if "/own/" in name]) == MOST_OFFERS


@pytest.mark.parametrize("name", ["/o//n", "/ow n", "/ä", "/9", f"/{'x' * 300}"])
def test_names_that_ros_does_not_have_are_refused(two, name):
    one, _ = two
    one.send("advertise_service", service=name, type="std_srvs/Trigger")
    assert "no name in ROS" in one.until("status")["msg"]


def test_events_are_lines_of_rosout(two):
    one, other = two
    one.send("subscribe", topic="/rosout")
    settled(one)
    other.values("/stop")
    line = one.until("publish", topic="/rosout")["msg"]
    assert line["name"] == "/station"
    assert line["level"] in {2, 4, 8}


def test_transforms_between_frames_come_when_they_change(two):
    one, _ = two
    wanted = {
        "source_frames": ["joint2", "/base"],
        "target_frame": "/base",
        "rate": 50.0,
        "trans_thres": 0.01,
        "angular_thres": 0.01,
    }
    topic = one.values("/republish_tfs", wanted)["topic_name"]
    found = one.subscribe(topic, type="tf2_web_republisher/TFArray")["msg"]
    children = [each["child_frame_id"] for each in found["transforms"]]
    assert children == ["joint2", "base"]
    assert found["transforms"][1]["transform"]["rotation"]["w"] == 1.0
    refused = one.call("/republish_tfs", {**wanted, "rate": 0.0})
    assert "rate" in refused["values"]
