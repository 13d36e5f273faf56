"""What streaming and jogging share."""

from math import sin

import pytest

from station.controllers.smoothed_motion import (
    PositionJointJogController,
    PositionJointStreamingController,
)
from station.core.errors import (
    CommandTimeoutError,
    InvalidCommandError,
    ParameterError,
    RobotDescriptionError,
)
from tests.controllers.smoothed_motion.conftest import JOINTS, LIMITS

BOTH = pytest.mark.parametrize(
    "kind", [PositionJointJogController, PositionJointStreamingController]
)


@BOTH
def test_a_start_in_motion_neither_jumps_nor_jerks(robot, kind):
    robot.position[:] = [0.1, 0.2, 0.0]
    robot.velocity[:] = [0.2, -1.0, 0.0]
    controller = robot.start(kind, **LIMITS)
    robot.step(controller)

    assert robot.positions_commanded[:2] == pytest.approx([0.1002, 0.199], abs=1e-5)
    robot.step(controller, 1_500)
    held = list(robot.positions_commanded)
    robot.step(controller, 100)
    assert robot.positions_commanded == held


@BOTH
@pytest.mark.parametrize(
    "values",
    [
        {"command_timeout": 0.0},
        {"command_timeout": 1.5},
        {"command_timeout": -1.0},
        {"command_timeout_action": "off"},
        {"max_velocity": 3.0},
        {"joints": []},
    ],
)
def test_impossible_parameters_are_refused(robot, kind, values):
    with pytest.raises(ParameterError):
        robot.load(kind, **(LIMITS | values))


@BOTH
def test_smoothed_motion_needs_a_robot_description(make_robot, kind):
    with pytest.raises(RobotDescriptionError):
        make_robot(JOINTS, "").load(kind, joints=JOINTS)


@BOTH
def test_the_desired_positions_of_a_sample_are_the_smoothed_ones(robot, kind):
    controller = robot.start(kind, **LIMITS)
    robot.step(controller)

    sample = controller.sample
    assert sample.desired == sample.output == [0.0, 0.0]
    assert sample.actual == sample.error == [0.0, 0.0]


@pytest.mark.parametrize(
    "kind", [PositionJointJogController, PositionJointStreamingController]
)
def test_smoothed_motion_claims_its_joints_for_position_commands(robot, kind):
    (claim,) = robot.load(kind, **LIMITS).claims

    assert claim.hardware_interface == "hardware_interface::PositionJointInterface"
    assert claim.resources == ("elbow", "slide")


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
