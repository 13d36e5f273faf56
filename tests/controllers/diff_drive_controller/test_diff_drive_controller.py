"""The rostests of ros_controllers' diff_drive_controller, retold.

Source: ros_controllers@678b92a diff_drive_controller/test: forward, turn, limits,
timeout, multipliers, open loop, wrong and left-out parameters, skid steering. The two
wheels of that robot are 0.4 m apart here, and have a radius of 0.1 m.
"""

from math import cos, pi, sin

import pytest

from station.core.errors import StationError
from station.testing import Bench

WHEELS = ["left", "right"]
SIZE = {"wheel_separation": 0.4, "wheel_radius": 0.1}
LIMITS = {
    "linear": {
        "x": {
            "has_velocity_limits": True,
            "max_velocity": 1.0,
            "min_velocity": -0.5,
            "has_acceleration_limits": True,
            "max_acceleration": 2.0,
        }
    }
}
URDF = """<robot name="diffbot"><link name="base"/>{wheels}</robot>"""
WHEEL = """<link name="{name}_link"><collision><geometry>{shape}</geometry></collision>
</link><joint name="{name}" type="continuous"><parent link="base"/>
<child link="{name}_link"/><origin xyz="0 {y} 0"/><axis xyz="0 1 0"/>
<limit effort="5" velocity="100"/></joint>"""


def make(urdf: str = "", joints: list[str] = WHEELS, **parameters: object) -> Bench:
    """Return a bench that runs a controller of ideal wheels as `drive`."""
    root = {"robot_description": urdf} if urdf else {}
    hw = {"joints": joints, "initial_positions": [3.0] * len(joints)}
    bench = Bench(None, hw, root_parameters=root)
    given = {"left_wheel": "left", "right_wheel": ["right"], **parameters}
    bench.load_controller("drive", "diff_drive_controller/DiffDriveController", **given)
    bench.switch(start=["drive"])
    return bench


def commands(bench: Bench) -> list[float]:
    """Return the velocities that the wheels were last sent [rad/s]."""
    return list(bench.robot.joints.velocity_command)


def urdf(shape: str = '<cylinder radius="0.1" length="0.02"/>') -> str:
    places = {"left": 0.2, "right": -0.2}
    wheels = [WHEEL.format(name=n, y=y, shape=shape) for n, y in places.items()]
    return URDF.format(wheels="".join(wheels))


def controller(bench: Bench):
    return bench.manager.get_controller("drive")


def drive(bench: Bench, linear: float, angular: float, seconds: float) -> None:
    controller(bench).set_points.post([linear, angular], timeout=1e6)
    bench.step(round(seconds * 1000))


def test_it_stands_still_without_a_command():
    bench = make(**SIZE)
    bench.step(1000)
    odometry = controller(bench).odometry
    assert (odometry.x, odometry.y, odometry.heading) == (0.0, 0.0, 0.0)
    assert commands(bench) == [0.0, 0.0]


def test_it_drives_forward():
    bench = make(**SIZE)
    drive(bench, 0.1, 0.0, 10.0)
    odometry = controller(bench).odometry
    assert odometry.x == pytest.approx(1.0, abs=1e-3)
    assert (odometry.y, odometry.heading) == (0.0, 0.0)
    assert odometry.linear == pytest.approx(0.1)
    assert commands(bench) == pytest.approx([1.0, 1.0])


def test_it_turns_on_the_spot():
    bench = make(**SIZE)
    drive(bench, 0.0, pi / 10.0, 5.0)
    odometry = controller(bench).odometry
    assert odometry.heading == pytest.approx(pi / 2.0, abs=1e-3)
    assert (odometry.x, odometry.y) == pytest.approx((0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("open_loop", [False, True])
def test_it_drives_a_circle(open_loop):
    """The independent truth: a circle of the radius v / w."""
    bench = make(**SIZE, open_loop=open_loop)
    drive(bench, 0.5, 0.25, 4.0)
    odometry = controller(bench).odometry
    # The first cycle only takes the command up: 1 ms of it is missing, or two.
    assert odometry.heading == pytest.approx(1.0, abs=1e-3)
    assert odometry.x == pytest.approx(2.0 * sin(1.0), abs=2e-3)
    assert odometry.y == pytest.approx(2.0 * (1.0 - cos(1.0)), abs=2e-3)


def test_acceleration_and_velocity_are_limited():
    bench = make(**SIZE, **LIMITS)
    drive(bench, 10.0, 0.0, 0.25)
    # 2 m/s^2 for 0.25 s at a radius of 0.1 m
    assert commands(bench) == pytest.approx([5.0, 5.0])
    bench.step(1000)
    assert commands(bench) == pytest.approx([10.0, 10.0])
    drive(bench, -10.0, 0.0, 2.0)
    assert commands(bench) == pytest.approx([-5.0, -5.0])


def test_jerk_is_limited():
    limits = {"x": {"has_jerk_limits": True, "max_jerk": 5.0}}
    bench = make(**SIZE, linear=limits)
    drive(bench, 10.0, 0.0, 0.1)
    # A change of the change of 2 j dt^2 in every cycle: v = j t (t + dt).
    assert commands(bench)[0] == pytest.approx(5.0 * 0.1 * 0.101 / 0.1)


def test_it_brakes_when_commands_stay_away():
    bench = make(**SIZE, cmd_vel_timeout=0.5)
    controller(bench).set_points.post([1.0, 0.0])
    bench.step(10)
    assert commands(bench) == pytest.approx([10.0, 10.0])
    bench.clock.advance(0.6)
    bench.step(1)
    assert commands(bench) == [0.0, 0.0]


def test_multipliers_change_the_size():
    bench = make(**SIZE, wheel_radius_multiplier=2.0, wheel_separation_multiplier=0.5)
    drive(bench, 0.0, 1.0, 0.01)
    # 1 rad/s * 0.2 m / 2 / 0.2 m
    assert commands(bench) == pytest.approx([-0.5, 0.5])


def test_size_comes_from_the_robot_description():
    bench = make(urdf())
    drive(bench, 0.0, 1.0, 0.01)
    assert commands(bench) == pytest.approx([-2.0, 2.0])


def test_wheel_of_unknown_radius_is_refused():
    with pytest.raises(StationError, match="cylinder or a sphere"):
        make(urdf('<box size="1 1 1"/>'))


def test_four_wheels_drive_as_two_sides():
    bench = make(
        joints=["l1", "l2", "r1", "r2"],
        left_wheel=["l1", "l2"],
        right_wheel=["r1", "r2"],
        **SIZE,
    )
    drive(bench, 0.1, 0.0, 1.0)
    assert controller(bench).odometry.x == pytest.approx(0.1, abs=1e-3)
    assert commands(bench) == pytest.approx([1.0] * 4)


@pytest.mark.parametrize(
    ("parameters", "reason"),
    [
        ({"right_wheel": ["right", "spare"], **SIZE}, "as many wheels as right_wheel"),
        ({"left_wheel": [], **SIZE}, "a list of joints, or one name"),
        ({"wheel_radius": 0.1}, "wheel_separation"),
        ({**SIZE, "wheel_radius": 0.0}, "wheel_radius"),
        ({**SIZE, "left_wheel": "ghost"}, "ghost"),
        ({**SIZE, "pose_covariance_diagonal": [1.0]}, "pose_covariance_diagonal"),
        (
            {
                **SIZE,
                "linear": {"x": {"has_jerk_limits": True, "max_jerk": -1.0}},
            },
            "linear/x/max_jerk",
        ),
    ],
)
def test_wrong_parameters_are_refused(parameters, reason):
    with pytest.raises(StationError, match=reason):
        make(**parameters)


def test_it_publishes_the_odometry_and_what_is_asked_for():
    bench = make(
        **SIZE,
        **LIMITS,
        publish_cmd=True,
        publish_joint_trajectory_controller_state=True,
        odom_frame_id="map",
    )
    drive(bench, 10.0, 0.0, 0.1)
    found = controller(bench).published()
    assert found["odom"]["frame_id"] == "map"
    assert found["odom"]["child_frame_id"] == "base_link"
    assert 0.0 < found["odom"]["position"][0] < 0.1
    assert found["cmd_vel_out"]["linear"][0] < 1.0
    wheels = found["joint_trajectory_controller_state"]
    assert wheels["joint_names"] == ["left", "right"]


def test_a_restart_does_not_move_the_base():
    bench = make(**SIZE)
    drive(bench, 0.1, 0.0, 1.0)
    bench.switch(stop=["drive"])
    bench.step(10)
    before = controller(bench).odometry.x
    bench.switch(start=["drive"])
    bench.step(10)
    odometry = controller(bench).odometry
    assert (odometry.x, odometry.linear) == (pytest.approx(before, abs=1e-3), 0.0)
