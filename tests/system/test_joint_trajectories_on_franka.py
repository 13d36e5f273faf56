"""Trajectories on the simulated Franka arm, with the original's default parameters."""

from math import sqrt

import pytest

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters, ParameterTree
from station.core.ports.goal import Goal, GoalStatus
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
STIFFNESS = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0]
DAMPING = [30.0, 30.0, 30.0, 30.0, 10.0, 10.0, 5.0]
# franka_control config/default_controllers.yaml; the goal's bound is 0.05 rad there.
DEFAULTS = {
    "joints": JOINTS,
    "constraints": {"goal_time": 0.5, **{joint: {"goal": 0.05} for joint in JOINTS}},
    "gains": {
        joint: {"p": p, "d": d, "i": 0.0}
        for joint, p, d in zip(JOINTS, STIFFNESS, DAMPING, strict=True)
    },
}
TYPES = {
    "effort": "effort_controllers/JointTrajectoryController",
    "position": "position_controllers/JointTrajectoryController",
}
OFFSETS = [
    [0.3, 0.2, -0.3, 0.2, 0.3, -0.3, 0.4],
    [-0.3, 0.3, 0.2, 0.4, -0.3, 0.2, -0.4],
    [0.2, -0.2, 0.3, -0.2, 0.4, 0.3, 0.3],
    [-0.2, 0.1, -0.3, 0.3, -0.2, -0.2, 0.2],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
]
WAYPOINTS = [
    [start + offset for start, offset in zip(INITIAL_POSITIONS, row, strict=True)]
    for row in OFFSETS
]
# The hand would be below the floor.
UNDERGROUND = [0.0, 1.2, 0.0, -1.2, 0.0, 1.6, 0.8]


# No reflex: what is tested here is what the controller makes of an obstacle.
INSENSITIVE = {
    f"{side}_{what}_thresholds_{kind}": [1e3] * size
    for side in ("lower", "upper")
    for what, size in (("torque", 7), ("force", 6))
    for kind in ("acceleration", "nominal")
}


@pytest.fixture
def station() -> Station:
    robot = {
        "arm_id": "panda",
        "robot_description": "example-robot-data:panda",
        "realism": "ideal",
        "collision_config": INSENSITIVE,
        "supervisor": {"velocity_factor": 1.5, "torque_factor": 5.0},
    }
    tree = ParameterTree({"robot": robot})
    parameters = Parameters(tree)
    hw = FrankaHW()
    hw.init(parameters, Parameters(tree, "robot"))
    clock = ManualClock()
    manager = ControllerManager(hw, parameters, [TableLoader(CONTROLLERS)], clock)
    loop = ControlLoop(hw, manager, clock=clock)
    station = Station(loop, manager, parameters, "franka_hw/FrankaHW")
    for name, controller_type in TYPES.items():
        station.load_controller(name, controller_type, DEFAULTS)
    return station


def start(station: Station, name: str) -> None:
    assert station.switch_controllers(SwitchRequest(start=(name,))).ok
    station.loop.step(5)


def submit(
    station: Station,
    name: str,
    points: list[list[float]],
    pace: float,
    **fields: object,
) -> Goal:
    """Send a goal that rests at every point, `pace` seconds apart."""
    rest = [0.0] * 7
    message = [
        {
            "positions": point,
            "velocities": rest,
            "accelerations": rest,
            "time_from_start": pace * (index + 1),
        }
        for index, point in enumerate(points)
    ]
    trajectory = {"joint_names": JOINTS, "points": message}
    goals = station.manager.get_controller(name).goals
    assert goals is not None
    return goals.submit({"trajectory": trajectory, **fields})


def errors(station: Station, name: str) -> list[float]:
    sample = station.controller_sample(name)
    assert sample is not None
    return sample.error


@pytest.mark.slow
@pytest.mark.parametrize("name", TYPES)
def test_five_waypoints_are_tracked_within_five_milliradians(
    station: Station, name: str
) -> None:
    start(station, name)
    goal = submit(station, name, WAYPOINTS, pace=1.2)
    squares, cycles = [0.0] * 7, 0
    while not goal.is_final():
        station.loop.step()
        cycles += 1
        row = errors(station, name)
        squares = [s + e * e for s, e in zip(squares, row, strict=True)]
    assert goal.status is GoalStatus.SUCCEEDED
    assert cycles == pytest.approx(6000, abs=520)
    assert max(sqrt(square / cycles) for square in squares) < 5e-3
    station.loop.step(500)
    assert max(map(abs, errors(station, name))) < 2e-3


@pytest.mark.slow
def test_an_obstacle_aborts_with_the_joint_and_the_arm_holds(station: Station) -> None:
    start(station, "effort")
    bounds = [{"name": joint, "position": 0.05} for joint in JOINTS]
    goal = submit(station, "effort", [UNDERGROUND], pace=2.0, path_tolerance=bounds)
    for _ in range(3_000):
        station.loop.step()
        if goal.is_final():
            break
    assert goal.status is GoalStatus.ABORTED
    assert goal.result is not None
    assert goal.result.code == -4
    assert goal.result.details["joint"] in JOINTS
    assert abs(float(str(goal.result.details["error"]))) > 0.05
    station.loop.step(500)
    before = list(station.latest().position)
    station.loop.step(500)
    assert list(station.latest().position) == pytest.approx(before, abs=2e-3)
    assert station.controller("effort").state.value == "running"


@pytest.mark.parametrize("name", TYPES)
def test_starting_and_an_early_stop_leave_no_goal_to_resume(
    station: Station, name: str
) -> None:
    station.loop.step(10)
    rest = list(station.latest().position)
    start(station, name)
    station.loop.step(100)
    assert list(station.latest().position) == pytest.approx(rest, abs=1e-3)
    goal = submit(station, name, WAYPOINTS[:1], pace=1.0)
    station.loop.step(300)
    station.stop("a test")
    station.loop.step(300)
    assert goal.status is GoalStatus.PREEMPTED
    held = list(station.latest().position)
    station.release_stop(arm=False)
    station.release_stop(arm=True)
    start(station, name)
    station.loop.step(300)
    assert list(station.latest().position) == pytest.approx(held, abs=2e-3)
