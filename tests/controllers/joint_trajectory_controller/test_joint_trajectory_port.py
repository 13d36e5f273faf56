"""Trajectories without a goal."""

import pytest

from station.core.errors import InvalidTrajectoryError

AWAY = {"time_from_start": 1.0, "positions": [0.4, 1.0, 1.0]}
JOINTS = ["slide", "elbow", "wheel"]


def test_hold_ends_the_motion(robot, start):
    controller = start()
    controller.trajectories.follow_trajectory({"joint_names": JOINTS, "points": [AWAY]})
    robot.run_with_position(controller, 500)
    here = list(robot.position)

    controller.trajectories.hold()
    robot.run_with_position(controller, 100)

    assert robot.position == pytest.approx(here, abs=1e-12)


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        ({"joint_names": None}, "joint_names"),
        ({"joint_names": JOINTS, "points": 3}, "points"),
        ({"joint_names": ["nose"] * 3, "points": [AWAY]}, "expected"),
        ({"joint_names": JOINTS, "points": [AWAY], "goal": 1}, "made of"),
    ],
)
def test_a_malformed_trajectory_is_refused_and_changes_nothing(
    robot, start, request_, message
):
    controller = start()

    with pytest.raises(InvalidTrajectoryError, match=message):
        controller.trajectories.follow_trajectory(request_)

    robot.run_with_position(controller, 100)
    assert robot.position == [0.0, 0.0, 0.0]


def test_the_state_can_be_asked_for_any_time_of_the_trajectory(robot, start, make_goal):
    controller = start()
    robot.run_with_position(controller, 10)
    controller.goals.submit(make_goal((1.0, AWAY["positions"])))
    robot.run_with_position(controller, 100)
    query = controller.trajectories.query_state
    here = query(robot.time)
    assert here.position == pytest.approx(controller.sample.desired)
    later = query(robot.time + 9.0)
    assert later.position == pytest.approx(AWAY["positions"])
    assert later.velocity == [0.0, 0.0, 0.0]
    with pytest.raises(InvalidTrajectoryError, match="before the trajectory"):
        query(robot.time - 9.0)
