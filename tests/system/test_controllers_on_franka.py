"""The group controllers of ros_controllers on FrankaHW, under the real manager."""

from itertools import product

import pytest

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.errors import ResourceConflictError, SwitchRefusedError
from station.core.facade.station import Station
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
STIFFNESS = [600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0]
DAMPING = [30.0, 30.0, 30.0, 30.0, 10.0, 10.0, 5.0]
PIDS = {
    joint: {"pid": {"p": p, "i": 0.0, "d": d}}
    for joint, p, d in zip(JOINTS, STIFFNESS, DAMPING, strict=True)
}
TYPES = {
    "effort_position": "effort_controllers/JointGroupPositionController",
    "effort": "effort_controllers/JointGroupEffortController",
    "position": "position_controllers/JointGroupPositionController",
    "velocity": "velocity_controllers/JointGroupVelocityController",
}
ROBOT = {
    "arm_id": "panda",
    "robot_description": "example-robot-data:panda",
    # A step in torque control swings above the velocity limits for a moment.
    "supervisor": {"velocity_factor": 1.5},
}


@pytest.fixture
def station() -> Station:
    tree = ParameterTree({"robot": ROBOT})
    parameters = Parameters(tree)
    hw = FrankaHW()
    hw.init(parameters, Parameters(tree, "robot"))
    clock = ManualClock()
    manager = ControllerManager(hw, parameters, [TableLoader(CONTROLLERS)], clock)
    loop = ControlLoop(hw, manager, clock=clock)
    station = Station(loop, manager, parameters, "franka_hw/FrankaHW")
    for name, controller_type in TYPES.items():
        station.load_controller(name, controller_type, {"joints": JOINTS, **PIDS})
    return station


def switch(station: Station, start: str | None, stop: str | None) -> None:
    request = SwitchRequest(
        start=(start,) if start else (), stop=(stop,) if stop else ()
    )
    assert station.switch_controllers(request).ok


def positions(station: Station) -> list[float]:
    return list(station.latest().position)


@pytest.mark.parametrize(
    ("first", "second"),
    [pair for pair in product([None, *TYPES], repeat=2) if pair[0] != pair[1]],
)
def test_switch_moves_the_arm_by_less_than_a_milliradian(
    station: Station, first: str | None, second: str | None
) -> None:
    station.loop.step(10)
    if first:
        switch(station, first, None)
        station.loop.step(300)
    before = positions(station)
    switch(station, second, first)
    for _ in range(100):
        station.loop.step()
        assert positions(station) == pytest.approx(before, abs=1e-3)


@pytest.mark.parametrize("name", ["effort_position", "position"])
def test_commanded_pose_is_reached_within_two_seconds(
    station: Station, name: str
) -> None:
    switch(station, name, None)
    goal = [q + 0.3 for q in INITIAL_POSITIONS]
    station.motion.set_command(name, goal)
    station.loop.step(2_000)
    assert positions(station) == pytest.approx(goal, abs=0.02)


def test_commanded_velocity_is_reached(station: Station) -> None:
    switch(station, "velocity", None)
    station.motion.set_command("velocity", [0.2] * 7)
    station.loop.step(1_000)
    assert list(station.latest().velocity) == pytest.approx([0.2] * 7, abs=0.01)


def test_switch_in_motion_stays_calm(station: Station) -> None:
    switch(station, "velocity", None)
    station.motion.set_command("velocity", [0.5] * 7)
    station.loop.step(500)
    before = positions(station)
    switch(station, "effort_position", "velocity")
    station.loop.step(1_000)
    # 0.5 rad/s at 7.5 rad/s^2 takes 17 mrad; the PIDs take over near there.
    assert positions(station) == pytest.approx(before, abs=0.05)
    assert max(map(abs, station.latest().velocity)) < 0.01


def test_second_controller_on_the_joints_is_refused_with_the_holder(
    station: Station,
) -> None:
    switch(station, "position", None)
    with pytest.raises(ResourceConflictError, match="'position'"):
        station.switch_controllers(SwitchRequest(start=("velocity",)))
    assert station.controller("position").state.value == "running"


def test_stop_holds_the_arm_in_the_next_cycle(station: Station) -> None:
    switch(station, "effort", None)
    station.motion.set_command("effort", [5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    station.loop.step(200)
    station.stop("test")
    station.loop.step(500)
    held = positions(station)
    station.loop.step(500)
    assert positions(station) == pytest.approx(held, abs=1e-4)
    assert station.latest().mode == "idle"


def test_partial_claim_is_refused(station: Station) -> None:
    station.load_controller("part", TYPES["position"], {"joints": JOINTS[:3]})
    with pytest.raises(SwitchRefusedError, match="all 7 joints or for none"):
        switch(station, "part", None)
