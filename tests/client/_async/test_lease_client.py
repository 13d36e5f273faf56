"""Requests of the client that takes control call by call."""

from tests.client.recorder import Recorder

FREE = {"owner": None, "lease": None}


def test_requests_of_control():
    recorder = Recorder(FREE)

    recorder.run(lambda client: client.lease.state())
    recorder.run(lambda client: client.lease.take("ada", ttl=5.0, force=True))
    recorder.run(lambda client: client.lease.renew(hand_over_to="grace"))
    recorder.run(lambda client: client.lease.release())

    assert recorder.requests == [
        ("GET", "/api/v1/control", None),
        ("POST", "/api/v1/control", {"owner": "ada", "ttl": 5.0, "force": True}),
        ("PATCH", "/api/v1/control", {"hand_over_to": "grace"}),
        ("DELETE", "/api/v1/control", None),
    ]
