"""Joints move while the button is held, and no longer."""

import pytest

from station.core.errors import InvalidCommandError
from tests.controllers.smoothed_motion.conftest import LIMITS


def hold(jog, send, velocities, times, every=50):
    """Hold the button: send the same again and again."""
    for _ in range(times):
        send(jog.controller, velocities)
        jog.run(every)


def test_a_held_button_moves_at_its_velocity(jog, send):
    hold(jog, send, [0.1, -1.0], 20)

    assert jog.controller.generator.velocities == pytest.approx([0.1, -1.0])
    assert jog.rates(2)[1] <= LIMITS["max_acceleration"][1] * 1.01


@pytest.mark.parametrize("silence", [True, False])
def test_zero_or_missing_set_points_end_a_jog(jog, send, silence):
    hold(jog, send, [0.1, -0.5], 10)
    if not silence:
        send(jog.controller, [0.0, 0.0])
    jog.run(199)
    if silence:
        assert jog.controller.generator.velocities[0] > 0.0
    jog.run(600)
    held = jog.track[-1]
    jog.run(100)

    assert jog.track[-1] == held
    assert jog.controller.generator.velocities == pytest.approx([0.0, 0.0])
    for order, name in ((2, "max_acceleration"), (3, "max_jerk")):
        assert jog.rates(order)[1] <= LIMITS[name][1] * 1.01 + 1e-3


@pytest.mark.parametrize(
    ("velocity", "limit"), [(0.5, 0.5), (-0.5, -0.5)], ids=["upper", "lower"]
)
def test_a_joint_brakes_before_its_limits(jog, send, velocity, limit):
    hold(jog, send, [velocity, 0.0], 60)

    positions = [row[0] for row in jog.track]
    assert max(map(abs, positions)) <= 0.5
    assert positions[-1] == pytest.approx(limit, abs=2e-3)
    hold(jog, send, [-velocity, 0.0], 10)
    assert abs(jog.track[-1][0]) < abs(limit) - 0.05


def test_a_joint_beyond_its_limits_may_only_go_back(robot, jog, send):
    robot.position[0] = 0.52
    jog.controller.start_request(robot.time)
    hold(jog, send, [0.3, 0.0], 10)
    assert jog.track[-1][0] == pytest.approx(0.52, abs=1e-9)

    hold(jog, send, [-0.3, 0.0], 10)

    assert jog.track[-1][0] < 0.5


def test_one_joint_at_its_limit_does_not_hold_the_others_up(robot, jog, send):
    robot.position[0] = 0.5
    jog.controller.start_request(robot.time)
    hold(jog, send, [0.3, 0.5], 20)

    assert jog.track[-1][0] == pytest.approx(0.5, abs=1e-9)
    assert jog.controller.generator.velocities[1] == pytest.approx(0.5)


@pytest.mark.parametrize("values", [[0.6, 0.0], [0.0, -1.6], [0.1]])
def test_velocities_beyond_the_limits_are_refused(jog, send, values):
    with pytest.raises(InvalidCommandError):
        send(jog.controller, values)


@pytest.mark.parametrize("timeout", [0.0, 1.5])
def test_no_set_point_is_valid_for_long(jog, timeout):
    with pytest.raises(InvalidCommandError, match="at most 1"):
        jog.controller.set_points.check([0.1, 0.1], timeout)
