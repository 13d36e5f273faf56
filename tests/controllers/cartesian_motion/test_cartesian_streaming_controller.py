"""Poses that arrive now and then become a smooth motion."""

from math import cos, pi, sin
from random import Random

import numpy as np
import pytest

from station.controllers.cartesian_motion import CartesianStreamingController
from station.controllers.cartesian_motion.cartesian_limits import ROTATION, TRANSLATION
from station.core.errors import CommandTimeoutError, InvalidCommandError
from station.core.numerics.poses import displace, quaternion_of, rotation_between
from tests.hw.franka.cartesian_motions import PERIOD

LIMITS = (TRANSLATION, ROTATION)


def numbers(pose, sign=1.0):
    """Return a pose as a set-point."""
    return [*pose[12:15], *(sign * value for value in quaternion_of(pose))]


def moved(arm, shift=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0)):
    return displace(arm.state.O_T_EE_d, shift, turn)


def check_limits(arm):
    """Assert that the motion so far was within all limits, and the arm content."""
    assert arm.errors == []
    for order, name in enumerate(["velocity", "acceleration", "jerk"], start=1):
        for found, limit in zip(arm.rates(order), LIMITS, strict=True):
            # Third differences of rounded poses are off by some 1e-6.
            assert found <= getattr(limit, name) * (1.0 + 1e-6) + 1e-4


def test_starting_rests(arm):
    before = list(arm.state.O_T_EE_d)
    controller = arm.start(CartesianStreamingController)
    arm.run(controller, 50)

    assert arm.state.O_T_EE_d == pytest.approx(before, abs=1e-9)
    assert arm.errors == []


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_pose_is_reached_by_the_short_way(arm, send, sign):
    controller = arm.start(CartesianStreamingController)
    target = moved(arm, (0.1, -0.15, 0.05), (0.3, -0.2, 0.5))
    for _ in range(20):
        send(controller, numbers(target, sign))
        arm.run(controller, 100)

    assert arm.state.O_T_EE_d == pytest.approx(target, abs=1e-6)
    turned = sum(np.linalg.norm(twist[3:]) for twist in arm.twists) * 1e-3
    assert turned == pytest.approx(np.linalg.norm([0.3, -0.2, 0.5]), abs=0.01)
    check_limits(arm)


def test_position_and_orientation_arrive_together(arm, send):
    controller = arm.start(CartesianStreamingController)
    target = moved(arm, (0.01, 0.0, 0.0), (0.0, 0.0, 0.8))
    send(controller, numbers(target))
    while True:
        before = np.linalg.norm(rotation_between(arm.state.O_T_EE_d, target)) / 0.8
        distance = abs(target[12] - arm.state.O_T_EE_d[12]) / 0.01
        if before < 0.1:
            break
        send(controller, numbers(target))
        arm.run(controller, 20)

    assert distance > 0.01


@pytest.mark.parametrize("every", [10, 40, 100])
@pytest.mark.parametrize("seed", [1, 2])
def test_limits_hold_over_random_streams(arm, send, every, seed):
    random = Random(seed)
    controller = arm.start(CartesianStreamingController)
    start = list(arm.state.O_T_EE_d)
    for _ in range(1_000 // every):
        shift = [random.uniform(-0.15, 0.15) for _ in range(3)]
        turn = [random.uniform(-0.6, 0.6) for _ in range(3)]
        send(controller, numbers(displace(start, shift, turn)))
        arm.run(controller, every)

    check_limits(arm)


def test_half_a_turn_away_is_no_trouble(arm, send):
    controller = arm.start(CartesianStreamingController)
    for _ in range(15):
        # About its own z axis, by rounding now this way, now that way.
        target = displace(arm.state.O_T_EE_d, (0.0, 0.0, 0.0), (0.0, 0.0, pi))
        send(controller, numbers(target))
        arm.run(controller, 20)

    check_limits(arm)


def test_a_circle_is_followed_with_the_lag_of_the_limits(arm, send):
    controller = arm.start(CartesianStreamingController)
    start = list(arm.state.O_T_EE_d)
    for step in range(100):
        angle = 0.02 * step
        shift = (0.05 * (cos(angle) - 1.0), 0.05 * sin(angle), 0.0)
        send(controller, numbers(displace(start, shift, (0.0, 0.0, 0.0))))
        arm.run(controller, 20)

    reached = [a - b for a, b in zip(arm.state.O_T_EE_d[12:], start[12:], strict=True)]
    assert reached[:3] == pytest.approx(shift, abs=0.02)
    check_limits(arm)


def test_a_pose_stream_without_set_points_brakes_and_holds(arm, send):
    controller = arm.start(CartesianStreamingController)
    send(controller, numbers(moved(arm, (0.15, 0.0, 0.0))))
    arm.run(controller, 199)
    assert controller.generator.twist[0] > 0.05
    arm.run(controller, 800)
    held = list(arm.state.O_T_EE_d)
    arm.run(controller, 200)

    assert arm.state.O_T_EE_d == pytest.approx(held, abs=1e-9)
    assert controller.set_points.last[:3] == pytest.approx(held[12:15], abs=1e-6)
    check_limits(arm)


def test_the_timeout_of_a_pose_stream_elapses_on_the_wall_clock(arm, send):
    controller = arm.start(CartesianStreamingController)
    send(controller, numbers(moved(arm, (0.15, 0.0, 0.0))))
    arm.run(controller, 100)
    arm.clock.advance(0.2)  # the simulation stands still
    controller.update_request(arm.time, 0.0)
    arm.run(controller, 800)

    assert max(abs(value) for value in controller.generator.twist) < 1e-9
    check_limits(arm)


def test_the_timeout_of_a_pose_stream_can_fail_the_controller(arm, send):
    controller = arm.start(CartesianStreamingController, command_timeout_action="stop")
    send(controller, numbers(arm.state.O_T_EE_d))

    with pytest.raises(CommandTimeoutError, match="panda"):
        arm.run(controller, 300)


def test_a_void_set_point_brakes_a_pose_stream(arm, send):
    controller = arm.start(CartesianStreamingController)
    send(controller, numbers(moved(arm, (0.2, 0.0, 0.0))))
    arm.run(controller, 150)
    controller.set_points.clear()
    arm.run(controller, 800)

    assert max(abs(value) for value in controller.generator.twist) < 1e-9
    check_limits(arm)


def test_a_pose_out_of_reach_ends_where_the_joints_end(arm, send):
    controller = arm.start(CartesianStreamingController)
    for _ in range(60):
        send(controller, [1.5, 0.0, 0.5, *numbers(arm.state.O_T_EE_d)[3:]])
        arm.run(controller, 50)

    state = controller.published()["state"]
    assert state["obstacle"] == "singularity"
    assert "the arm waits" in state["message"]
    back = moved(arm, (-0.2, 0.0, 0.0))
    for _ in range(40):
        send(controller, numbers(back))
        arm.run(controller, 50)
    assert arm.state.O_T_EE_d == pytest.approx(back, abs=1e-6)
    assert controller.published()["state"]["obstacle"] == "none"
    check_limits(arm)


@pytest.mark.parametrize(
    ("values", "part"),
    [
        ([0.3, 0.0, 0.5, 1.0, 0.0, 0.0], "6 values"),
        ([0.3, float("nan"), 0.5, 1.0, 0.0, 0.0, 0.0], "'y' is nan"),
        ([0.3, 0.0, float("inf"), 1.0, 0.0, 0.0, 0.0], "'z' is inf"),
        ([0.3, 0.0, 0.5, 0.9, 0.0, 0.0, 0.0], r"length 0\.9"),
        ([0.3, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0], "length 0"),
    ],
)
def test_what_is_no_pose_is_refused(arm, send, values, part):
    controller = arm.start(CartesianStreamingController)

    with pytest.raises(InvalidCommandError, match=part):
        send(controller, values)


def test_the_sample_is_in_the_terms_of_the_set_point(arm, send):
    controller = arm.start(CartesianStreamingController)
    send(controller, numbers(moved(arm, (0.02, 0.0, 0.0))))
    arm.run(controller, 100)

    assert controller.joint_names == ["x", "y", "z", "qx", "qy", "qz", "qw"]
    assert controller.sample.desired == pytest.approx(controller.sample.output)
    assert controller.sample.error == pytest.approx([
        d - a
        for d, a in zip(
            controller.sample.desired, controller.sample.actual, strict=True
        )
    ])
    assert max(map(abs, controller.sample.error)) < 1e-3


def writes(arm, controller):
    """Return whether an update writes the command."""
    arm.command[12] = 9.0
    controller.update_request(arm.time, PERIOD)
    return arm.command[12] != 9.0


def test_at_rest_the_motion_is_not_computed_until_the_set_point_changes(arm, send):
    controller = arm.start(CartesianStreamingController)
    assert writes(arm, controller)  # braking from the start
    assert not writes(arm, controller)
    send(controller, numbers(moved(arm, (0.05, 0.0, 0.0))))
    assert all(writes(arm, controller) for _ in range(100))
    controller.set_points.clear()
    assert writes(arm, controller)
    while writes(arm, controller):
        pass
    assert not writes(arm, controller)
    controller.start_request(arm.time)
    assert writes(arm, controller)


class Steered(CartesianStreamingController):
    """Notes what it makes the target."""

    targets = ()

    def steer(self, set_point):
        self.targets = (*self.targets, set_point)
        return super().steer(set_point)


def test_a_set_point_is_made_the_target_once_and_again_after_an_obstacle(arm, send):
    controller = arm.start(Steered, joint_velocity_share=0.1)
    arm.run(controller, 5)
    send(controller, numbers(moved(arm, (0.0005, 0.0, 0.0))))
    arm.run(controller, 100)
    assert controller.is_free
    assert len(controller.targets) == 2  # rest, and the set-point
    send(controller, numbers(moved(arm, (0.2, 0.0, 0.0))))
    arm.run(controller, 199)
    assert not controller.is_free
    assert len(controller.targets) > 3
