"""The words of Foxglove's protocol, for tests.

Source: https://github.com/foxglove/ws-protocol, docs/spec.md.
"""

import json
import struct

from tests.waiting import PATIENCE

PROTOCOLS = ["foxglove.sdk.v1"]
URDF = """<robot name="r"><link name="base"/><link name="tip"/>
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/>
<origin xyz="0 0 1"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>"""


def until(client, op):
    """Return the next message of a kind; others are skipped."""
    while True:
        found = client.recv(timeout=PATIENCE)
        if isinstance(found, str) and json.loads(found)["op"] == op:
            return json.loads(found)


def subscribe(client, *topics):
    """Subscribe to channels; the number of each subscription is its place."""
    channels = {}
    while not set(topics) <= channels.keys():
        for one in until(client, "advertise")["channels"]:
            channels[one["topic"]] = one
    wanted = [
        {"id": number, "channelId": channels[topic]["id"]}
        for number, topic in enumerate(topics)
    ]
    client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
    return channels


def call(client, payload, service=1):
    """Call the service that switches controllers."""
    head = struct.pack("<BIII", 2, service, 7, len(b"json"))
    client.send(head + b"json" + payload)


def set_gains(client, **values):
    """Set gains of `arm`; return the messages of the server up to its answer."""
    wanted = [{"name": f"arm/{name}", "value": value} for name, value in values.items()]
    client.send(json.dumps({"op": "setParameters", "parameters": wanted, "id": "b"}))
    found = []
    while not found or found[-1]["op"] != "parameterValues":
        message = client.recv(timeout=PATIENCE)
        if isinstance(message, str) and json.loads(message)["op"] in {
            "status",
            "parameterValues",
        }:
            found.append(json.loads(message))
    return found


def running(station):
    return [one.name for one in station.controllers() if one.state.value == "running"]
