"""Rehearsals by the API: forecast, certificate, policy."""

import pytest
from pydantic import ValidationError

from station.client import ApiError
from station.rehearsal.rehearsals import BURST, Policy, Rules
from tests.api.conftest import VIEWER
from tests.two_joint_station import JOINTS, TRAJECTORY, make_station

GOAL = {"trajectory": TRAJECTORY}
GOALS = "/api/v1/controllers/arm/goals"
STEP = {"kind": "goal", "name": "arm", "request": GOAL}


@pytest.fixture
def station():
    """Return a station whose trajectory controller is not started."""
    station = make_station()
    station.loop.step()
    return station


@pytest.fixture
def arm(client, station):
    """Return a client of the station with the trajectory controller running."""
    client.switch_controllers(start=["arm"])
    station.loop.step(3)
    return client


def test_rehearsal_tells_the_end_and_moves_nothing(arm):
    before = arm.joint_states()
    told = arm.rehearse([STEP])
    assert (told.outcome, told.error, told.certificate) == ("completed", None, None)
    assert [joint.joint for joint in told.joints] == JOINTS
    assert [joint.position for joint in told.joints] == pytest.approx([0.4, -0.4])
    assert told.positions[-1] == pytest.approx([0.4, -0.4])
    assert len(told.times) == len(told.positions) == 200
    assert arm.joint_states() == before
    assert arm.goals("arm") == []


def test_refused_step_is_told_with_its_number(arm):
    bad = {"kind": "set_point", "name": "arm", "values": [0.1]}
    told = arm.rehearse([STEP, bad])
    assert (told.outcome, told.error.cause, told.error.step) == (
        "refused",
        "refused",
        1,
    )
    assert told.error.code == "invalid_command"


def test_nothing_has_no_certificate(arm):
    assert arm.rehearse([]).outcome == "completed"  # what is under way goes on
    with pytest.raises((ApiError, ValidationError), match="needs a step"):
        arm.rehearse([], certificate=True)


def test_certified_goal_is_given_once(arm, station):
    name = arm.rehearse([STEP], certificate=True).certificate.name
    arm.submit_goal("arm", GOAL, certificate=name)
    with pytest.raises(ApiError) as used:
        arm.submit_goal("arm", GOAL, certificate=name)
    assert (used.value.status, used.value.code) == (404, "certificate_not_found")
    station.loop.step(600)
    assert arm.goals("arm")[-1].status == "succeeded"


def test_certificate_of_another_state_is_refused(arm, station):
    name = arm.rehearse([STEP], certificate=True).certificate.name
    arm.submit_goal("arm", GOAL)
    station.loop.step(200)
    with pytest.raises(ApiError, match="is at") as void:
        arm.submit_goal("arm", GOAL, certificate=name)
    assert (void.value.status, void.value.code) == (412, "certificate_void")


def test_nobody_is_asked_about_an_agents_used_or_void_certificate(
    app, arm, station, operator
):
    def refusal(certificate):
        """Return the code with which an agent's goal is refused."""
        token = {"Authorization": f"Bearer {agent}"}
        operator.post("/api/v1/control", json={}, headers=token)
        query = {"certificate": certificate}
        body = {"goal": GOAL}
        return operator.post(GOALS, json=body, params=query, headers=token).json()[
            "code"
        ]

    agent = arm.tokens.create("tuner", "agent").token
    used, void = (arm.rehearse([STEP], certificate=True).certificate for _ in "ab")
    arm.submit_goal("arm", GOAL, certificate=used.name)
    station.loop.step(200)

    assert refusal(used.name) == "certificate_not_found"
    assert refusal(void.name) == "certificate_void"
    assert app.state.services.agents.requests() == []


def test_policy_asks_for_a_rehearsal_or_advises_one(app, arm, operator):
    rehearsals = app.state.services.rehearsals
    rehearsals.adopt(Rules(operator=Policy.REQUIRED))
    with pytest.raises(ApiError) as needed:
        arm.submit_goal("arm", GOAL)
    assert (needed.value.status, needed.value.code) == (428, "rehearsal_needed")
    arm.follow_trajectory("arm", {"joint_names": JOINTS, "points": []})  # may hold
    name = arm.rehearse([STEP], certificate=True).certificate.name
    arm.submit_goal("arm", GOAL, certificate=name)
    rehearsals.adopt(Rules(operator=Policy.ADVISE))
    answer = operator.post(GOALS, json={"goal": GOAL})
    assert (answer.status_code, answer.headers["X-Rehearsal"]) == (201, "advised")


def test_a_client_that_rehearses_too_often_is_told_when_to_come_again(
    app, arm, operator
):
    rate = app.state.services.rehearsals.rate
    for _ in range(BURST + 1):
        arm.rehearse([], seconds=0.01)  # it is stepped: nothing is delayed
    for _ in range(100):
        rate.count("operator")
    wish = {"controller": "arm", "positions": {JOINTS[0]: 0.2}}
    for path, body in (("rehearse", {}), ("plan", wish)):
        refused = operator.post(f"/api/v1/{path}", json=body)
        assert (refused.status_code, refused.json()["code"]) == (
            429,
            "too_many_rehearsals",
        )
        assert 60 <= int(refused.headers["Retry-After"]) <= 96


def test_viewer_may_not_rehearse(http):
    http.headers["Authorization"] = f"Bearer {VIEWER}"
    assert http.post("/api/v1/rehearse", json={}).status_code == 403
