"""The motion examples refuse to start away from their start pose.

The joints swing by commands of position and velocity, the end effector traces its arc
and its line, and the elbow swings while the end effector stays.
"""

from math import hypot, sqrt

import pytest

from station.controllers.franka_example_controllers.example_motions import (
    ELBOW_AMPLITUDE,
    JOINT_AMPLITUDE,
    RADIUS,
    START_POSE,
    check_start_pose,
)
from station.core.control.switching import SwitchRequest
from station.core.errors import ControllerStateError, SwitchRefusedError
from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)


def test_start_pose_is_accepted_within_its_tolerance():
    check_start_pose([q + 0.09 for q in START_POSE])
    with pytest.raises(ControllerStateError, match="Joint 7 is at"):
        check_start_pose([*START_POSE[:6], START_POSE[6] + 0.11])


def test_refusal_says_how_to_get_there():
    with pytest.raises(ControllerStateError) as caught:
        check_start_pose([0.0] * 7)

    way = caught.value.remedy.partition("TRAJECTORY_CONTROLLER ")[2]
    assert [float(q) for q in way.split()] == pytest.approx(START_POSE, abs=1e-5)


@pytest.mark.slow
def test_joints_are_where_they_should_be_after_half_a_period():
    station = start_example("JointPosition")
    start = Arms(station.robots).state("panda").q_d

    run_without_errors(station, 5.0)

    moved = [
        now - then
        for now, then in zip(Arms(station.robots).state("panda").q, start, strict=True)
    ]
    way = 2 * JOINT_AMPLITUDE
    assert moved == pytest.approx([way] * 4 + [-way] + [way] * 2, abs=1e-3)


@pytest.mark.slow
def test_joints_go_the_way_that_is_under_the_velocity():
    station = start_example("JointVelocity")
    start = Arms(station.robots).state("panda").q_d

    run_without_errors(station, 4.0)

    state = Arms(station.robots).state("panda")
    assert state.dq == pytest.approx([0.1] * 7, abs=2e-3)
    # Half of the mean velocity of 0.05 rad/s over 8 s.
    expected = [q + 0.2 for q in start]
    assert state.q_d == pytest.approx(expected, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("impedance", "is_limiting", "tolerance"),
    [
        # The arm is measured at 12 um from the arc, and at 221 um with the springs at
        # its end effector alone, which friction deflects more.
        ("joint_impedance", True, 1e-4),
        ("joint_impedance", False, 1e-4),
        ("cartesian_impedance", True, 1e-3),
    ],
)
def test_arc_is_traced_within_a_millimetre(impedance, is_limiting, tolerance):
    station = start_example(
        "CartesianPose", internal_controller=impedance, rate_limiting=is_limiting
    )
    start = Arms(station.robots).state("panda").O_T_EE

    path = run_without_errors(station, 10.0)

    for x, y, z in path:
        from_centre = hypot(x - start[12], z - (start[14] + RADIUS))
        assert from_centre == pytest.approx(RADIUS, abs=tolerance)
        assert y == pytest.approx(start[13], abs=tolerance)
    assert min(x for x, _, _ in path) == pytest.approx(start[12] - RADIUS, abs=1e-3)
    end = Arms(station.robots).state("panda")
    assert end.O_T_EE[:15] == pytest.approx(start[:15], abs=1e-3)
    assert not any(end.last_motion_errors)


def test_start_does_not_move_the_arm():
    station = start_example("CartesianPose")
    before = Arms(station.robots).state("panda").q
    station.loop.step(20)

    assert Arms(station.robots).state("panda").q == pytest.approx(before, abs=1e-4)


def test_start_far_from_the_start_pose_is_refused():
    away = [0.5, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
    with pytest.raises(SwitchRefusedError, match=r"Joint 1 is at 0\.5000 rad"):
        start_example("CartesianPose", initial_positions=away)


def test_stop_in_motion_brings_the_arm_to_rest():
    station = start_example("CartesianPose")
    station.loop.step(1_500)
    station.switch_controllers(SwitchRequest((), ("example",)))
    station.loop.step(300)

    state = Arms(station.robots).state("panda")
    assert station.latest().mode == "idle"
    assert max(map(abs, state.dq)) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("is_limiting", [True, False])
def test_line_is_traced_within_a_millimetre(is_limiting):
    station = start_example("CartesianVelocity", rate_limiting=is_limiting)
    start = Arms(station.robots).state("panda").O_T_EE[12:15]

    path = run_without_errors(station, 8.0)

    for x, y, z in path:
        dx, dz = x - start[0], z - start[2]
        assert abs(dx + dz) / sqrt(2.0) < 1e-4  # measured: 11 um
        assert abs(y - start[1]) < 1e-4
    # The mean of the speed is half of the peak: 0.025 m/s for 4 s.
    farthest = max(x for x, _, _ in path) - start[0]
    assert farthest * sqrt(2.0) == pytest.approx(0.1, abs=1e-3)
    assert path[-1] == pytest.approx(start, abs=1e-3)
    assert not any(Arms(station.robots).state("panda").last_motion_errors)


@pytest.mark.slow
def test_elbow_swings_and_the_end_effector_stays():
    station = start_example("Elbow")
    start = Arms(station.robots).state("panda")

    path = run_without_errors(station, 5.0)

    state = Arms(station.robots).state("panda")
    assert state.elbow_d[0] == pytest.approx(
        start.elbow_d[0] + 2 * ELBOW_AMPLITUDE, abs=1e-3
    )
    for point in path:
        assert point == pytest.approx(start.O_T_EE[12:15], abs=1e-3)
