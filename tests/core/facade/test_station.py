"""The facade: whole or not at all, from any thread.

Interfaces, and who claims what.
"""

import pytest

from station.core.clock import ManualClock
from station.core.control.controller import (
    Controller,
    ControllerState,
    ControllerStatus,
)
from station.core.control.controller_loader import ControllerLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.control.tunables import Tunable, Tunables
from station.core.errors import (
    ControllerExistsError,
    ControllerNotFoundError,
    ControllerStateError,
    ControllerTypeNotFoundError,
    GainsChangedError,
    InvalidCommandError,
    InvalidGainError,
    LoopError,
    ParameterError,
    StaleEpochError,
    StoppedError,
)
from station.core.facade.station import Station, report_hardware
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
)
from station.core.hardware.robot_hw import InterfaceResources, RobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.loop.stop_latch import StopState
from station.core.parameters import Parameters, ParameterTree
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.hw.mock import MockRobotHW
from station.hw.robot_loader import CombinedRobotHW
from station.reports import Percentiles
from tests.waiting import PATIENCE


class Spring(Controller[EffortJointInterface]):
    """Pulls one joint to a set-point with a stiffness that can be tuned."""

    hardware_interface = EffortJointInterface

    def init(self, interface, params):
        self.joint = interface.get_handle(params.get_str("joint"))
        self.tunables = Tunables(
            {"k": Tunable("Nm/rad", 0.0, 10.0)}, {"k": params.get_float("k", 1.0)}
        )
        self.target = 0.0
        self.set_points = SetPointPort([SetPointElement("j", "rad", -1.0, 1.0)])

    def starting(self, time):
        self.target = self.joint.get_position()

    def update(self, time, period):
        command = self.set_points.take()
        if command is not None:
            self.target = command[0]
        self.joint.set_command(
            self.tunables.values["k"] * (self.target - self.joint.get_position())
        )


class SpringLoader(ControllerLoader):
    """Knows the spring and nothing else."""

    def declared_types(self):
        return ["test/Spring"]

    def create(self, controller_type):
        return Spring() if controller_type == "test/Spring" else None


class OneJoint(RobotHW):
    """One joint under effort control."""

    def __init__(self):
        super().__init__()
        self.effort_command = [0.0]
        state = JointStateHandle("j", [0.0], [0.0], [0.0])
        states, efforts = JointStateInterface(), EffortJointInterface()
        states.register_handle(state)
        efforts.register_handle(JointHandle(state, self.effort_command))
        self.register_interface(states)
        self.register_interface(efforts)


@pytest.fixture
def station() -> Station:
    hw, clock, parameters = OneJoint(), ManualClock(), Parameters()
    manager = ControllerManager(hw, parameters, [SpringLoader()], clock)
    loop = ControlLoop(hw, manager, clock=clock)
    return Station(loop, manager, parameters, "test/OneJoint", frozenset({"robot"}))


@pytest.fixture
def running(station: Station) -> Station:
    station.load_controller("spring", "test/Spring", {"joint": "j", "k": 2.0})
    station.switch_controllers(SwitchRequest(start=("spring",)))
    return station


def test_loading_the_same_twice_is_the_same_as_once(station):
    first = station.load_controller("spring", "test/Spring", {"joint": "j"})
    second = station.load_controller("spring", "test/Spring", {"joint": "j"})
    assert first == second
    assert len(station.controllers()) == 1


def test_loading_something_else_under_a_used_name_is_refused(station):
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    with pytest.raises(ControllerExistsError, match="'spring'"):
        station.load_controller("spring", "test/Spring", {"joint": "j", "k": 3.0})
    assert station.tuning.gains("spring").values == {"k": 1.0}


def test_a_failed_load_leaves_the_parameters_as_they_were(station):
    with pytest.raises(ControllerTypeNotFoundError):
        station.load_controller("a", "test/Nothing", {})
    with pytest.raises(ParameterError):
        station.load_controller("a", "test/Spring", {})
    assert station.parameters.get("a") is None
    assert station.controllers() == []


@pytest.mark.parametrize("name", ["robot", "robot_description"])
def test_a_controller_never_takes_the_place_of_other_parameters(station, name):
    station.parameters.set("robot_description", "<robot/>")
    station.parameters.set("robot", {"type": "test/OneJoint"})
    before = station.parameters.get(name)

    with pytest.raises(ParameterError, match="no controller's"):
        station.load_controller(name, "test/Spring", {"joint": "j"})

    assert station.parameters.get(name) == before


def test_a_controller_without_a_type_is_refused(station):
    with pytest.raises(ParameterError, match="has no type"):
        station.load_controller("a")


def test_a_misspelt_controller_without_a_type_is_told_with_those_configured(station):
    station.parameters.set("robot", {"type": "test/OneJoint"})
    station.parameters.set("sprung", {"type": "test/Spring", "joint": "j"})

    with pytest.raises(ParameterError, match="'sprnug' has no type") as caught:
        station.load_controller("sprnug")
    assert caught.value.remedy.endswith("a configured controller. There are: sprung.")


def test_a_set_point_reaches_the_robot_in_the_next_cycle(running):
    assert running.motion.set_command("spring", [0.5]) == running.epoch
    running.loop.step()
    assert running.loop.hw.effort_command == [1.0]
    assert running.motion.set_point("spring").values == (0.5,)


@pytest.mark.parametrize("values", [[], [0.1, 0.2], [float("nan")], [1.5]])
def test_a_malformed_set_point_is_refused_and_changes_nothing(running, values):
    with pytest.raises(InvalidCommandError):
        running.motion.set_command("spring", values)
    running.loop.step()
    assert running.loop.hw.effort_command == [0.0]


def test_a_set_point_for_a_controller_that_does_not_run_is_refused(station):
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    with pytest.raises(ControllerStateError, match="is initialized"):
        station.motion.set_command("spring", [0.5])


def test_a_set_point_of_an_older_epoch_is_void(running):
    epoch = running.epoch
    running.stop("test")
    running.release_stop(arm=False)
    running.release_stop(arm=True)
    running.switch_controllers(SwitchRequest(start=("spring",)))
    with pytest.raises(StaleEpochError, match=f"epoch {epoch}"):
        running.motion.set_command("spring", [0.5], epoch)


def test_unknown_controllers_are_named(station):
    for call in (station.tuning.gains, station.controller, station.motion.set_point):
        with pytest.raises(ControllerNotFoundError, match="nobody"):
            call("nobody")


def test_gains_change_as_a_whole_and_count_revisions(running):
    before = running.tuning.gains("spring")
    change = running.tuning.set_gains("spring", {"k": 4.0}, before.revision)
    assert change.previous == {"k": 2.0}
    assert running.tuning.gains("spring").values == {"k": 4.0}
    assert running.tuning.gains("spring").revision == change.revision > before.revision


def test_gains_read_before_somebody_elses_change_are_refused(running):
    revision = running.tuning.gains("spring").revision
    running.tuning.set_gains("spring", {"k": 4.0})
    with pytest.raises(GainsChangedError):
        running.tuning.set_gains("spring", {"k": 5.0}, revision)
    assert running.tuning.gains("spring").values == {"k": 4.0}


@pytest.mark.parametrize("value", [float("nan"), -1.0, 11.0, float("inf"), True])
def test_an_impossible_gain_is_refused_and_changes_nothing(running, value):
    with pytest.raises(InvalidGainError, match="'k'"):
        running.tuning.set_gains("spring", {"k": value})
    assert running.tuning.gains("spring").values == {"k": 2.0}


def test_a_stop_stops_the_controllers_and_refuses_motion(running):
    running.stop("test")
    assert running.controller("spring").state is ControllerState.STOPPED
    assert running.status().stop_state is StopState.STOPPED
    with pytest.raises(StoppedError):
        running.motion.set_command("spring", [0.5])
    with pytest.raises(StoppedError):
        running.switch_controllers(SwitchRequest(start=("spring",)))


def test_nothing_resumes_by_itself_after_a_stop(running):
    running.stop("test")
    running.release_stop(arm=False)
    running.release_stop(arm=True)
    running.loop.step(3)
    assert running.controller("spring").state is ControllerState.STOPPED


def test_a_release_waits_for_the_stop_to_be_carried_out(running):
    latch, clock = running.loop.stop_latch, running.loop.clock
    latch.engage("test")
    sleep = clock.sleep_until

    def sleep_until(deadline):
        sleep(deadline)
        running.loop.control_cycle.carry_out_stop()

    clock.sleep_until = sleep_until
    assert running.release_stop(arm=False) is StopState.RELEASED


def test_a_stop_that_nobody_carries_out_cannot_be_released(running):
    running.loop.stop_latch.engage("test")
    with pytest.raises(StoppedError, match="not carried out"):
        running.release_stop(arm=False)


def _die(station):
    def fail(*_):
        raise RuntimeError("the cable is out")

    station.loop.hw.read = fail
    station.loop.start()
    station.loop._thread.join(PATIENCE)


@pytest.mark.parametrize(
    "ask",
    [
        lambda station: station.motion.set_command("spring", [0.5]),
        lambda station: station.tuning.set_gains("spring", {"k": 1.0}),
        lambda station: station.switch_controllers(SwitchRequest(start=("spring",))),
        lambda station: station.switch_controllers(SwitchRequest(stop=("spring",))),
        lambda station: station.loop.reset_statistics(),
        lambda station: station.reset_statistics(),
    ],
)
def test_a_dead_loop_refuses_everything_that_needs_it_and_says_why(running, ask):
    _die(running)
    with pytest.raises(LoopError, match="the cable is out"):
        ask(running)
    running.loop.stop()


def test_a_dead_loop_looks_dead(running):
    _die(running)
    assert running.controller("spring").state is ControllerState.STOPPED
    assert "the cable is out" in running.ready()
    assert running.dead().startswith("The control loop died")
    running.loop.stop()


def test_a_dead_loop_can_still_be_stopped_and_released(running):
    _die(running)
    running.stop("test")
    assert running.status().stop_state is StopState.STOPPED
    assert running.release_stop(arm=False) is StopState.RELEASED
    running.loop.stop()


def test_a_station_without_a_running_loop_is_not_ready_and_says_why(station):
    assert "not running" in station.ready()


EFFORT = "hardware_interface::EffortJointInterface"


def make_robot() -> MockRobotHW:
    robot = MockRobotHW()
    robot.init(Parameters(), Parameters())
    return robot


def controller(name: str, state: ControllerState, *joints: str) -> ControllerStatus:
    claims = (InterfaceResources(EFFORT, joints),)
    time = Percentiles(0.0, 0.0, 0.0, 0.0, 0)
    return ControllerStatus(name, "test/C", state, claims, None, None, (), time)


def test_running_controllers_claim_and_others_do_not():
    report = report_hardware(
        make_robot(),
        [
            controller("arm", ControllerState.RUNNING, "joint1"),
            controller("idle", ControllerState.STOPPED, "joint2"),
        ],
    )
    (found,) = [i for i in report.interfaces if i.name == EFFORT]
    assert [(r.name, r.claimed_by) for r in found.resources] == [
        ("joint1", ("arm",)),
        ("joint2", ()),
    ]


def test_robot_without_limits_tells_none():
    report = report_hardware(make_robot(), [])
    assert (report.limits, report.transmissions, report.clamps) == ((), (), ())


def test_combined_robot_tells_what_its_robots_tell():
    robot = {
        "robot_hardware": ["left", "right"],
        "left": {"type": "mock_hw/MockRobotHW", "joints": ["l"]},
        "right": {
            "type": "mujoco_hw/MujocoRobotHW",
            "robot_description": "example-robot-data:ur5",
            "floor": False,
        },
    }
    tree = ParameterTree({"robot": robot})
    hw = CombinedRobotHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    report = report_hardware(hw, [])
    assert [limits.joint for limits in report.limits][:2] == [
        "shoulder_pan_joint",
        "shoulder_lift_joint",
    ]
    assert len(report.transmissions) == 6
    (found,) = [i for i in report.interfaces if i.name == EFFORT]
    assert "l" in [r.name for r in found.resources]
