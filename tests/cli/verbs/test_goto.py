"""The verb that moves the arm to a pose."""

import json

import pytest

from station.client import blocking
from station.wire import Goal, GoalResult


def goal(status: str, message: str = "", code: int = 0) -> Goal:
    result = GoalResult(code=code, message=message, details={}) if message else None
    return Goal(
        id="7", status=status, progress=0.0, cancel_requested=False, result=result
    )


@pytest.fixture(autouse=True)
def _no_waiting(monkeypatch):
    monkeypatch.setattr(blocking.time, "sleep", lambda _: None)


def test_it_waits_until_the_joints_are_there(run, station):
    station.goals = [goal("pending"), goal("active"), goal("succeeded")]

    outcome = run("goto arm 1.5 -0.5")

    assert outcome.code == 0
    assert "succeeded" in outcome.out
    name, controller, request = station.calls[0]
    assert (name, controller) == ("submit_goal", "arm")
    assert request["trajectory"]["joint_names"] == ["j1", "j2"]
    (point,) = request["trajectory"]["points"]
    assert point["positions"] == [1.5, -0.5]
    assert point["time_from_start"] == pytest.approx(2.0)  # 1 rad at 0.5 rad/s
    assert station.calls[1:] == [("goal", "arm", "7")] * 2


def test_a_duration_can_be_given(run, station):
    station.goals = [goal("succeeded")]

    outcome = run("goto arm 1 2 --duration 3.5 --json")

    assert json.loads(outcome.out)["status"] == "succeeded"
    (point,) = station.calls[0][2]["trajectory"]["points"]
    assert point["time_from_start"] == 3.5


def test_a_rehearsed_motion_is_given_with_its_certificate(run, station):
    station.goals = [goal("succeeded")]

    assert run("goto arm 1 2 --certificate Z9l").code == 0
    assert run("command arm 1 2 --certificate Q1").code == 0

    submitted, commanded = station.calls
    assert (submitted[0], submitted[-1]) == ("submit_goal", "Z9l")
    assert commanded == ("command", "arm", [1.0, 2.0], "Q1")


def test_a_path_that_is_planned_anew_has_no_certificate(run, station):
    outcome = run("goto arm 1 2 --plan --certificate Z9l")

    assert outcome.code == 2
    assert "Leave one of them out" in outcome.err
    assert station.calls == []


def test_an_aborted_goal_is_a_refusal_with_its_reason(run, station):
    station.goals = [goal("pending"), goal("aborted", "Joint 'j1' is off.", -4)]

    outcome = run("goto arm 1 2")

    assert outcome.code == 1
    assert "Joint 'j1' is off." in outcome.out


def test_an_interrupt_cancels_the_goal(run, station, monkeypatch):
    station.goals = [goal("pending")]

    def interrupt(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(blocking.time, "sleep", interrupt)
    run("goto arm 1 2")

    assert station.calls[-1] == ("cancel_goal", "arm", "7")


def test_a_planned_pose_of_the_hand_and_a_name_of_the_robot_reach_the_station(
    run, station
):
    station.trajectory_controllers = ["arm"]
    station.goals = [goal("succeeded"), goal("succeeded")]

    assert run("goto arm 0.4 0.1 0.5 1 0 0 0 --pose --plan").code == 0
    assert run("goto packed --plan").code == 0
    pose, named = (one[2] for one in station.calls if one[0] == "plan")
    assert (pose.position, pose.orientation) == ((0.4, 0.1, 0.5), (1.0, 0.0, 0.0, 0.0))
    assert named == "packed"


@pytest.mark.parametrize("numbers", ["1 2 --pose --plan", "1 2 3 --pose"])
def test_a_pose_of_other_numbers_or_without_a_plan_is_refused(run, numbers):
    outcome = run(f"goto arm {numbers}")
    assert outcome.code == 2
    assert "3 or 7 numbers" in outcome.err


def test_a_pose_starts_a_trajectory_controller_and_goes_there(run, station):
    station.trajectory_controllers = ["effort_arm", "position_arm"]
    station.goals = [goal("succeeded")]

    outcome = run("goto ready")

    assert outcome.code == 0
    assert station.calls[1] == ("switch", {"start": ["position_arm"], "stop": ["arm"]})
    name, controller, request = station.calls[2]
    assert (name, controller) == ("submit_goal", "position_arm")
    (point,) = request["trajectory"]["points"]
    assert point["positions"] == pytest.approx(
        [0, -0.7854, 0, -2.3562, 0, 1.5708, 0.7854], abs=1e-4
    )
    assert point["time_from_start"] > 4.0  # 2.4 rad at 0.5 rad/s


def test_an_unknown_pose_is_told_with_those_there_are(run, station):
    outcome = run("goto kitchen")

    assert outcome.code == 2
    assert "There is no pose 'kitchen'. The poses are: ready" in outcome.err
    assert station.calls == []


def test_a_file_of_motion_primitives_is_followed(run, station, tmp_path):
    station.goals = [goal("pending"), goal("succeeded")]
    file = tmp_path / "motions.yaml"
    file.write_text("motions:\n- {type: PTP, joint_positions: [0.1, 0.2]}\n")

    outcome = run(f"motion_sequence arm {file}")

    assert outcome.code == 0
    assert station.calls[0] == (
        "submit_goal",
        "arm",
        {"trajectory": {"motions": [{"type": "PTP", "joint_positions": [0.1, 0.2]}]}},
    )

    file.write_text("motions: 3\n")
    assert "no list 'motions'" in run(f"motion_sequence arm {file}").err
