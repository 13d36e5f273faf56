"""Goals: submitted, watched, cancelled."""

import pytest

from station.client import ApiError
from tests.two_joint_station import JOINTS, TRAJECTORY, make_station

GOALS = "/api/v1/controllers/arm/goals"
GOAL = {"trajectory": TRAJECTORY}


@pytest.fixture
def station():
    """Return a station whose trajectory controller is not started."""
    station = make_station(constraints={"j1": {"trajectory": 0.1}})
    station.loop.step()
    return station


@pytest.fixture
def arm(client, station):
    """Return a client of the station with the trajectory controller running."""
    client.switch_controllers(start=["arm"])
    station.loop.step(3)
    return client


def test_a_goal_is_followed_to_its_end(arm, operator, station):
    answer = operator.post(GOALS, json={"goal": GOAL, "epoch": station.epoch})

    assert answer.status_code == 201
    assert answer.json() == {
        "id": "1",
        "status": "pending",
        "progress": 0.0,
        "cancel_requested": False,
        "feedback": None,
        "result": None,
    }
    station.loop.step(250)
    half = arm.goal("arm", "1")
    assert half.status == "active"
    assert half.progress == pytest.approx(0.5, abs=0.01)
    assert half.feedback["joint_names"] == JOINTS
    assert half.feedback["desired"]["positions"] == pytest.approx([0.2, -0.2], abs=0.01)
    assert half.feedback["actual"]["time_from_start"] == pytest.approx(0.25, abs=0.01)
    station.loop.step(300)
    done = arm.goal("arm", "1")
    assert (done.status, done.progress) == ("succeeded", 1.0)
    assert (done.result.code, done.result.message) == (0, "")
    assert done.feedback is None
    assert arm.goals("arm") == [done]
    assert arm.joint_states().position == pytest.approx([0.4, -0.4], abs=1e-6)


def test_a_new_goal_preempts_the_old_goal_and_cancelling_holds_the_joints(arm, station):
    first = arm.submit_goal("arm", GOAL)
    station.loop.step(100)
    second = arm.submit_goal("arm", GOAL)
    station.loop.step(100)
    assert arm.goal("arm", first.id).status == "preempted"
    assert "replaced" in arm.goal("arm", first.id).result.message

    assert arm.cancel_goal("arm", second.id).cancel_requested
    station.loop.step(2)
    here = arm.joint_states().position
    station.loop.step(500)

    assert arm.goal("arm", second.id).status == "preempted"
    assert arm.joint_states().position == pytest.approx(here, abs=1e-9)
    assert arm.cancel_goal("arm", second.id).status == "preempted"


def test_an_aborted_goal_says_which_joint_when_and_by_how_much(arm, station):
    goal = arm.submit_goal("arm", GOAL)
    station.loop.step(100)
    station.loop.hw.joints.mode[0] = ""  # j1 stands still from now on
    station.loop.step(300)

    aborted = arm.goal("arm", goal.id)
    assert aborted.status == "aborted"
    assert aborted.result.code == -4
    assert "'j1' has a position error" in aborted.result.message
    details = aborted.result.details
    assert details["joint"] == "j1"
    assert details["quantity"] == "position"
    assert details["tolerance"] == 0.1
    assert 0.1 < details["error"] < 0.11
    assert 0.1 < details["time"] < 0.4


def test_a_stop_ends_the_goal_for_good(arm, station):
    goal = arm.submit_goal("arm", GOAL)
    station.loop.step(100)
    arm.stop("test")
    station.loop.step()

    with pytest.raises(ApiError) as caught:
        arm.submit_goal("arm", GOAL)
    assert (caught.value.status, caught.value.code) == (423, "stopped")
    assert arm.cancel_goal("arm", goal.id).status == "preempted"
    arm.release_stop()
    arm.release_stop(arm=True)
    arm.switch_controllers(start=["arm"])
    here = arm.joint_states().position
    station.loop.step(600)
    assert arm.joint_states().position == pytest.approx(here, abs=1e-3)
    with pytest.raises(ApiError) as caught:
        arm.submit_goal("arm", GOAL, epoch=1)
    assert (caught.value.status, caught.value.code) == (409, "stale_epoch")


def test_a_trajectory_without_a_goal_and_where_it_leads(arm, station):
    assert arm.follow_trajectory("arm", TRAJECTORY).epoch == station.epoch
    station.loop.step()

    state = arm.query_state("arm", station.loop.time + 1.0)
    assert state.name == JOINTS
    assert state.position == pytest.approx([0.4, -0.4])
    assert state.velocity == [0.0, 0.0]
    assert arm.query_state("arm").position == pytest.approx([0.0, 0.0], abs=1e-4)
    assert arm.goals("arm") == []


def test_the_state_of_a_trajectory_controller_has_its_message(arm, station):
    arm.submit_goal("arm", GOAL)
    station.loop.step(100)

    state = arm.controller_state("arm")
    message = state.published["state"]
    assert message["joint_names"] == JOINTS
    assert message["desired"]["positions"] == state.desired
    assert message["desired"]["velocities"][0] > 0.0
    assert message["error"]["positions"] == pytest.approx(state.error)


@pytest.mark.parametrize("time", ["nan", "inf", "abc", "", "-1"])
@pytest.mark.usefixtures("arm")
def test_impossible_times_are_refused(operator, time):
    answer = operator.get("/api/v1/controllers/arm/query_state", params={"time": time})

    assert answer.status_code == 422


@pytest.mark.parametrize(
    ("name", "status", "code"),
    [
        ("nobody", 404, "controller_not_found"),
        ("group", 422, "invalid_command"),
        ("arm", 409, "controller_state"),
    ],
)
def test_goals_need_a_running_controller_that_takes_them(client, name, status, code):
    for submit in (
        lambda: client.submit_goal(name, GOAL),
        lambda: client.follow_trajectory(name, TRAJECTORY),
        lambda: client.query_state(name),
    ):
        with pytest.raises(ApiError) as caught:
            submit()
        assert (caught.value.status, caught.value.code) == (status, code)


def test_unknown_goals(arm):
    for ask in (arm.goal, arm.cancel_goal):
        with pytest.raises(ApiError) as caught:
            ask("arm", "99")
        assert (caught.value.status, caught.value.code) == (404, "goal_not_found")


def points(*each, **more):
    keys = ("time_from_start", "positions", "velocities", "accelerations")
    rows = [dict(zip(keys, point, strict=False)) for point in each]
    return {"trajectory": {"joint_names": JOINTS, "points": rows, **more}}


AWAY = [0.4, -0.4]


def test_an_empty_goal_stops_the_joints_and_succeeds(arm, station):
    arm.submit_goal("arm", points((1.0, AWAY)))
    station.loop.step(500)
    here = arm.joint_states().position

    goal = arm.submit_goal("arm", points())
    station.loop.step(500)

    assert arm.goal("arm", goal.id).status == "succeeded"
    assert arm.joint_states().position == pytest.approx(here, abs=2e-3)


def test_a_single_point_and_a_replacement_on_the_way_are_smooth(arm, station):
    arm.submit_goal("arm", points((1.0, AWAY)))
    before, steps = list(arm.joint_states().position), []
    for cycle in range(1600):
        if cycle == 500:
            arm.submit_goal("arm", points((1.0, [0.0, 0.3])))
        station.loop.step()
        now = list(station.latest().position)
        steps += [abs(a - b) for a, b in zip(now, before, strict=True)]
        before = now

    assert [goal.status for goal in arm.goals("arm")] == ["preempted", "succeeded"]
    assert before == pytest.approx([0.0, 0.3], abs=1e-6)
    assert max(steps) < 2.5e-3  # 1 ms of at most 2.5 rad/s: nothing jumps


def test_points_in_the_past_are_dropped_and_the_rest_followed(arm, station):
    stamp = station.loop.time - 0.5
    body = points((0.2, [1.0, 1.0]), (1.0, AWAY), stamp=stamp)

    arm.submit_goal("arm", body)
    station.loop.step(600)

    assert arm.joint_states().position == pytest.approx(AWAY, abs=1e-6)


def test_a_goal_is_cancelled_when_control_is_taken_by_force(arm, operator, station):
    with arm.control(owner="Ada"):
        goal = arm.submit_goal("arm", GOAL)
        station.loop.step(100)
        taken = operator.post("/api/v1/control", json={"owner": "G", "force": True})
        station.loop.step(2)
        held = arm.joint_states().position
        station.loop.step(500)

    assert taken.status_code == 200
    ended = arm.goal("arm", goal.id)
    assert ended.status == "preempted"
    assert ended.result.message == "G has taken control from Ada by force."
    assert arm.joint_states().position == held


def test_a_goal_goes_on_when_control_is_handed_over(arm, operator, station):
    with arm.control(owner="Ada") as lease:
        goal = arm.submit_goal("arm", GOAL)
        station.loop.step(100)
        lease.hand_over("Grace")
        operator.post("/api/v1/control", json={"owner": "Grace"})
        station.loop.step(500)

    assert arm.goal("arm", goal.id).status == "succeeded"
