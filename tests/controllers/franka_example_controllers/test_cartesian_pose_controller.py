"""The end effector traces its arc."""

from math import hypot

import pytest

from station.controllers.franka_example_controllers.cartesian_pose_controller import (
    RADIUS,
)
from station.core.control.switching import SwitchRequest
from station.core.errors import SwitchRefusedError
from station.core.franka.arms import Arms
from tests.controllers.franka_example_controllers.example_station import (
    run_without_errors,
    start_example,
)


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
    with pytest.raises(SwitchRefusedError, match=r"joint 1 is at 0\.5000 rad"):
        start_example("CartesianPose", initial_positions=away)


def test_stop_in_motion_brings_the_arm_to_rest():
    station = start_example("CartesianPose")
    station.loop.step(1_500)
    station.switch_controllers(SwitchRequest((), ("example",)))
    station.loop.step(300)

    state = Arms(station.robots).state("panda")
    assert station.latest().mode == "idle"
    assert max(map(abs, state.dq)) < 1e-3
