"""Trajectories over each kind of command interface."""

import pytest

from station.controllers.joint_trajectory_controller import (
    EffortJointTrajectoryController,
    PositionJointTrajectoryController,
    PosVelAccJointTrajectoryController,
    PosVelJointTrajectoryController,
    VelocityJointTrajectoryController,
)
from station.controllers.joint_trajectory_controller.controller import (
    adapter_for,
)
from station.core.errors import (
    ControllerLoadError,
    InvalidGainError,
    ParameterError,
)
from station.core.hardware.interfaces import (
    JointStateInterface,
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
)
from station.core.parameters import Parameters
from station.core.ports.goal import GoalStatus

JOINTS = ["slide", "elbow"]
GAINS = {"slide": {"p": 400.0, "d": 40.0}, "elbow": {"p": 400.0, "d": 40.0}}


def _start(robot, kind=EffortJointTrajectoryController, **values):
    defaults = {"joints": JOINTS, "gains": GAINS}
    return robot.start(kind, **(defaults | values))


def _goal(controller, *points):
    keys = ("time_from_start", "positions", "velocities", "accelerations")
    return controller.goals.submit({
        "trajectory": {
            "joint_names": JOINTS,
            "points": [dict(zip(keys, point, strict=False)) for point in points],
        }
    })


@pytest.mark.parametrize(
    "kind", [EffortJointTrajectoryController, VelocityJointTrajectoryController]
)
def test_efforts_and_velocities_are_zero_after_the_start(robot, kind):
    robot.position[:] = [0.2, 1.0, 0.0]
    controller = _start(robot, kind)
    robot.step(controller)
    assert robot.efforts_commanded == robot.velocities_commanded == [0.0] * 3


def test_efforts_answer_errors_of_position_and_velocity(robot):
    controller = _start(robot)
    robot.step(controller)
    robot.position[1] = -0.1
    robot.velocity[1] = 0.5
    robot.step(controller)
    assert robot.efforts_commanded[1] == pytest.approx(400 * 0.1 - 40 * 0.5)


def test_a_share_of_the_desired_velocity_is_fed_forward(robot):
    controller = _start(
        robot,
        VelocityJointTrajectoryController,
        gains={"slide": {"p": 0.0}, "elbow": {"p": 0.0}},
        velocity_ff={"elbow": 0.8},
    )
    robot.step(controller)
    _goal(controller, (1.0, [0.2, 1.0]))
    robot.step(controller, count=10)
    assert robot.velocities_commanded[:2] == pytest.approx([0.0, 0.8])


def test_unit_masses_follow_a_smooth_trajectory(robot):
    controller = _start(robot, constraints={"goal_time": 0.5, "slide": {"goal": 0.01}})
    robot.step(controller)
    rest = [0.0, 0.0]
    goal = _goal(
        controller, (1.0, [0.2, 1.0], [0.1, 0.2], rest), (1.8, [0.3, 0.5], rest, rest)
    )
    worst = 0.0
    for _ in range(2200):
        robot.run_with_effort(controller, 1)
        worst = max(worst, *(abs(error) for error in controller.sample.error))
    assert goal.status is GoalStatus.SUCCEEDED
    # Without feed-forward the error is acceleration / p: about 10 / 400.
    assert worst < 0.03


def _sag(robot, controller, count):
    """Run cycles in which a load of 40 pulls every unit mass."""
    for _ in range(count):
        robot.run_with_effort(controller, 1)
        for index in range(2):
            robot.velocity[index] -= 40.0 * 0.001
            robot.position[index] -= 40.0 * 1e-6


@pytest.mark.parametrize("target", [0.0, None])
def test_a_loaded_joint_does_not_sink_with_every_goal_that_is_cancelled(robot, target):
    controller = _start(robot)
    _sag(robot, controller, 3000)
    first = list(robot.position[:2])
    assert first == pytest.approx([-0.1, -0.1], abs=0.01)  # 40 / 400
    for _ in range(20):
        there = first if target is None else [target, target]
        goal = _goal(controller, (1.0, there))
        _sag(robot, controller, 50)
        controller.goals.cancel(goal.identifier)
        _sag(robot, controller, 100)
    _sag(robot, controller, 2000)
    assert robot.position[:2] == pytest.approx(first, abs=1e-3)


def test_a_loaded_joint_that_is_asked_to_stay_is_watched_where_it_stands(robot):
    constraints = {"slide": {"goal": 0.01}, "elbow": {"goal": 0.01}}
    controller = _start(robot, constraints=constraints)
    _sag(robot, controller, 4000)
    goal = _goal(controller, (0.1, list(robot.position[:2])))
    _sag(robot, controller, 200)
    assert goal.status is GoalStatus.SUCCEEDED
    goal = _goal(controller, (0.1, list(robot.position[:2])))
    robot.position[0] += 0.3
    _sag(robot, controller, 200)
    assert goal.status is GoalStatus.ABORTED


def test_closed_loop_trajectories_require_gains(robot):
    with pytest.raises(ParameterError, match="'arm/elbow/pid/p' is missing"):
        _start(robot, gains={"slide": {"p": 1.0}})


def test_gains_change_by_name_beside_the_speed(robot):
    controller = _start(robot)
    changed = controller.tunables.values | {"elbow/p": 7.0, "speed_scaling": 0.5}
    assert set(changed) == set(controller.tunables.schema)
    controller.tunables.apply(controller.tunables.checked(changed))
    assert controller.tunables.values == changed
    with pytest.raises(InvalidGainError, match="elbow/i_clamp_min"):
        controller.tunables.check_together(
            changed | {"elbow/i_clamp_min": 1.0, "elbow/i_clamp_max": 0.0}
        )


@pytest.mark.parametrize(
    ("kind", "interface"),
    [
        (PositionJointTrajectoryController, "PositionJointInterface"),
        (VelocityJointTrajectoryController, "VelocityJointInterface"),
        (EffortJointTrajectoryController, "EffortJointInterface"),
    ],
)
def test_a_trajectory_controller_claims_its_joints(robot, kind, interface):
    controller = robot.load(kind, joints=["elbow", "slide"], gains=GAINS)
    (claimed,) = controller.claims
    assert claimed.hardware_interface == f"hardware_interface::{interface}"
    assert claimed.resources == ("elbow", "slide")
    assert controller.joint_names == ["elbow", "slide"]


def test_an_interface_without_an_adapter_is_refused():
    with pytest.raises(ControllerLoadError, match="JointStateInterface"):
        adapter_for(JointStateInterface(), [], Parameters())


@pytest.fixture(
    params=[
        (PosVelJointTrajectoryController, PosVelJointInterface, PosVelJointHandle, 2),
        (
            PosVelAccJointTrajectoryController,
            PosVelAccJointInterface,
            PosVelAccJointHandle,
            3,
        ),
    ],
    ids=["pos_vel", "pos_vel_acc"],
)
def desired_states(request, robot):
    """Let the robot take 2 or 3 numbers per joint; return the kind and the commands."""
    kind, interface_type, handle_type, size = request.param
    commands = [[0.0] * 3 for _ in range(size)]
    interface = interface_type()
    for index, state in enumerate(robot.get(JointStateInterface).handles()):
        interface.register_handle(handle_type(state, *commands, index))
    robot.register_interface(interface)
    return kind, commands


def test_desired_states_after_the_start_are_rest(robot, desired_states):
    kind, commands = desired_states
    robot.position[:] = [0.1, 0.2, 0.3]
    controller = robot.start(kind, joints=JOINTS)
    robot.step(controller)
    assert commands == [[0.1, 0.2, 0.0], *[[0.0] * 3 for _ in commands[1:]]]
    assert controller.claims[0].resources == ("elbow", "slide")


def test_desired_states_are_commanded_as_they_are(robot, desired_states):
    kind, commands = desired_states
    controller = robot.start(kind, joints=["elbow"])
    robot.step(controller)
    rest = {"velocities": [0.0], "accelerations": [0.0]}
    point = {"positions": [1.0], "time_from_start": 1.0, **rest}
    controller.goals.submit({
        "trajectory": {"joint_names": ["elbow"], "points": [point]}
    })
    robot.step(controller, count=250)
    desired = controller.trajectory_state.desired
    assert desired.position[0] > 0.0
    values = [desired.position[0], desired.velocity[0], desired.acceleration[0]]
    assert [column[1] for column in commands] == values[: len(commands)]
    assert controller.sample.output == desired.position
