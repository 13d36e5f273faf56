"""A configuration becomes a station whose controllers are loaded."""

import sys
import threading

import pytest
from typing_extensions import override

from station.app.composition import compose
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.controller import Controller
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ControllerModuleRefusedError,
    HardwareInterfaceError,
    ParameterError,
    StationError,
)
from station.core.hardware.interfaces import (
    JointStateInterface,
    PositionJointInterface,
)
from station.core.loop.heartbeat import Heartbeat
from tests.app.mass_hw import TYPE
from tests.waiting import PATIENCE

GROUP = "position_controllers/JointGroupPositionController"


def configure(tmp_path, controllers: str, start: str = "[]", robot: str = ""):
    path = tmp_path / "station.yaml"
    path.write_text(
        f"robot: {{type: '{TYPE}', {robot}}}\n"
        f"controllers: {{{controllers}}}\nstart: {start}\nstation: {{rate: 500}}"
    )
    return load_config(path)


def test_parts_are_built_as_configured(tmp_path):
    config = configure(tmp_path, f"arm: {{type: {GROUP}, joints: [joint1]}}")

    station = compose(config, ManualClock()).station

    assert station.joint_names == ["joint1"]
    assert station.loop.period == 0.002
    assert [(c.name, c.type) for c in station.controllers()] == [("arm", GROUP)]
    assert station.status().robot_type == TYPE


def test_robot_gets_its_parameters(tmp_path):
    config = configure(tmp_path, "", robot="start: 0.5")

    station = compose(config, ManualClock()).station
    station.loop.step()

    assert station.latest().position == [0.5]


def test_parameters_stay_in_the_tree(tmp_path):
    config = configure(tmp_path, "ns: {arm: {type: a/B, p: 1}, joint_limits: {x: 1}}")

    parameters = compose(config, ManualClock()).station.parameters

    assert parameters.get("arm/p") == 1
    assert parameters.get("joint_limits/x") == 1
    assert parameters.get("robot/type") == TYPE


@pytest.mark.parametrize("name", ["robot", "scene", "robot_description"])
def test_a_controller_never_takes_the_place_of_the_stations_parameters(tmp_path, name):
    station = compose(configure(tmp_path, ""), ManualClock()).station
    before = station.parameters.get(name, None)

    with pytest.raises(ParameterError, match="no controller's"):
        station.load_controller(name, GROUP, {"joints": ["joint1"]})

    assert station.parameters.get(name, None) == before


def test_the_description_may_change_while_the_station_runs(tmp_path):
    server = compose(configure(tmp_path, ""), ManualClock()).station.parameter_server

    server.set("robot_description", "<robot/>")

    assert server.get("robot_description") == "<robot/>"
    with pytest.raises(ParameterError, match="while the station runs"):
        server.set("robot/type", "other")


def test_controller_that_cannot_be_loaded_is_left_out(tmp_path):
    config = configure(
        tmp_path, f"arm: {{type: {GROUP}, joints: [joint1]}}, odd: {{type: no/Such}}"
    )

    composition = compose(config, ManualClock())

    assert [c.name for c in composition.station.controllers()] == ["arm"]
    assert "no/Such" in str(composition.not_loaded["odd"])


def test_unknown_parameters_are_refused_or_in_files_of_ros_told(tmp_path):
    arm = f"{{type: {GROUP}, joints: [joint1], comand_timeout: 1}}"
    ros = tmp_path / "ros.yaml"
    ros.write_text(f"told: {arm}")
    own = tmp_path / "own.yaml"
    own.write_text(f"robot: {{type: {TYPE}}}\ncontrollers: {{refused: {arm}}}")

    composition = compose(load_config(own, controller_files=[ros]), ManualClock())

    refused, told = composition.warnings()
    assert refused.startswith("Controller 'refused' is not loaded")
    assert told.startswith(
        "Controller 'told': The parameter 'comand_timeout' is unknown"
    )
    assert [c.name for c in composition.station.controllers()] == ["told"]


@pytest.mark.parametrize(("rate", "told"), [(500, False), (1000, True)])
def test_another_rate_in_a_file_of_ros2_is_told(tmp_path, rate, told):
    configure(tmp_path, "")
    ros = tmp_path / "ros2.yaml"
    ros.write_text(f"controller_manager: {{ros__parameters: {{update_rate: {rate}}}}}")
    config = load_config(tmp_path / "station.yaml", controller_files=[ros])

    warnings = compose(config, ManualClock()).warnings()

    assert ["loop runs at 500 Hz" in each for each in warnings] == [True] * told


def test_controller_to_be_started_must_load(tmp_path):
    config = configure(tmp_path, "odd: {type: no/Such}", start="[odd]")

    with pytest.raises(StationError, match="no/Such"):
        compose(config, ManualClock())


def test_impossible_parameter_of_the_robot_is_refused(tmp_path):
    config = configure(tmp_path, "", robot="start: here")

    with pytest.raises(ParameterError, match="'robot/start' is 'here'"):
        compose(config, ManualClock())


def test_a_rate_that_the_robot_cannot_follow_is_refused_at_the_start(tmp_path):
    path = tmp_path / "station.yaml"
    path.write_text("station: {rate: 2000}")

    with pytest.raises(HardwareInterfaceError, match="2000 Hz"):
        compose(load_config(path), ManualClock())


def test_the_default_configuration_has_trajectory_controllers_ready():
    station = compose(load_config(), ManualClock()).station

    states = {c.type: c.state.value for c in station.controllers()}
    assert states["effort_controllers/JointTrajectoryController"] == "initialized"
    assert states["position_controllers/JointTrajectoryController"] == "initialized"


class TakesTwoPeriods(Controller[PositionJointInterface]):
    """Every update takes twice as long as the period of the loop."""

    hardware_interface = PositionJointInterface
    clock = ManualClock()

    @override
    def init(self, interface, params):
        interface.get_handle("joint1")

    @override
    def update(self, time, period):
        self.clock.advance(0.004)


class HasNoHurry(Controller[JointStateInterface]):
    """Counts its updates."""

    hardware_interface = JointStateInterface

    @override
    def init(self, interface, params):
        self.updates = 0
        self.enough = threading.Event()

    @override
    def update(self, time, period):
        self.updates += 1
        if self.updates > 150:
            self.enough.set()


def test_a_controller_over_its_budget_is_stopped_while_others_go_on(
    tmp_path,
):
    config = configure(
        tmp_path,
        f"slow: {{type: '{__name__}:TakesTwoPeriods'}},"
        f"quick: {{type: '{__name__}:HasNoHurry'}}",
    )
    station = compose(config, ManualClock()).station
    station.manager.controller_update.stopwatch = TakesTwoPeriods.clock.now

    station.switch_controllers(SwitchRequest(start=["slow", "quick"]))
    station.loop.start()
    assert station.manager.get_controller("quick").enough.wait(PATIENCE)
    states = {c.name: (c.state.value, c.fault) for c in station.controllers()}
    station.loop.stop()

    assert states["slow"][0] == "aborted"
    assert "update took 4 ms, 100 in a row" in states["slow"][1]
    assert "at most 2 ms" in states["slow"][1]
    assert states["quick"] == ("running", None)


def test_only_modules_that_the_configuration_names_are_imported(tmp_path):
    config = configure(tmp_path, f"quick: {{type: '{__name__}:HasNoHurry'}}")
    station = compose(config, ManualClock()).station

    station.load_controller("again", f"{__name__}:HasNoHurry")
    with pytest.raises(ControllerModuleRefusedError, match="'antigravity'"):
        station.load_controller("joke", "antigravity:Any")

    assert "antigravity" not in sys.modules


def test_an_envelope_of_agents_holds_joints_that_there_are(tmp_path):
    path = tmp_path / "station.yaml"
    path.write_text(
        f"robot: {{type: '{TYPE}'}}\ncontrollers: {{}}\n"
        "agents: {envelope: {joints: {joint1: [-1, 1], joint_1: [-1, 1]}}}"
    )

    with pytest.raises(StationError, match=r"names \['joint_1'\]; .* has \['joint1'\]"):
        compose(load_config(path), ManualClock())


def test_every_step_is_announced_before_it_is_done(tmp_path):
    config = configure(
        tmp_path, f"arm: {{type: {GROUP}, joints: [joint1]}}, odd: {{type: no/Such}}"
    )
    steps = []

    compose(config, ManualClock(), announce=steps.append)

    assert steps == [
        f"Building the robot {TYPE}",
        "Loading the controller 'arm'",
        "Loading the controller 'odd'",
    ]


def test_the_loop_shares_the_heartbeat_it_is_given(tmp_path):
    heartbeat = Heartbeat()

    station = compose(
        configure(tmp_path, ""), ManualClock(), heartbeat=heartbeat
    ).station

    assert station.loop.heartbeat is heartbeat


def test_controllers_wait_for_hardware_that_does_not_begin_active():
    states = {"type": "joint_state_controller/JointStateController", "publish_rate": 50}
    config = load_config({
        "robot": {"type": "mock_hw/MockRobotHW"},
        "controllers": {
            "arm": {"type": GROUP, "joints": ["joint1"]},
            "states": states,
        },
        "start": ["arm", "states"],
        "station": {"hardware_components_initial_state": {"inactive": ["robot"]}},
    })

    start, (warning,) = compose(config, ManualClock()).sort_starts(config.start)

    assert start == ["states"]
    assert "'arm' is not started" in warning
    assert "'robot', which is inactive" in warning


PID = (
    "{{type: pid_controller/PidController, dof_names: [{0}], "
    "reference_and_state_dof_names: [joint1], command_interface: position, "
    "reference_and_state_interfaces: [position], gains: {{'{0}': {{}}}}}}"
)


def test_controllers_of_a_chain_are_loaded_in_any_order(tmp_path):
    upper = "top: {type: " + GROUP + ", joints: [middle/joint1]}, "
    middle = "middle: " + PID.format("last/joint1") + ", "
    config = configure(tmp_path, upper + middle + "last: " + PID.format("joint1"))

    composed = compose(config, ManualClock())

    assert composed.not_loaded == {}
    names = [each.name for each in composed.station.controllers()]
    assert names == ["top", "middle", "last"]


def test_a_circle_of_controllers_is_left_out_with_its_reason(tmp_path):
    ring = "a: " + PID.format("b/joint1") + ", b: " + PID.format("a/joint1")
    config = configure(tmp_path, ring)

    composed = compose(config, ManualClock())

    assert set(composed.not_loaded) == {"a", "b"}
    assert "'b/joint1'" in composed.not_loaded["a"].message
