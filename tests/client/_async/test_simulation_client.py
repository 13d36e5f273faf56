"""One method per route of the simulation."""

import pytest

from tests.client.recorder import Recorder

STATE = {"paused": True, "real_time_factor": 1.0, "time": 0.0, "steps_due": 0}
REQUESTS = [
    ("state", (), "GET", "", None),
    ("pause", (), "PATCH", "", {"paused": True}),
    ("resume", (), "PATCH", "", {"paused": False}),
    ("set_real_time_factor", (0.5,), "PATCH", "", {"real_time_factor": 0.5}),
    ("step", (7,), "POST", "/step", {"n": 7}),
    ("reset", (), "POST", "/reset", {"joint_positions": {}}),
    ("reset", ({"j": 1.0},), "POST", "/reset", {"joint_positions": {"j": 1.0}}),
]


@pytest.mark.parametrize(("name", "arguments", "method", "rest", "body"), REQUESTS)
def test_every_method_asks_its_route(name, arguments, method, rest, body):
    recorder = Recorder(STATE)

    found = recorder.run(lambda client: getattr(client.simulation, name)(*arguments))

    assert found.paused
    assert recorder.requests == [(method, f"/api/v1/simulation{rest}", body)]
