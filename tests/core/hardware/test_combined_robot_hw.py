"""Several robots as one (CM-110 … CM-117).

Several simulated worlds are asked as one.
"""

from math import inf
from typing import ClassVar

import pytest

from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ControllerLoadError,
    HardwareInterfaceError,
    ParameterError,
    ResourceConflictError,
    StationError,
    SwitchRefusedError,
)
from station.core.hardware.combined_robot_hw import CombinedRobotHW, CombinedWorld
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionVelocityTorqueGainsJointInterface,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    ResourceConflict,
    RobotHW,
    SwitchState,
)
from station.core.hardware.robot_report import SceneObjectReport
from station.core.parameters import Parameters, ParameterTree
from station.hw.mock import MockRobotHW
from station.testing.scripted import TYPES

EFFORT = EffortJointInterface.type_name


class Failing(RobotHW):
    """Cannot be initialised."""

    def init(self, root_params, hw_params):
        raise OSError("no cable")


def create(robot_type):
    robots = {"mock": MockRobotHW, "failing": Failing}
    if robot_type not in robots:
        raise StationError(f"no robot '{robot_type}'")
    return robots[robot_type]()


def parameters(**robots):
    params = Parameters()
    params.set("robot_hardware", list(robots))
    for name, values in robots.items():
        params.set(name, values)
    return params


@pytest.fixture
def combined():
    robot = CombinedRobotHW(create)
    params = parameters(
        left={"type": "mock", "joints": ["l1", "l2"]},
        right={"type": "mock", "joints": ["r1"]},
    )
    robot.init(params, params)
    return robot


def info(name, *resources, interface=EFFORT):
    claims = (InterfaceResources(interface, resources),) if resources else ()
    return ControllerInfo(name, "test/Type", claims)


def seen(robot):
    return robot.switches[-1]


@pytest.mark.parametrize(
    ("params", "error", "words"),
    [
        (Parameters(), ParameterError, "robot_hardware"),
        (parameters(left={"joints": ["a"]}), ParameterError, "left/type"),
        (parameters(left={"type": "nope"}), StationError, "no robot 'nope'"),
        (parameters(left={"type": "failing"}), HardwareInterfaceError, "no cable"),
        (
            parameters(left={"type": "mock", "joints": ["a", "a"]}),
            ParameterError,
            "left/joints",
        ),
    ],
)
def test_init_refuses_with_the_reason(params, error, words):
    with pytest.raises(error, match=words):
        CombinedRobotHW(create).init(params, params)


def test_robots_before_the_failing_one_stay():
    combined = CombinedRobotHW(create)
    params = parameters(left={"type": "mock"}, right={"type": "failing"})

    with pytest.raises(HardwareInterfaceError):
        combined.init(params, params)

    assert list(combined.robots) == ["left"]


def test_the_addresses_of_the_real_robots_are_told_together(combined, monkeypatch):
    assert combined.address() == ""
    for name, robot in combined.robots.items():
        monkeypatch.setattr(robot, "address", lambda name=name: f"{name}.lab")
    assert combined.address() == "left.lab, right.lab"


def test_handles_of_all_robots_are_reachable(combined):
    interface = combined.get(EffortJointInterface)

    assert interface.get_names() == ["l1", "l2", "r1"]
    assert combined.get(PositionVelocityTorqueGainsJointInterface) is None


def test_reading_and_writing_reach_every_robot(combined):
    combined.do_switch([info("arm", "l1", "r1")], [])
    combined.get(EffortJointInterface).get_handle("r1").set_command(2.0)

    combined.write(0.1, 0.1)
    combined.read(0.2, 0.1)

    assert combined.robots["right"].joints.position[0] > 0.0
    assert combined.get(EffortJointInterface).get_handle("r1").get_position() > 0.0


def test_robot_of_which_a_part_is_real_has_no_simulated_world(combined, monkeypatch):
    assert combined.simulated_world().time() == 0.0
    monkeypatch.setattr(combined.robots["left"], "simulated_world", lambda: None)
    assert combined.simulated_world() is None
    assert CombinedRobotHW(None).simulated_world() is None


def test_every_arm_is_told_to_hold(combined, monkeypatch):
    assert list(combined.hold_commands()) == []
    for name, robot in combined.robots.items():
        monkeypatch.setattr(robot, "hold_commands", lambda name=name: [["hold", name]])

    assert list(combined.hold_commands()) == [["hold", "left"], ["hold", "right"]]


def test_every_robot_sees_its_part_of_the_lists(combined):
    seen_by = {"left": [], "right": []}
    for name, robot in combined.robots.items():
        robot.do_switch = lambda *lists, name=name: seen_by[name].extend(lists[0])
    controllers = [
        info("both", "l2", "r1"),
        info("only_left", "l1"),
        info("no_claims"),
        info("elsewhere", "x9"),
        info("other_interface", "l1", interface="unknown::Interface"),
    ]

    combined.do_switch(controllers, [])

    assert [c.name for c in seen_by["left"]] == ["both", "only_left", "no_claims"]
    assert [c.name for c in seen_by["right"]] == ["both", "no_claims"]
    assert seen_by["left"][0].claimed_resources[0].resources == ("l2",)
    assert seen_by["right"][0].claimed_resources[0].resources == ("r1",)


def test_a_controller_of_unknown_resources_is_shown_to_no_robot(combined):
    asked = []
    for robot in combined.robots.values():
        robot.prepare_switch = lambda *lists: asked.append(lists)

    combined.prepare_switch([info("elsewhere", "x9")], [])

    assert asked == [([], [])] * len(combined.robots)


def test_the_first_robot_that_refuses_ends_the_asking(combined):
    asked = []
    combined.robots["left"].script.refusal = "folded"
    combined.robots["right"].prepare_switch = lambda *lists: asked.append(lists)

    with pytest.raises(SwitchRefusedError, match="folded"):
        combined.prepare_switch([info("both", "l1", "r1")], [])

    assert asked == []


def test_an_exception_of_a_robots_switch_is_passed_on(combined):
    def broken(*_):
        raise RuntimeError("no bus")

    combined.robots["right"].do_switch = broken

    with pytest.raises(RuntimeError, match="no bus"):
        combined.do_switch([info("both", "l1", "r1")], [])


@pytest.mark.parametrize(
    ("left", "right", "together"),
    [
        (SwitchState.DONE, SwitchState.DONE, SwitchState.DONE),
        (SwitchState.DONE, SwitchState.ONGOING, SwitchState.ONGOING),
        (SwitchState.ERROR, SwitchState.ONGOING, SwitchState.ERROR),
    ],
)
def test_the_result_is_that_of_the_slowest_or_worst(combined, left, right, together):
    for robot, state in zip(combined.robots.values(), (left, right), strict=True):
        robot.switch_result = lambda state=state: state
        robot.switch_result_for = lambda _, state=state: state

    assert combined.switch_result() is together
    assert combined.switch_result_for(info("both", "l1", "r1")) is together


def test_the_result_for_a_controller_asks_only_the_robots_it_uses(combined):
    combined.robots["right"].switch_result_for = lambda _: SwitchState.ERROR

    assert combined.switch_result_for(info("one", "l1")) is SwitchState.DONE


def test_the_mode_is_the_first_that_is_not_running(combined):
    assert combined.mode() == "running"

    combined.robots["right"].script.mode = "reflex"

    assert combined.mode() == "reflex"


@pytest.fixture
def manager(combined):
    params = Parameters()
    for name, joints in (("both", ["l1", "r1"]), ("right", ["r1"]), ("bad", ["x"])):
        params.set(name, {"type": "test/Effort", "joints": joints})
    manager = ControllerManager(combined, params, [TableLoader(TYPES)], ManualClock())

    def pump():
        combined.read(0.0, 0.01)
        manager.update(0.0, 0.01)
        combined.write(0.0, 0.01)

    manager.pump = pump
    return manager


def test_the_manager_switches_over_several_robots(manager, combined):
    manager.load_controller("both")
    manager.load_controller("right")
    with pytest.raises(ControllerLoadError, match="'x'"):
        manager.load_controller("bad")

    assert manager.switch_controller(SwitchRequest(["both"])).ok

    assert seen(combined.robots["left"]) == seen(combined.robots["right"])
    with pytest.raises(ResourceConflictError, match="'r1'"):
        manager.switch_controller(SwitchRequest(["right"]))
    assert manager.switch_controller(SwitchRequest(["right"], ["both"])).ok
    assert seen(combined.robots["left"]) == ((), ("both",))


def test_a_slow_robot_makes_the_controller_wait(manager, combined):
    manager.load_controller("both")
    combined.robots["right"].script.switch_cycles = 2

    manager.switch_controller(SwitchRequest(["both"]))

    assert manager.get_controller("both").calls == ["waiting", "waiting", "starting"]


class Choosy(MockRobotHW):
    """Forbids, allows, or breaks as the test says."""

    conflicts: ClassVar[list[ResourceConflict]] = []

    def check_for_conflict(self, controllers):
        return list(self.conflicts)


def test_robots_decide_about_conflicts_over_their_own_resources():
    strict, lenient = Choosy(), Choosy()
    strict.conflicts = [ResourceConflict("a", (), "It may not be moved today.")]
    hw = CombinedRobotHW(lambda _: RobotHW())
    hw.add_robot("lenient", lenient)
    assert hw.check_for_conflict([]) == []

    hw.add_robot("strict", strict)
    hw.add_robot("again", strict)

    assert hw.check_for_conflict([]) == strict.conflicts


def test_a_robot_that_cannot_switch_does_not_keep_others_from_being_told():
    first, second = MockRobotHW(), MockRobotHW()
    hw = CombinedRobotHW(lambda _: RobotHW())
    hw.add_robot("first", first)
    hw.add_robot("second", second)
    first.do_switch = lambda *_: 1 / 0
    info = ControllerInfo("watcher", "test/Watcher", ())

    with pytest.raises(ZeroDivisionError):
        hw.do_switch([info], [])

    assert second.switches == [(("watcher",), ())]


def thing(name: str) -> SceneObjectReport:
    return SceneObjectReport(name, "box", (), (), (), 1.0, "")


@pytest.fixture
def robots():
    made = []
    for joint in ("left", "right"):
        robot = MockRobotHW()
        params = Parameters(ParameterTree({"joints": [joint]}))
        robot.init(params, params)
        made.append(robot)
    return made


@pytest.fixture
def world(robots):
    return CombinedWorld([(robot, robot.simulated_world()) for robot in robots])


def test_reset_puts_every_joint_into_its_own_world(robots, world):
    robots[0].simulated_world().advance(0.5)
    assert world.time() == 0.5

    world.reset({"right": 0.3})

    assert world.time() == 0.0
    assert [robot.joints.position for robot in robots] == [[0.0], [0.3]]


def test_contacts_of_all_worlds_are_told(robots, world, monkeypatch):
    assert world.contacts() == []
    for robot, name in zip(robots, "ab", strict=True):
        monkeypatch.setattr(robot.simulated_world(), "contacts", lambda n=name: [n])
    assert world.contacts() == ["a", "b"]


def test_moving_bases_of_all_worlds_are_told(robots, world, monkeypatch):
    assert world.bases() == []
    for robot, name in zip(robots, "ab", strict=True):
        monkeypatch.setattr(robot.simulated_world(), "bases", lambda n=name: [n])
    assert world.bases() == ["a", "b"]


def test_objects_of_one_name_are_one_object(robots, world, monkeypatch):
    assert world.scene() == []
    for robot, names in zip(robots, ("ab", "bc"), strict=True):
        things = [thing(name) for name in names]
        monkeypatch.setattr(robot.simulated_world(), "scene", lambda t=things: t)

    assert [one.name for one in world.scene()] == ["a", "b", "c"]


def test_station_waits_no_longer_than_every_world_does(robots, world, monkeypatch):
    first, second = (robot.simulated_world() for robot in robots)
    monkeypatch.setattr(first, "longest_period", lambda: 0.02)
    assert world.longest_period() == inf
    monkeypatch.setattr(second, "longest_period", lambda: 0.05)
    assert world.longest_period() == 0.05
