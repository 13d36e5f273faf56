"""The port of rosbridge: who gets in, who may change something, what events say."""

import json
import os
import random

import httpx
import pytest
from websockets.exceptions import ConnectionClosed

from station.client import StationClient
from station.core.control.switching import SwitchRequest
from station.events import EventKind
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.rosbridge.conftest import JOINTS, RosClient
from tests.api.rosbridge.test_session import ACTION, TRAJECTORY
from tests.waiting import PATIENCE

GOAL = {"trajectory": TRAJECTORY}
FRAMES = int(os.environ.get("FUZZED_FRAMES", "10000"))
"""Frames of the long run."""
PARAMETER = {"name": "/pose/a", "value": "1"}
SWITCH = "/controller_manager/switch_controller"
CHANGES = {
    "set-point": ("publish", {"topic": "/pose/command", "msg": {"data": [0.1, 0.1]}}),
    "trajectory": ("publish", {"topic": "/arm/command", "msg": TRAJECTORY}),
    "goal of a topic": ("publish", {"topic": f"{ACTION}/goal", "msg": {"goal": GOAL}}),
    "goal": ("send_action_goal", {"action": ACTION, "args": GOAL}),
    "switch": ("call_service", {"service": SWITCH}),
    "gain": ("call_service", {"service": "/single/set_parameters"}),
    "parameter": ("call_service", {"service": "/rosapi/set_param", "args": PARAMETER}),
    "release": ("call_service", {"service": "/stop/release"}),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize(
    ("query", "why"),
    [("", "A viewer may look"), (f"token={VIEWER}", "A viewer may look"),
     (f"token={OPERATOR}", "bob holds control")],
)  # fmt: skip
def test_nobody_changes_anything_who_may_not(serve, station, change, query, why):
    api, url = serve()
    op, message = CHANGES[change]
    with StationClient(api, OPERATOR) as owner, RosClient(f"{url}?{query}") as client:
        station.switch_controllers(SwitchRequest(start=["pose"]))
        owner.lease.take("bob", ttl=60.0)
        client.send(op, **message, id="m")
        assert why in client.until("status")["msg"]
    assert station.motion.set_point("pose").values is None
    assert station.motion.goals("arm") == []
    assert not station.parameters.has("pose/a")


def test_an_agent_is_told_that_it_only_looks_here(serve):
    api, url = serve()
    with StationClient(api, OPERATOR) as owner:
        token = owner.tokens.create("tuner", "agent").token
        with RosClient(f"{url}?token={token}") as client:
            client.send("call_service", service=SWITCH)
            told = client.until("status")["msg"]
    assert "An agent may look, but not change anything over rosbridge." in told


def test_the_holder_of_control_commands_and_the_event_says_who(app, serve):
    api, url = serve()
    with StationClient(api, OPERATOR) as owner:
        lease = owner.lease.take("ana", ttl=60.0).lease
        with RosClient(f"{url}?token={OPERATOR}&lease={lease}") as client:
            assert client.switch(start=["arm"])
            client.send(
                "send_action_goal",
                action=ACTION,
                id="g",
                args={"trajectory": TRAJECTORY},
            )
            assert client.until("action_result")["result"]
    log = app.state.services.event_recorder.log
    found = {e.what: e for e in log.recent(0) if e.kind is EventKind.REQUEST}
    for what in ("call /controller_manager/switch_controller", f"goal of {ACTION}"):
        event = found[f"rosbridge {what}"]
        assert (event.result, event.where) == ("done", "127.0.0.1")
        assert event.who.startswith("ana")


@pytest.mark.parametrize(
    ("query", "options", "code"),
    [("token=guessed", {}, 4401), ("ticket=guessed", {}, 4401),
     ("", {"origin": "https://evil.example"}, 4403)],
)  # fmt: skip
def test_who_is_turned_away(serve, query, options, code):
    _, url = serve()
    with (
        RosClient(f"{url}?{query}", **options) as client,
        pytest.raises(ConnectionClosed) as closed,
    ):
        client.socket.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == code


def test_elsewhere_nobody_gets_in_without_a_token(serve):
    _, url = serve(anonymous=False)
    with RosClient(url) as client, pytest.raises(ConnectionClosed):
        client.socket.recv(timeout=PATIENCE)


def test_a_request_over_http_is_told_where_to_go(serve):
    _, url = serve()
    answer = httpx.get(url.replace("ws:", "http:"))
    assert answer.status_code == 426
    assert "rosbridge" in answer.json()["detail"]


def test_a_text_that_is_no_utf8_closes_the_connection_with_a_reason(serve, caplog):
    _, url = serve()
    with RosClient(url) as client:
        client.socket.send(b'{"op": "\xff"}', text=True)
        with pytest.raises(ConnectionClosed) as closed:
            client.socket.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == 1007
    assert "UTF-8" in closed.value.rcvd.reason
    assert not [one.exc_text for one in caplog.records if one.exc_info]


def fuzzed(seed):
    """Yield frames that are nearly messages of rosbridge."""
    chance = random.Random(seed)
    ops = [
        "publish",
        "subscribe",
        "unsubscribe",
        "call_service",
        "advertise",
        "auth",
        "send_action_goal",
        "cancel_action_goal",
        "fragment",
        "set_level",
        "status",
        "png",
        "service_response",
        "advertise_service",
        "unadvertise_service",
        "advertise_action",
        "unadvertise_action",
        "action_feedback",
        "action_result",
        "unadvertise",
    ]
    names = [
        "/joint_states",
        "/pose/command",
        "/arm/command",
        "/rosapi/topics",
        "/controller_manager/load_controller",
        f"{ACTION}/goal",
        ACTION,
        "/own/name",
        "/own/other",
        "",
        "/",
        "ä",
    ]
    values = [
        None,
        True,
        -1,
        0,
        1e308,
        10**30,
        "",
        "x",
        [],
        {},
        [[]],
        {"data": [1, "a"]},
        {"header": {"stamp": {"secs": -5}}},
        [None],
        {"points": [{}]},
        "none",
        2.5,
    ]
    kinds = ["std_msgs/String", "own_msgs/msg/Thing", "std_srvs/Trigger"]
    keys = [
        "topic",
        "type",
        "id",
        "msg",
        "args",
        "service",
        "action",
        "action_type",
        "data",
        "num",
        "total",
        "compression",
        "throttle_rate",
        "queue_length",
        "fragment_size",
        "level",
        "mac",
        "client",
        "dest",
        "rand",
        "t",
        "end",
    ]
    while True:
        kind = chance.random()
        if kind < 0.1:
            yield chance.randbytes(chance.randrange(40))
            continue
        message = {key: chance.choice(values) for key in chance.sample(keys, 6)}
        for key in ("topic", "service", "action"):
            if chance.random() < 0.7:
                message[key] = chance.choice(names)
        if chance.random() < 0.5:
            message["type"] = chance.choice(kinds)
        message["op"] = chance.choice([*ops, *ops, None, "dance"])
        if message["op"] == "auth":
            message["op"] = "advertise"  # a wrong proof is answered late, on purpose
        text = json.dumps(message)
        if kind < 0.2:
            text = text[: chance.randrange(len(text))]
        yield "[" * 5000 if kind > 0.999 else text


@pytest.mark.parametrize(
    ("seed", "count"), [(1, 400), pytest.param(2, FRAMES, marks=pytest.mark.long)]
)
def test_fuzzed_frames_end_no_other_connection(serve, station, seed, count, caplog):
    _, url = serve()
    token = f"{url}?token={OPERATOR}"
    frames = fuzzed(seed)
    with RosClient(url) as other:
        other.subscribe("/joint_states")
        for _ in range(count // 200):
            with RosClient(token) as client:
                client.send("set_level", level="none")
                for _ in range(200):
                    client.socket.send(next(frames))
            # It reads what has come meanwhile, and is answered.
            assert other.values("/rosapi/topic_type", {"topic": "/tf"})["type"]
    # Each fault was the client's, and none was one of the station.
    assert not [one.exc_text for one in caplog.records if one.exc_info]
    assert station.ready() is None
    assert station.joint_names == JOINTS
