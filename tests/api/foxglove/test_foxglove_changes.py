"""What a Foxglove client changes leaves events, and asks for the lease."""

import json

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.client import StationClient
from station.events import EventKind
from tests.api.conftest import OPERATOR
from tests.api.foxglove.words import PROTOCOLS, call, running, set_gains
from tests.waiting import PATIENCE


@pytest.mark.parametrize("way", ["lease in the address", "named token"])
def test_who_holds_control_changes_and_the_event_says_who(
    app, serve, station, made_token, way
):
    api, foxglove = serve()
    token = made_token if way == "named token" else OPERATOR
    with StationClient(api, token) as owner:
        lease = owner.lease.take("ana", ttl=60.0)
        key = "" if way == "named token" else f"&lease={lease.lease}"
        with connect(f"{foxglove}?token={token}{key}", subprotocols=PROTOCOLS) as one:
            set_gains(one, k=3.0)
            call(one, json.dumps({"stop": ["arm"]}).encode())
            while not isinstance(answer := one.recv(timeout=PATIENCE), bytes):
                assert json.loads(answer)["op"] != "serviceCallFailure"

    assert station.tuning.gains("arm").values == {"k": 3.0}
    assert running(station) == []
    events = app.state.services.event_recorder.log.recent(0)
    found = {e.what: e for e in events if e.kind is EventKind.REQUEST}
    for what in ("foxglove setParameters arm/k", "foxglove /switch_controllers"):
        assert found[what].result == "done"
        assert found[what].who.startswith("ana")
        assert found[what].where == "127.0.0.1"
    (switch,) = [e for e in events if e.kind is EventKind.SWITCH]
    assert switch.details["stopped"] == ["arm"]


def test_refused_changes_and_wrong_tokens_leave_events(app, serve):
    _, foxglove = serve()
    with connect(foxglove, subprotocols=PROTOCOLS) as client:
        set_gains(client, k=3.0)
    with (
        connect(f"{foxglove}?token=guessed", subprotocols=PROTOCOLS) as client,
        pytest.raises(ConnectionClosed),
    ):
        client.recv(timeout=PATIENCE)

    events = app.state.services.event_recorder.log.recent(0)
    (refused,) = [e for e in events if e.kind is EventKind.REQUEST and "fox" in e.what]
    assert refused.result == "refused: change_refused"
    assert refused.who == "viewer"
    assert [e.kind for e in events].count(EventKind.LOGIN_FAILED) == 1
