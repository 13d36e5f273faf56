"""The three forwarding group controllers, which differ in the quantity only."""

import pytest

from station.controllers.effort_controllers import JointGroupEffortController
from station.controllers.position_controllers import JointGroupPositionController
from station.controllers.velocity_controllers import JointGroupVelocityController
from station.core.errors import (
    InvalidCommandError,
    ParameterError,
    ResourceNotFoundError,
)

JOINTS = ["slide", "elbow", "wheel"]
FAMILIES = {
    "position": JointGroupPositionController,
    "velocity": JointGroupVelocityController,
    "effort": JointGroupEffortController,
}
all_families = pytest.mark.parametrize("family", FAMILIES)


def _commanded(robot, family):
    by_family = {
        "position": robot.positions_commanded,
        "velocity": robot.velocities_commanded,
        "effort": robot.efforts_commanded,
    }
    return by_family[family]


@all_families
def test_a_forwarding_group_claims_its_joints(robot, family):
    controller = robot.load(FAMILIES[family], joints=JOINTS)
    (claimed,) = controller.claims
    assert claimed.resources == ("elbow", "slide", "wheel")
    assert claimed.hardware_interface.lower().endswith(f"{family}jointinterface")


@all_families
@pytest.mark.parametrize("joints", [None, [], ["elbow", "elbow"], "elbow"])
def test_impossible_joint_lists_are_refused(robot, family, joints):
    values = {} if joints is None else {"joints": joints}
    with pytest.raises(ParameterError, match="arm/joints"):
        robot.load(FAMILIES[family], **values)


@all_families
def test_an_unknown_joint_is_refused(robot, family):
    with pytest.raises(ResourceNotFoundError, match="'knee'"):
        robot.load(FAMILIES[family], joints=["elbow", "knee"])


@all_families
def test_starting_lets_the_joints_rest(robot, family):
    robot.position[:] = [0.1, 1.5, 4.0]
    robot.velocity[:] = [0.5, 0.5, 0.5]
    robot.effort[:] = [5.0, 5.0, 5.0]
    _commanded(robot, family)[:] = [9.0, 9.0, 9.0]
    controller = robot.start(FAMILIES[family], joints=JOINTS)
    robot.step(controller)
    rest = [0.1, 1.5, 4.0] if family == "position" else [0.0, 0.0, 0.0]
    assert _commanded(robot, family) == rest
    assert controller.set_points.last is None


@all_families
def test_a_set_point_is_commanded_in_the_next_cycle_and_kept(robot, family, send):
    controller = robot.start(FAMILIES[family], joints=["wheel", "slide"])
    send(controller, [0.7, 0.2])
    robot.step(controller, count=3)
    assert _commanded(robot, family) == [0.2, 0.0, 0.7]


@all_families
def test_a_set_point_from_before_the_start_is_void(robot, family, send):
    controller = robot.load(FAMILIES[family], joints=JOINTS)
    send(controller, [0.1, 0.1, 0.1])
    controller.start_request(robot.time)
    robot.step(controller)
    assert _commanded(robot, family) == [0.0, 0.0, 0.0]


@all_families
@pytest.mark.parametrize("bad", [float("nan"), float("inf"), 1e3])
def test_a_bad_value_is_refused_at_the_door(robot, family, bad):
    controller = robot.start(FAMILIES[family], joints=JOINTS)
    with pytest.raises(InvalidCommandError, match="'elbow'"):
        controller.set_points.check([0.0, bad, 0.0])


@all_families
@pytest.mark.parametrize("values", [[], [0.0, 0.0], [0.0] * 4])
def test_a_wrong_length_is_refused_at_the_door(robot, family, values):
    controller = robot.start(FAMILIES[family], joints=JOINTS)
    with pytest.raises(InvalidCommandError, match="slide, elbow, wheel"):
        controller.set_points.check(values)


@all_families
def test_an_unchecked_set_point_is_kept_within_the_limits(robot, family):
    controller = robot.start(FAMILIES[family], joints=["slide", "elbow"])
    controller.set_points.post([1e3, -1e3])
    robot.step(controller)
    limits = {"position": [0.5, -2.0], "velocity": [1.0, -2.0], "effort": [50, -80]}
    assert _commanded(robot, family)[:2] == limits[family]


@pytest.mark.parametrize(
    ("family", "expected"),
    [
        ("position", [("m", -0.5, 0.5), ("rad", -2.0, 3.0)]),
        ("velocity", [("m/s", -1.0, 1.0), ("rad/s", -2.0, 2.0)]),
        ("effort", [("N", -50.0, 50.0), ("Nm", -80.0, 80.0)]),
    ],
)
def test_set_points_have_units_and_ranges(robot, family, expected):
    controller = robot.load(FAMILIES[family], joints=["slide", "elbow"])
    elements = controller.set_points.elements
    assert [e.name for e in elements] == ["slide", "elbow"]
    assert [(e.unit, e.minimum, e.maximum) for e in elements] == expected


@all_families
def test_without_a_description_the_set_points_are_unlimited(make_robot, family):
    robot = make_robot(urdf="")
    controller = robot.load(FAMILIES[family], joints=["slide"])
    assert controller.set_points.elements[0].maximum == float("inf")


@all_families
def test_the_sample_tells_what_was_done(robot, family, send):
    controller = robot.start(FAMILIES[family], joints=["elbow", "wheel"])
    robot.position[:] = robot.velocity[:] = robot.effort[:] = [0.0, 0.1, 0.2]
    send(controller, [0.5, 0.6])
    robot.step(controller)
    sample = controller.sample
    assert sample.stamp == robot.time
    assert sample.desired == sample.output == [0.5, 0.6]
    assert sample.actual == [0.1, 0.2]
    assert sample.error == pytest.approx([0.4, 0.4])
