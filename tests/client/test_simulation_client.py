"""One method per route of the simulation."""

import json

import pytest

from station.client.simulation_client import SimulationClient

CALLS = [
    ("state", (), "GET", "", None),
    ("pause", (), "PATCH", "", {"paused": True}),
    ("resume", (), "PATCH", "", {"paused": False}),
    ("set_real_time_factor", (0.5,), "PATCH", "", {"real_time_factor": 0.5}),
    ("step", (7,), "POST", "/step", {"n": 7}),
    ("reset", (), "POST", "/reset", {"joint_positions": {}}),
    ("reset", ({"j": 1.0},), "POST", "/reset", {"joint_positions": {"j": 1.0}}),
]


@pytest.mark.parametrize(("name", "arguments", "method", "rest", "body"), CALLS)
def test_method_asks_its_route(name, arguments, method, rest, body):
    sent = []

    getattr(SimulationClient(sent.append), name)(*arguments)

    (call,) = sent
    assert (call.method, call.path) == (method, f"/api/v1/simulation{rest}")
    assert (None if call.body is None else json.loads(call.body)) == body
