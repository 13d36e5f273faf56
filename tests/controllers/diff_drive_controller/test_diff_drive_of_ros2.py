"""The same controller with the parameters of ROS 2: limits, odometry, references.

Expected numbers are those of ros2_controllers@6.x diff_drive_controller and of
control_toolbox@6.x RateLimiter, computed here.
"""

from math import cos, nan, sin

import numpy as np
import pytest

from station.controllers.diff_drive_controller.speed_limits import RateLimiter
from station.core.errors import StationError
from station.testing import Bench
from tests.controllers.diff_drive_controller.test_diff_drive_controller import (
    commands,
    controller,
    drive,
)

SIZE = {
    "left_wheel_names": ["left"],
    "right_wheel_names": ["right"],
    "wheel_separation": 0.4,
    "wheel_radius": 0.1,
}
PERIOD = 0.001


def make(**parameters):
    bench = Bench(None, {"joints": ["left", "right"]})
    kind = "diff_drive_controller/DiffDriveController"
    bench.load_controller("drive", kind, **{**SIZE, **parameters})
    bench.switch(start=["drive"])
    return bench


def limited(wanted, values=(-0.5, 1.0), rates=(-3.0, 2.0, -1.0, 4.0), jerk=500.0):
    """Return the velocities that RateLimiter makes of wanted ones."""
    brake, forwards, backwards, brake_back = rates
    before, last, found = 0.0, 0.0, []
    for v in wanted:
        dv, dv0 = v - last, last - before
        if (dv - dv0) * dv > 0:
            bound = jerk * PERIOD**2
            v = last + dv0 + np.clip(dv - dv0, -bound, bound)
        low, high = (brake, forwards) if last > 0 else (backwards, brake_back)
        if last == 0:
            low, high = backwards, forwards
        v = np.clip(last + np.clip(v - last, low * PERIOD, high * PERIOD), *values)
        before, last = last, v
        found.append(v)
    return found


WANTED = [10.0] * 900 + [-10.0] * 1200 + [10.0] * 300


def test_limits_are_those_of_control_toolbox():
    limiter = RateLimiter((-0.5, 1.0), (-3.0, 2.0), (-1.0, 4.0), (-500.0, 500.0))
    before, last, found = 0.0, 0.0, []
    for wanted in WANTED:
        before, last = last, limiter.limit(wanted, last, before, PERIOD)
        found.append(last)

    assert found == pytest.approx(limited(WANTED), abs=1e-12)


def test_limits_are_read_by_the_names_of_ros2():
    bench = make(
        linear={
            "x": {
                "max_velocity": 1.0,
                "min_velocity": -0.5,
                "max_acceleration": 2.0,
                "max_deceleration": -3.0,
                "max_acceleration_reverse": -1.0,
                "max_deceleration_reverse": 4.0,
                "max_jerk": 500.0,
            }
        }
    )
    drive(bench, 10.0, 0.0, 0.9)
    drive(bench, -10.0, 0.0, 1.2)
    drive(bench, 10.0, 0.0, 0.3)

    # The first cycle takes the set-point up.
    expected = limited(WANTED)[-1] / 0.1
    assert commands(bench) == pytest.approx([expected] * 2)


@pytest.mark.parametrize(
    ("more", "velocity"),
    [
        ({"max_acceleration": 2.0}, 0.02),
        ({"max_acceleration": 2.0, "has_acceleration_limits": False}, 5.0),
        ({"min_acceleration": -2.0}, 5.0),
        ({"max_velocity": nan}, 5.0),
    ],
)
def test_a_limit_without_a_largest_value_is_none(more, velocity):
    bench = make(linear={"x": more})
    drive(bench, 5.0, 0.0, 0.01)

    assert commands(bench) == pytest.approx([velocity / 0.1] * 2)


def test_each_side_has_a_radius_of_its_own():
    bench = make(left_wheel_radius_multiplier=2.0, right_wheel_radius_multiplier=0.5)
    drive(bench, 1.0, 0.5, 2.0)

    assert commands(bench) == pytest.approx([0.9 / 0.2, 1.1 / 0.05])
    odometry = controller(bench).odometry
    assert odometry.linear == pytest.approx(1.0)
    assert odometry.angular == pytest.approx(0.5)


@pytest.mark.parametrize(
    "more", [{}, {"position_feedback": False}, {"open_loop": True}]
)
def test_the_heading_has_no_bound(more):
    bench = make(**more)
    drive(bench, 0.5, 1.0, 5.0)

    odometry = controller(bench).odometry
    assert odometry.heading == pytest.approx(5.0, abs=2e-3)
    assert odometry.x == pytest.approx(0.5 * sin(5.0), abs=2e-3)
    assert odometry.y == pytest.approx(0.5 * (1.0 - cos(5.0)), abs=2e-3)
    # It is published in every cycle: q = (0, 0, sin h/2, cos h/2) with that heading.
    odom = controller(bench).published()["odom"]
    assert odom["stamp"] == controller(bench).sample.stamp
    assert odom["orientation"][2] == pytest.approx(sin(odometry.heading / 2.0))


def test_the_open_loop_has_what_is_commanded_now():
    bench = make(open_loop=True)
    drive(bench, 0.5, 0.0, 0.001)

    assert controller(bench).odometry.linear == 0.5
    assert controller(bench).odometry.x == pytest.approx(0.5 * PERIOD)


def test_a_timeout_of_zero_is_none():
    bench = make(cmd_vel_timeout=0.0)
    controller(bench).set_points.post([1.0, 0.0])
    bench.step(10)
    bench.clock.advance(100.0)
    bench.step(10)

    assert commands(bench) == pytest.approx([10.0, 10.0])


def test_a_wheel_that_reads_nan_ends_it():
    bench = make()
    bench.step(2)
    bench.robot.script.nan_sensors = {"left"}
    bench.step(2)

    assert "no reading" in str(bench.fault("drive"))


def test_another_controller_commands_it_by_references():
    bench = make()
    names = [each.name for each in controller(bench).on_export_reference_interfaces()]
    assert names == ["linear/velocity", "angular/velocity"]
    (chain,) = [c for c in bench.manager.chains().controllers if c.name == "drive"]
    assert [each.name for each in chain.references] == [f"drive/{n}" for n in names]


def test_frames_have_the_prefix_and_the_name_of_ros2_publishes_commands():
    bench = make(tf_frame_prefix="/left", publish_limited_velocity=True)
    bench.step(2)

    found = controller(bench).published()
    assert found["odom"]["frame_id"] == "left/odom"
    assert found["odom"]["child_frame_id"] == "left/base_link"
    assert "cmd_vel_out" in found


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        ({"right_wheel_names": []}, "right_wheel_names"),
        ({"right_wheel_names": ["right", "left"]}, "as many wheels as right_wheel_nam"),
        ({"linear": [1]}, "drive/linear' is .1."),
        ({"angular": {"z": 2.0}}, "drive/angular/z' is 2.0"),
        (
            {"linear": {"x": {"max_acceleration": 1.0, "max_deceleration": 1.0}}},
            "max_deceleration' is 1; it must be 0 or less",
        ),
        ({"linear": {"x": {"max_velocity": -1.0}}}, "max_velocity' is -1;"),
        ({"left_wheel_radius_multiplier": 0.0}, "left_wheel_radius_multiplier"),
    ],
)
def test_wrong_parameters_are_refused(parameters, reason):
    with pytest.raises(StationError, match=reason):
        make(**parameters)
