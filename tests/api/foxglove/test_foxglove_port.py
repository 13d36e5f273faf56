"""Foxglove's port: who gets in, who may change something, and what the events say."""

import json
import re
import socket

import httpx
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from station.api.foxglove.foxglove_port import FoxglovePort
from station.client import StationClient
from station.web.host_policy import HostPolicy
from tests.api.conftest import OPERATOR, VIEWER
from tests.api.foxglove.words import call, running, set_gains, until
from tests.waiting import PATIENCE

MOST = FoxglovePort.most_clients
PROTOCOLS = ["foxglove.sdk.v1"]


def _revoke(api, foxglove, token):
    with StationClient(api, OPERATOR) as client:
        client.tokens.revoke("ana")
    return connect(f"{foxglove}?token={token}", subprotocols=PROTOCOLS)


def _revoke_later(api, foxglove, token):
    client = connect(f"{foxglove}?token={token}", subprotocols=PROTOCOLS)
    until(client, "advertiseServices")
    with StationClient(api, OPERATOR) as operator:
        operator.tokens.revoke("ana")
    return client


def _hold(api, foxglove, token):
    with StationClient(api, OPERATOR) as client:
        client.lease.take("bob", ttl=60.0)
    return connect(f"{foxglove}?token={token}", subprotocols=PROTOCOLS)


def _with(query="", **options):
    def open_client(_api, foxglove, token):
        url = f"{foxglove}?{query.format(token=token)}"
        return connect(url, subprotocols=PROTOCOLS, **options)

    return open_client


INTRUDERS = {
    "no token": _with(),
    "viewer": _with(f"token={VIEWER}"),
    "viewer in a header": _with(
        additional_headers={"Authorization": f"Bearer {VIEWER}"}
    ),
    "wrong token": _with("token=guessed"),
    "wrong ticket": _with("ticket=guessed"),
    "foreign origin": _with(f"token={OPERATOR}", origin="https://evil.example"),
    "page without an origin": _with(f"token={OPERATOR}", origin="null"),
    "revoked token": _revoke,
    "token revoked later": _revoke_later,
    "another's lease": _hold,
}


WHY = {
    "no token": "A viewer may look",
    "viewer": "A viewer may look",
    "viewer in a header": "A viewer may look",
    "wrong token": "4401",
    "wrong ticket": "4401",
    "foreign origin": "4403",
    "page without an origin": "4403",
    "revoked token": "4401",
    # The request may come before the connection is closed.
    "token revoked later": "4401|token of this connection has been revoked",
    "another's lease": "bob holds control",
}


@pytest.mark.parametrize("change", ["setParameters", "switch"])
@pytest.mark.parametrize("intruder", INTRUDERS)
def test_nobody_changes_anything_who_may_not(
    serve, station, made_token, intruder, change
):
    api, foxglove = serve()
    refused = ""
    try:
        with INTRUDERS[intruder](api, foxglove, made_token) as client:
            if change == "switch":
                call(client, json.dumps({"stop": ["arm"]}).encode())
                refused = until(client, "serviceCallFailure")["message"]
            else:
                refused = set_gains(client, k=3.0)[0]["message"]
    except ConnectionClosed as closed:
        refused = str(closed.rcvd.code)

    assert re.search(WHY[intruder], refused)
    assert running(station) == ["arm"]
    assert station.tuning.gains("arm").values == {"k": 2.0}


def test_a_rebound_host_does_not_get_in(serve, station):
    """Another name may point here: the page of that name must not."""
    _, foxglove = serve()
    port = foxglove.rpartition(":")[2].strip("/")
    with (
        connect(
            f"ws://evil.example:{port}/?token={OPERATOR}",
            subprotocols=PROTOCOLS,
            sock=socket.create_connection(("127.0.0.1", int(port))),
        ) as client,
        pytest.raises(ConnectionClosed) as closed,
    ):
        client.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == 4403
    answer = httpx.get(f"http://127.0.0.1:{port}/", headers={"Host": "evil.example"})
    assert answer.status_code == 403
    assert httpx.get(f"http://127.0.0.1:{port}/").status_code == 426
    assert running(station) == ["arm"]


def test_the_api_is_not_behind_foxgloves_port(serve):
    _, foxglove = serve()
    url = foxglove.replace("ws://", "http://")
    answer = httpx.get(f"{url}api/v1/status", headers={"Authorization": "Bearer x"})
    assert answer.json()["code"] == "websocket_needed"


def test_a_token_is_needed_where_others_can_connect(serve):
    _, foxglove = serve(anonymous=False)
    with (
        connect(foxglove, subprotocols=PROTOCOLS) as client,
        pytest.raises(ConnectionClosed) as closed,
    ):
        client.recv(timeout=PATIENCE)
    assert closed.value.rcvd.code == 4401
    with connect(f"{foxglove}?token={VIEWER}", subprotocols=PROTOCOLS) as client:
        assert until(client, "serverInfo")["name"] == "control station"


def test_a_listed_origin_may_connect(serve):
    _, foxglove = serve(policy=HostPolicy(origins=["https://app.foxglove.dev/"]))
    origin = "https://app.foxglove.dev"
    with connect(foxglove, subprotocols=PROTOCOLS, origin=origin) as client:
        until(client, "serverInfo")


def test_viewers_leave_room_for_operators(serve):
    _, foxglove = serve()
    clients = [connect(foxglove, subprotocols=PROTOCOLS) for _ in range(MOST)]
    try:
        refused = 0
        for client in clients:
            try:
                until(client, "serverInfo")
            except ConnectionClosed as closed:
                refused += closed.rcvd.code == 1013
        assert refused == MOST // 4
        url = f"{foxglove}?token={OPERATOR}"
        with connect(url, subprotocols=PROTOCOLS) as operator:
            until(operator, "serverInfo")
    finally:
        for client in clients:
            client.close()
