"""Two arms in one world: torques alone, and an error of one stops both."""

import pytest

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller import ControllerState
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.errors import ArmCommandError, ParameterError, SwitchRefusedError
from station.core.facade.station import Station
from station.core.franka import FaultKind, FrankaServicesInterface, RobotMode
from station.core.franka.arms import Arms
from station.core.franka.franka_services import SimulatedFault
from station.core.franka.gripper_services import Grippers
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.hw.robot_loader import create_robot

URDF = "example-robot-data:panda"
ARMS = ("left", "right")


@pytest.fixture
def station() -> Station:
    """Return a station in which both arms are driven by torques."""
    tree, clock = Parameters(), ManualClock()
    tree.set("robot", {"robot_hardware": ["l", "r"]})
    for name, arm_id, y in (("l", "left", 0.5), ("r", "right", -0.5)):
        values = {
            "arm_id": arm_id,
            "robot_description": URDF,
            "base_xyz": [0.0, y, 0.0],
        }
        tree.set(f"robot/{name}", values)
    hw = create_robot("franka_hw/FrankaCombinedHW")
    hw.init(tree, tree.namespace("robot"))
    manager = ControllerManager(hw, tree, [TableLoader(CONTROLLERS)], clock)
    station = Station(ControlLoop(hw, manager, clock=clock), manager, tree)
    for arm_id in ARMS:
        joints = [f"{arm_id}_joint{number}" for number in range(1, 8)]
        kind = "effort_controllers/JointGroupEffortController"
        station.load_controller(arm_id, kind, {"joints": joints})
    station.loop.step()
    station.switch_controllers(SwitchRequest(ARMS, ()))
    station.loop.step(100)
    return station


def test_both_arms_are_in_one_world(station):
    assert Arms(station.robots).names() == list(ARMS)
    assert (
        Arms(station.robots).state("left").time
        == Arms(station.robots).state("right").time
    )
    assert station.latest().mode == "move"


def test_arms_in_one_world_have_one_gravity():
    tree = Parameters()
    tree.set("robot", {"robot_hardware": ["l", "r"]})
    for name, arm_id, z in (("l", "left", -9.81), ("r", "right", -1.62)):
        values = {
            "arm_id": arm_id,
            "robot_description": URDF,
            "gravity": [0.0, 0.0, z],
        }
        tree.set(f"robot/{name}", values)

    with pytest.raises(ParameterError, match="2 vectors of gravity"):
        create_robot("franka_hw/FrankaCombinedHW").init(tree, tree.namespace("robot"))


def test_error_of_one_arm_stops_both_until_it_is_recovered(station):
    Arms(station.robots).inject("left", SimulatedFault(FaultKind.COLLISION, 30))
    station.loop.step(100)

    states = {name: station.controller(name) for name in ARMS}
    assert {one.state for one in states.values()} == {ControllerState.STOPPED}
    assert "left' went to reflex" in states["left"].fault
    assert "arm 'left' is in mode reflex" in states["right"].fault
    with pytest.raises(SwitchRefusedError, match="'left' is in mode reflex"):
        station.switch_controllers(SwitchRequest(("right",), ()))
    assert set(station.robots.recover("left", restart=True)) == set(ARMS)
    station.loop.step(10)
    assert station.latest().mode == "move"


@pytest.mark.parametrize(
    ("interface", "count", "reason"),
    [
        ("hardware_interface::PositionJointInterface", 7, "takes torques alone"),
        ("hardware_interface::EffortJointInterface", 3, "for all 7 joints"),
    ],
)
def test_motions_and_parts_of_an_arm_are_refused(station, interface, count, reason):
    joints = tuple(f"left_joint{number}" for number in range(1, count + 1))
    claims = (InterfaceResources(interface, joints),)
    conflicts = station.loop.hw.check_for_conflict([ControllerInfo("c", "t/C", claims)])
    assert conflicts
    assert reason in conflicts[0].reason


def test_arms_need_names_of_their_own():
    tree = Parameters()
    arm = {"arm_id": "left", "robot_description": URDF}
    tree.set("robot", {"robot_hardware": ["a", "b"], "a": arm, "b": arm})
    hw = create_robot("franka_hw/FrankaCombinedHW")
    with pytest.raises(ParameterError, match="arm_id of its own"):
        hw.init(tree, tree.namespace("robot"))


def test_services_of_every_arm_are_found(station):
    found = station.loop.hw.get(FrankaServicesInterface)
    assert found.get_names() == list(ARMS)


def test_errors_of_several_arms_are_recovered_together(station):
    for name in ARMS:
        Arms(station.robots).inject(name, SimulatedFault(FaultKind.COLLISION, 30))
    station.loop.step(200)
    with pytest.raises(SwitchRefusedError, match="'right' is in mode reflex"):
        station.robots.recover("left", restart=True)

    assert set(station.robots.recover_all(restart=True)) == set(ARMS)

    station.loop.step(10)
    assert station.latest().mode == "move"


def test_no_arm_is_recovered_while_the_user_stop_of_another_arm_is_pressed(station):
    Arms(station.robots).inject("left", SimulatedFault(FaultKind.COLLISION, 30))
    station.loop.step(200)
    Arms(station.robots).set_user_stop("right", pressed=True)
    with pytest.raises(ArmCommandError, match="'right' cannot recover: the user stop"):
        station.robots.recover_all()
    assert Arms(station.robots).report("left").robot_mode is RobotMode.REFLEX
    Arms(station.robots).set_user_stop("right", pressed=False)
    station.robots.recover_all()
    assert Arms(station.robots).report("left").robot_mode is RobotMode.IDLE


def test_every_arm_has_its_own_hand(station):
    Grippers(station.robots).move("left", 0.02)
    station.loop.step(1_000)

    assert Grippers(station.robots).state("left").width == pytest.approx(0.02, abs=1e-3)
    assert Grippers(station.robots).state("right").width == pytest.approx(
        0.08, abs=1e-3
    )
