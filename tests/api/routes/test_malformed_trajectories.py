"""The table of malformed trajectories: what is refused, and what is not."""

import json

import pytest

from tests.api.test_errors import problem_of
from tests.two_joint_station import JOINTS, make_station

CONTROLLER = "/api/v1/controllers/arm"
GOALS = f"{CONTROLLER}/goals"
JSON = {"Content-Type": "application/json"}


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


def points(*each, **more):
    """Return a goal with the points (time_from_start, positions, ...)."""
    keys = ("time_from_start", "positions", "velocities", "accelerations")
    rows = [dict(zip(keys, point, strict=False)) for point in each]
    return {"trajectory": {"joint_names": JOINTS, "points": rows, **more}}


AWAY = [0.4, -0.4]
# Everything that must be refused, with the reason or a word of the message.
MALFORMED = {
    "all in the past": (points((0.05, AWAY), stamp=1e-3), "past"),
    "at the present": (points((0.0, AWAY)), "past"),
    "negative time": (points((-0.5, AWAY)), "past"),
    "equal times": (points((0.5, AWAY), (0.5, [0, 0])), "order"),
    "falling times": (points((0.5, AWAY), (0.2, [0, 0])), "order"),
    "too few positions": (points((0.5, [0.4])), "positions"),
    "too many positions": (points((0.5, [0.4, 0.1, 0.2])), "positions"),
    "no positions": (points((0.5, [])), "positions"),
    "wrong velocities": (points((0.5, AWAY, [0.0])), "velocities"),
    "wrong accelerations": (points((0.5, AWAY, [0, 0], [0.0])), "accelerations"),
    "text": (points((0.5, ["a", 0.1])), "number"),
    "true": (points((0.5, [True, 0.1])), "number"),
    "null": (points((0.5, [None, 0.1])), "number"),
    "text time": (points(("1", AWAY)), "number"),
    "missing joint": (
        {"trajectory": {"joint_names": ["j1"], "points": [{"positions": [0.1]}]}},
        "joints",
    ),
    "unknown joint": (points((0.5, AWAY), joint_names=["j1", "j3"]), "joints"),
    "joint twice": (points((0.5, AWAY), joint_names=["j1", "j1"]), "joints"),
    "no joints": (points((0.5, []), joint_names=[]), "joints"),
    "beyond the limits": (points((5.0, [2.1, 0.0])), "limits"),
    "start far away": (points((0.01, [1.5, 0.0]), (1.0, AWAY)), "pace"),
    "race": (points((1.0, AWAY), (1.05, [1.0, 0.0])), "pace"),
    "unknown field": (points((0.5, AWAY), speed=2), "speed"),
    "unknown tolerance": (
        {**points((0.5, AWAY)), "path_tolerance": [{"name": "j9", "position": 1}]},
        "j9",
    ),
    "no trajectory": ({}, "trajectory"),
    "nothing at all": ({"trajectory": {}}, "joints"),
    "an empty one for other joints": (points(joint_names=["j1", "j3"]), "joints"),
    "a time of 1e300 s": (points((1e300, AWAY)), "duration"),
    "a time in nanoseconds": (points((500_000_000, AWAY)), "duration"),
    "a time of -1e300 s": (points((-1e300, AWAY)), "past"),
    "a start in the far future": (points((0.5, AWAY), stamp=1e18), "duration"),
    "a goal time of 1e300 s": (
        {**points((0.5, AWAY)), "goal_time_tolerance": 1e300},
        "at most 86400",
    ),
    "enormous velocities": (points((0.5, AWAY, [1e3, 0.0])), "pace"),
    "enormous accelerations": (points((0.5, AWAY, [0, 0], [1e6, 0.0])), "pace"),
    "velocities that overflow": (points((0.5, AWAY, [1e308, 0.0])), "pace"),
    "positions that overflow": (points((0.5, [1e308, 0.0])), "limits"),
    "points that are none": ({"trajectory": {"joint_names": JOINTS, "points": 3}}, ""),
}


@pytest.mark.parametrize("what", MALFORMED)
def test_a_malformed_goal_is_refused_with_the_reason(arm, operator, station, what):
    body, reason = MALFORMED[what]
    arm.submit_goal("arm", points((2.0, [0.1, 0.1])))
    station.loop.step(100)

    answer = operator.post(GOALS, json={"goal": body})

    problem = problem_of(answer, 422, "invalid_trajectory")
    told = problem.get("details", {}).get("reason", "")
    assert reason == told or reason in problem["detail"]
    assert problem["details"]["error_code"] == (-2 if told == "joints" else -1)
    station.loop.step(2500)
    assert [goal.status for goal in arm.goals("arm")] == ["succeeded"]
    assert arm.joint_states().position == pytest.approx([0.1, 0.1], abs=1e-6)


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
@pytest.mark.parametrize("field", ["positions", "velocities", "time_from_start"])
def test_numbers_that_are_not_finite_are_no_json(arm, operator, number, field):
    body = json.dumps({"goal": points((0.5, AWAY, [0.125, 0.125]))})
    value = {"positions": "-0.4", "velocities": "0.125", "time_from_start": "0.5"}
    assert value[field] in body
    content = body.replace(value[field], number, 1)

    answer = operator.post(
        GOALS, content=content, headers={"Content-Type": "application/json"}
    )

    problem_of(answer, 422, "invalid_request")
    assert arm.goals("arm") == []


@pytest.mark.parametrize("what", MALFORMED)
def test_a_malformed_trajectory_without_a_goal_is_refused(arm, operator, station, what):
    body, reason = MALFORMED[what]
    if what in {"unknown tolerance", "a goal time of 1e300 s", "no trajectory"}:
        pytest.skip("only goals have that")
    if "empty" in what or "nothing" in what:
        pytest.skip("without points the topic stops the joints")
    goal = arm.submit_goal("arm", points((2.0, [0.1, 0.1])))
    station.loop.step(100)

    answer = operator.post(f"{CONTROLLER}/trajectory", json=body)

    problem = problem_of(answer, 422, "invalid_trajectory")
    told = problem.get("details", {}).get("reason", "")
    assert reason == told or reason in problem["detail"]
    station.loop.step(2500)
    assert arm.goal("arm", goal.id).status == "succeeded"


@pytest.mark.parametrize("number", ["9" * 30, "-" + "9" * 30, "9" * 400])
def test_enormous_whole_numbers_are_refused(arm, operator, number):
    body = json.dumps({"goal": points((0.5, AWAY))}).replace("0.5", number)

    answer = operator.post(GOALS, content=body, headers=JSON)

    assert answer.status_code == 422
    assert arm.goals("arm") == []


def test_a_million_points_are_refused_before_they_are_read(arm, operator):
    row = json.dumps({"positions": AWAY, "time_from_start": 0.5})
    body = (
        '{"goal": {"trajectory": {"joint_names": ["j1", "j2"], "points": ['
        + ",".join([row] * 1_000_000)
        + "]}}}"
    )

    answer = operator.post(GOALS, content=body, headers=JSON)

    problem_of(answer, 413, "body_too_large")
    assert arm.goals("arm") == []


def test_as_many_points_as_fit_are_followed(arm, operator, station):
    rows = [(round(0.001 * (i + 1), 3), [i * 1e-4, -i * 1e-4]) for i in range(3000)]
    answer = operator.post(GOALS, json={"goal": points(*rows)})

    assert answer.status_code == 201
    station.loop.step(3010)
    assert arm.goal("arm", answer.json()["id"]).status == "succeeded"
    assert arm.joint_states().position == pytest.approx(rows[-1][1], abs=1e-6)


def test_velocities_of_some_points_give_straight_lines_between_the_others(arm, station):
    goal = arm.submit_goal(
        "arm",
        points((0.5, [0.1, 0.1], [0.2, 0.2]), (1.0, [0.2, 0.2]), (1.5, AWAY, [0, 0])),
    )
    station.loop.step(752)
    # From a point with a velocity to one without: a line.
    assert arm.joint_states().position == pytest.approx([0.15, 0.15], abs=1e-3)
    station.loop.step(800)
    assert arm.goal("arm", goal.id).status == "succeeded"
    assert arm.joint_states().position == pytest.approx(AWAY, abs=1e-6)


def test_a_start_far_away_is_gone_to_in_the_time_that_there_is(arm, station):
    goal = arm.submit_goal("arm", points((2.0, [1.5, -1.5]), (2.5, [1.6, -1.6])))
    station.loop.step(2510)
    assert arm.goal("arm", goal.id).status == "succeeded"
    assert arm.joint_states().position == pytest.approx([1.6, -1.6], abs=1e-6)
