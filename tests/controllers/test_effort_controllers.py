"""Controllers that command efforts: PIDs, angles, gains, rest, forwarding.

The test of ros_controllers@678b92a effort_controllers/test, TestPosition, is
`test_the_simple_robot_reaches_its_targets_one_after_the_other`.
"""

from math import pi
from pathlib import Path

import pytest
import yaml

from station.controllers.effort_controllers import (
    JointEffortController,
    JointGroupEffortController,
    JointGroupPositionController,
    JointPositionController,
    JointVelocityController,
)
from station.core.errors import (
    InvalidCommandError,
    InvalidGainError,
    ParameterError,
    RobotDescriptionError,
)

FOLDER = Path(__file__).parents[1] / "data" / "ros_yaml" / "effort_controllers"
JOINTS = ["slide", "elbow", "wheel"]
PID = {"p": 100.0, "i": 0.0, "d": 20.0}


def _start(robot, pid=None, joints=JOINTS, **values):
    values |= {joint: {"pid": pid or PID} for joint in joints}
    return robot.start(JointGroupPositionController, joints=joints, **values)


def test_starting_commands_no_effort(robot):
    robot.position[:] = [0.3, -1.0, 7.0]
    controller = _start(robot)
    robot.step(controller)
    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_a_joint_that_starts_beyond_its_limits_is_not_driven_back(robot):
    robot.position[:] = [0.7, 3.2, 0.0]
    controller = _start(robot)
    robot.step(controller)
    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_starting_again_forgets_the_integral(robot, send):
    controller = _start(robot, pid={"p": 0.0, "i": 10.0, "d": 0.0, "i_clamp": 5.0})
    send(controller, [0.1, 0.1, 0.1])
    robot.step(controller, count=100)
    assert robot.efforts_commanded[0] == pytest.approx(0.1)
    controller.stop_request(robot.time)
    controller.start_request(robot.time)
    robot.step(controller)
    assert robot.efforts_commanded == [0.0, 0.0, 0.0]


def test_unit_masses_reach_the_set_point(robot, send):
    controller = _start(robot)
    send(controller, [0.3, -1.0, 2.0])
    robot.run_with_effort(controller, count=3000)
    # Critically damped with time constant 0.1 s: 30 of them have passed.
    assert robot.position == pytest.approx([0.3, -1.0, 2.0], abs=1e-6)


def test_a_continuous_joint_turns_the_short_way(robot, send):
    robot.position[2] = 3.0
    controller = _start(robot, pid={"p": 1.0})
    send(controller, [0.0, 0.0, -3.0])
    robot.step(controller)
    assert controller.sample.error[2] == pytest.approx(2 * pi - 6.0)


def test_a_revolute_joint_does_not_turn_through_its_limit(robot, send):
    robot.position[1] = -1.5
    controller = _start(robot, pid={"p": 1.0})
    send(controller, [0.0, 2.5, 0.0])
    robot.step(controller)
    assert controller.sample.error[1] == pytest.approx(4.0)


def test_a_set_point_beyond_the_limits_is_refused(robot):
    controller = _start(robot)
    with pytest.raises(InvalidCommandError, match=r"'slide' is 0\.6; allowed is -0\.5"):
        controller.set_points.check([0.6, 0.0, 0.0])


def test_the_position_controller_needs_a_robot_description(make_robot):
    with pytest.raises(RobotDescriptionError, match="robot_description"):
        _start(make_robot(urdf=""))


def test_a_joint_without_gains_is_refused(robot):
    with pytest.raises(ParameterError, match="'arm/wheel/pid/p' is missing"):
        robot.load(
            JointGroupPositionController,
            joints=["slide", "wheel"],
            slide={"pid": PID},
        )


@pytest.mark.parametrize(
    "values",
    [
        {"elbow": {"pid": PID}},
        {"elbow": PID},
        {"gains": {"elbow": PID}},
        {"gains": {"elbow": {"pid": PID}}},
        {"pid": PID},
    ],
)
def test_gains_are_read_from_all_usual_places(robot, values):
    controller = robot.load(JointGroupPositionController, joints=["elbow"], **values)
    assert controller.tunables.values["elbow/p"] == 100.0
    assert controller.tunables.values["elbow/d"] == 20.0


def test_gains_have_units_and_ranges(robot):
    controller = _start(robot, joints=["slide", "elbow"])
    schema = controller.tunables.schema
    assert list(schema) == list(controller.tunables.values)
    assert {key: schema[f"elbow/{key}"].unit for key in ("p", "i", "d")} == {
        "p": "Nm/rad",
        "i": "Nm/(rad s)",
        "d": "Nm s/rad",
    }
    assert schema["slide/p"].unit == "N/m"
    assert schema["elbow/i_clamp_min"].maximum == 0.0


def test_the_range_of_a_gain_includes_the_configured_value(robot):
    controller = _start(robot, pid={"p": 50_000.0, "d": -1.0})
    schema = controller.tunables.schema
    assert schema["elbow/p"].maximum == 50_000.0
    assert schema["elbow/d"].minimum == -1.0


def test_changed_gains_work_in_the_next_cycle(robot, send):
    controller = _start(robot, pid={"p": 1.0})
    send(controller, [0.1, 0.1, 0.1])
    robot.step(controller)
    changes = {"elbow/p": 300.0}
    values = controller.tunables.checked(changes)
    controller.tunables.apply(values)
    robot.step(controller)
    assert robot.efforts_commanded == pytest.approx([0.1, 30.0, 0.1])
    assert controller.tunables.values == values


def test_bounds_of_the_integral_part_may_not_cross(robot):
    controller = _start(robot)
    crossed = {"elbow/i_clamp_min": 2.0, "elbow/i_clamp_max": 1.0}
    with pytest.raises(InvalidGainError, match=r"'elbow/i_clamp_min' is 2.0, above"):
        controller.tunables.check_together(controller.tunables.values | crossed)


def test_antiwindup_outlives_a_change_of_gains(robot, send):
    controller = _start(
        robot, pid={"p": 0.0, "i": 10.0, "i_clamp": 1.0, "antiwindup": True}
    )
    controller.tunables.apply(controller.tunables.values | {"elbow/p": 1e-9})
    send(controller, [0.5, 0.5, 0.5])
    robot.step(controller, count=2000)
    send(controller, [-0.5, -0.5, -0.5])
    robot.step(controller, count=300)
    # An integral bounded at 0.1 s falls below 0 after 0.2 s; a wound-up one needs 2 s.
    assert robot.efforts_commanded[1] < 0.0


def test_the_sample_tells_what_was_done(robot, send):
    controller = _start(robot, pid={"p": 10.0})
    robot.position[:] = [0.1, 0.0, 0.0]
    send(controller, [0.3, 0.0, 0.0])
    robot.step(controller)
    sample = controller.sample
    assert sample.desired == [0.3, 0.0, 0.0]
    assert sample.actual == [0.1, 0.0, 0.0]
    assert sample.error == pytest.approx([0.2, 0.0, 0.0])
    assert sample.output == pytest.approx([2.0, 0.0, 0.0])


def test_the_simple_robot_reaches_its_targets_one_after_the_other(make_robot, send):
    values = yaml.safe_load((FOLDER / "simple_bot_controllers.yaml").read_text())
    robot = make_robot(["joint"], (FOLDER / "simple_bot.urdf").read_text())
    controller = robot.start(JointPositionController, **values["position_controller"])
    for target in (1.0, -1.0, 0.0):
        send(controller, [target])
        robot.run_with_effort(controller, count=2000, period=0.01)
        # Tolerance of the original's test; the time constant is 2 s, 20 s have passed.
        assert robot.position[0] == pytest.approx(target, abs=5e-2)


def test_the_position_controller_claims_its_joint_for_effort_commands(robot):
    controller = robot.load(JointPositionController, joint="slide", pid={"p": 1.0})
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::EffortJointInterface"
    assert claimed.resources == ("slide",)
    assert controller.tunables.schema["slide/p"].unit == "N/m"


def test_a_unit_mass_reaches_the_velocity(robot, send):
    controller = robot.start(JointVelocityController, joint="elbow", pid={"p": 50.0})
    send(controller, [1.5])
    robot.run_with_effort(controller, count=1000)
    # First order with time constant 0.02 s: 50 of them have passed.
    assert robot.velocity[1] == pytest.approx(1.5, abs=1e-9)


def test_set_points_of_the_velocity_controller_are_within_the_velocity_limits(robot):
    controller = robot.load(JointVelocityController, joint="elbow", pid={"p": 5.0})
    (element,) = controller.set_points.elements
    assert (element.unit, element.minimum, element.maximum) == ("rad/s", -2.0, 2.0)


def test_the_velocity_controller_requires_gains(robot):
    with pytest.raises(ParameterError, match="'arm/elbow/pid/p' is missing"):
        robot.load(JointVelocityController, joint="elbow")


@pytest.mark.parametrize(
    ("controller_class", "names"),
    [
        (JointEffortController, {"joint": "elbow"}),
        (JointGroupEffortController, {"joints": ["elbow", "wheel"]}),
    ],
)
def test_a_forwarding_controller_claims_its_joints_for_effort_commands(
    robot, controller_class, names
):
    controller = robot.load(controller_class, **names)
    (claimed,) = controller.claims
    assert claimed.hardware_interface == "hardware_interface::EffortJointInterface"
    assert claimed.resources[0] == "elbow"
    assert controller.set_points.elements[0].unit == "Nm"
