"""Positions that arrive now and then become a smooth motion."""

from math import sin

import pytest

from station.core.errors import CommandTimeoutError
from tests.controllers.smoothed_motion.conftest import LIMITS

TARGET = [0.4, -1.0]


def test_starting_rests(stream):
    stream.run(50)

    assert stream.track[-1] == [0.0, 0.0]


def test_a_set_point_is_reached_within_all_limits(stream, send):
    for _ in range(30):
        send(stream.controller, TARGET)
        stream.run(100)

    assert stream.track[-1] == pytest.approx(TARGET, abs=1e-9)
    limits = ["max_velocity", "max_acceleration", "max_jerk"]
    for order, name in enumerate(limits, start=1):
        for found, limit in zip(stream.rates(order), LIMITS[name], strict=True):
            assert found <= limit * 1.01 + 1e-3  # differences of rounded positions


@pytest.mark.parametrize("every", [10, 40, 100])
def test_a_stream_at_any_pace_is_followed_smoothly(stream, send, every):
    for cycle in range(0, 4_000, every):
        send(stream.controller, [0.2 * sin(cycle * 1e-3), 0.5 * sin(cycle * 1e-3)])
        stream.run(every)

    # Behind by the time to catch up, which the limits decide.
    assert stream.track[-1] == pytest.approx([0.2 * sin(4), 0.5 * sin(4)], abs=0.1)
    for order, name in ((1, "max_velocity"), (2, "max_acceleration")):
        for found, limit in zip(stream.rates(order), LIMITS[name], strict=True):
            assert found <= limit * 1.01


def test_a_stream_without_set_points_brakes_and_holds(stream, send):
    send(stream.controller, TARGET)
    stream.run(201)
    moving = stream.controller.generator.velocities
    assert abs(moving[0]) > 0.2
    stream.run(800)
    held = stream.track[-1]
    stream.run(200)

    assert stream.track[-1] == pytest.approx(held, abs=1e-12)
    assert held[0] < 0.4
    assert stream.rates(3)[0] <= LIMITS["max_jerk"][0] * 1.01 + 1e-3
    assert stream.controller.set_points.last == pytest.approx(held)


def test_the_timeout_of_a_stream_elapses_while_the_simulation_is_paused(stream, send):
    send(stream.controller, TARGET)
    stream.run(100)
    stream.clock.advance(5.0)
    stream.run(1_000)

    assert stream.track[-1][0] < 0.2


def test_a_stream_continues_after_a_timeout(stream, send):
    send(stream.controller, TARGET)
    stream.run(1_000)
    for _ in range(20):
        send(stream.controller, TARGET)
        stream.run(100)

    assert stream.track[-1] == pytest.approx(TARGET, abs=1e-9)


def test_the_timeout_of_a_stream_can_fail_the_controller(robot, send):
    from station.controllers.smoothed_motion import (
        PositionJointStreamingController,
    )
    from tests.controllers.smoothed_motion.conftest import Runner

    action = {"command_timeout_action": "stop"}
    runner = Runner(
        robot, robot.start(PositionJointStreamingController, **LIMITS, **action)
    )
    send(runner.controller, TARGET)

    with pytest.raises(CommandTimeoutError):
        runner.run(300)


def test_a_void_set_point_brakes_a_stream(stream, send):
    send(stream.controller, TARGET)
    stream.run(150)
    stream.controller.set_points.clear()
    stream.run(800)
    held = stream.track[-1]
    stream.run(100)

    assert stream.track[-1] == pytest.approx(held, abs=1e-12)
    assert 0.0 < held[0] < 0.3
