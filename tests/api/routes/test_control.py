"""Control over HTTP: who holds it, and what others are answered."""

import pytest

from station.client import ApiError
from station.events import EventKind

CONTROL = "/api/v1/control"


@pytest.fixture
def log(app):
    return app.state.services.event_recorder.log


def test_nobody_holds_it_at_first(client):
    assert client.lease.state().owner is None
    assert client.status().operator is None


def test_while_somebody_holds_it_others_changes_are_locked(client, operator):
    with client.control(owner="Ada"):
        client.load_controller("spring", "test/Spring", {"joint": "j"})
        answer = operator.delete("/api/v1/controllers/spring")
        status = client.status()
        seen = operator.get(CONTROL).json()

    assert answer.status_code == 423
    assert answer.json()["code"] == "control_held"
    assert answer.json()["detail"].startswith("Ada holds control since")
    assert "force" in answer.json()["remedy"]
    assert status.operator == "Ada"
    assert (seen["mine"], seen["lease"]) == (False, None)
    assert operator.delete("/api/v1/controllers/spring").status_code == 200


def test_the_stop_is_never_refused(client, operator):
    with client.control(owner="Ada"):
        assert operator.post("/api/v1/stop").json()["state"] == "stopped"
        assert operator.post("/api/v1/stop/release").status_code == 423


def test_control_taken_by_force_is_lost_to_the_former_owner(spring, operator, station):
    port = station.manager.get_controller("spring").set_points
    with spring.control(owner="Ada") as lease:
        spring.command("spring", [0.5])
        station.loop.step()
        operator.post(CONTROL, json={"owner": "Grace", "force": True})
        station.loop.step()
        assert port.take_expiry()
        with pytest.raises(ApiError, match="Grace"):
            lease.renew()
        with pytest.raises(ApiError, match="Grace"):
            spring.unload_controller("spring")

    assert operator.get(CONTROL).json()["owner"] == "Grace"


def test_it_is_handed_over(client, operator):
    with client.control(owner="Ada") as lease:
        lease.hand_over("Grace")
        refused = operator.post(CONTROL, json={"owner": "Eve"})
        taken = operator.post(CONTROL, json={"owner": "Grace"})

    assert refused.status_code == 423
    assert taken.json()["mine"]


def test_a_viewer_cannot_take_it(http):
    http.headers["Authorization"] = "Bearer viewer-token"

    assert http.post(CONTROL).status_code == 403
    assert http.get(CONTROL).status_code == 200


def test_without_it_there_is_nothing_to_give_back(operator):
    answer = operator.delete(CONTROL)

    assert (answer.status_code, answer.json()["code"]) == (409, "control_not_held")


def test_a_lease_is_taken_kept_offered_and_given_back_without_a_block(client, log):
    taken = client.lease.take("Ada")
    assert not client.lease.state().mine
    client.lease.act_under(taken.lease)
    assert client.lease.state().mine
    assert client.lease.renew().hand_over_to is None
    assert client.lease.renew(hand_over_to="Grace").hand_over_to == "Grace"
    assert client.lease.release().owner is None
    requests = [e.what for e in log.since(kinds=[EventKind.REQUEST])]
    assert requests == ["POST /control", "DELETE /control"]
    texts = [e.text for e in log.since(kinds=[EventKind.CONTROL])]
    assert "Ada offers control to Grace." in texts
