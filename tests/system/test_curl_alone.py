"""Whoever has curl can do the whole job: load, switch, command, tune, unload."""

import time

import httpx
import pytest

from tests.system.station_process import StationProcess

TYPE = "effort_controllers/JointGroupPositionController"
JOINTS = [f"panda_joint{i}" for i in range(1, 8)]
GAINS = zip((200, 200, 200, 200, 60, 50, 30), (40, 40, 40, 40, 12, 10, 5), strict=True)
PARAMS = {
    "joints": JOINTS,
    **{
        joint: {"pid": {"p": p, "i": 0, "d": d}}
        for joint, (p, d) in zip(JOINTS, GAINS, strict=True)
    },
}
START = [0.0, -0.785398, 0.0, -2.356194, 0.0, 1.570796, 0.785398]
GOAL = [q + 0.3 for q in START]


@pytest.fixture(scope="module")
def api(tmp_path_factory):
    """Return an HTTP client that knows nothing but the address and the token."""
    station = StationProcess(tmp_path_factory.mktemp("station"), "--no-ui")
    try:
        access = station.access()
        with httpx.Client(
            base_url=f"{access['url']}/api/v1",
            headers={"Authorization": f"Bearer {access['token']}"},
            timeout=30.0,
        ) as client:
            yield client
    finally:
        station.clean_up()


@pytest.fixture
def arm(api):
    """Load the controller `arm` and start it; stop and unload it afterwards."""
    loaded = api.post(
        "/controllers", json={"name": "arm", "type": TYPE, "params": PARAMS}
    )
    assert loaded.status_code == 201, loaded.text
    switched = api.post("/controllers/switch", json={"start": ["arm"]})
    assert switched.status_code == 200, switched.text
    yield switched.json()
    stopped = api.post("/controllers/switch", json={"stop": ["arm"]})
    assert stopped.json()["stopped"] == ["arm"]
    assert api.delete("/controllers/arm").status_code == 200
    assert "arm" not in names(api)


def names(api) -> list[str]:
    return [c["name"] for c in api.get("/controllers").json()["controllers"]]


def state_after(api, duration: float) -> dict:
    """Return the joints once `duration` [s] of simulated time has passed."""
    begin = api.get("/joint_states").json()["stamp"]
    while (state := api.get("/joint_states").json())["stamp"] < begin + duration:
        time.sleep(0.02)
    return state


def test_controllers_of_the_configuration_are_listed(api):
    assert "joint_state_controller" in names(api)


def test_switch_does_not_move_the_arm(api, arm):
    before = api.get("/joint_states").json()["position"]

    after = state_after(api, 0.1)["position"]

    assert arm["started"] == ["arm"]
    assert after == pytest.approx(before, abs=1e-3)


@pytest.mark.usefixtures("arm")
def test_arm_is_at_the_commanded_pose_within_two_seconds(api):
    accepted = api.put("/controllers/arm/command", json={"command": GOAL})
    assert accepted.status_code < 300, accepted.text

    assert state_after(api, 2.0)["position"] == pytest.approx(GOAL, abs=0.02)

    back = api.put("/controllers/arm/command", json={"command": START})
    assert back.status_code < 300, back.text
    assert state_after(api, 2.0)["position"] == pytest.approx(START, abs=0.02)


@pytest.mark.usefixtures("arm")
def test_gains_change_while_it_runs(api):
    url = "/controllers/arm/gains"

    changed = api.patch(url, json={"values": {"panda_joint1/p": 500.0}})

    assert changed.status_code == 200, changed.text
    assert api.get(url).json()["values"]["panda_joint1/p"] == 500.0


@pytest.mark.usefixtures("arm")
def test_second_claim_is_refused_with_the_holder(api):
    rival = "effort_group_effort_controller"

    refused = api.post("/controllers/switch", json={"start": [rival]})

    assert refused.status_code == 409
    problem = refused.json()
    assert "arm" in problem["detail"]
    assert problem["remedy"]
    states = {
        c["name"]: c["state"] for c in api.get("/controllers").json()["controllers"]
    }
    assert (states["arm"], states[rival] == "running") == ("running", False)


@pytest.mark.usefixtures("arm")
@pytest.mark.parametrize(
    ("method", "path", "body", "status"),
    [
        ("GET", "/controllers/nobody", None, 404),
        ("POST", "/controllers/switch", '{"start": ["nobody"]}', 404),
        ("POST", "/controllers", '{"name": "x", "type": "no/Such"}', 404),
        ("PUT", "/controllers/arm/command", '{"command": [0.1]}', 422),
        ("PUT", "/controllers/arm/command", '{"command": [0,0,0,0,0,0,NaN]}', 422),
        ("PUT", "/controllers/arm/command", '{"command": "abc"}', 422),
        (
            "PATCH",
            "/controllers/arm/gains",
            '{"values": {"panda_joint1/p": "abc"}}',
            422,
        ),
    ],
)
def test_nonsense_is_refused_and_changes_nothing(api, method, path, body, status):
    before = api.get("/controllers").json(), api.get("/controllers/arm/gains").json()

    answer = api.request(
        method, path, content=body, headers={"Content-Type": "application/json"}
    )

    assert answer.headers["content-type"].startswith("application/problem+json")
    assert answer.status_code in {status, 400, 409}, answer.text
    assert answer.json()["detail"]
    assert answer.json()["remedy"]
    after = api.get("/controllers").json(), api.get("/controllers/arm/gains").json()
    assert unmeasured(after) == unmeasured(before)
    assert api.get("/loop").json()["state"] == "running"


def unmeasured(listing: tuple) -> list:
    """Return a listing without the times that every cycle changes."""
    controllers, gains = listing
    kept = [{**c, "time": None} for c in controllers["controllers"]]
    return [kept, gains]


def test_missing_token_is_refused(api):
    answer = httpx.get(f"{api.base_url}controllers", timeout=30.0)

    assert answer.status_code == 401
    assert "Bearer" in answer.json()["remedy"]
