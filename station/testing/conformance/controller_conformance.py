"""The contract of `ControllerBase`, which every controller must pass."""

import math
from collections.abc import Mapping
from typing import Protocol

import pytest

from station.core.control.controller import ControllerBase, ControllerStatus
from station.core.control.switching import SwitchResult
from station.core.errors import StationError
from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.ports.set_point import SetPointPort
from station.hw.mock import MockRobotHW
from station.testing.bench import Bench

NAME = "it"
"""The name under which the controller is loaded."""


class LoadController(Protocol):
    """Returns a bench on which the controller is loaded as `NAME`."""

    def __call__(self, **more: object) -> Bench:
        """Load the controller with more parameters."""


def controller_of(bench: Bench) -> ControllerBase:
    """Return the controller."""
    return bench.manager.get_controller(NAME)


def set_points_of(bench: Bench) -> SetPointPort:
    """Return the port of the controller's set-points."""
    port = controller_of(bench).set_points
    assert port is not None
    return port


def start(bench: Bench) -> SwitchResult:
    """Start the controller."""
    return bench.switch([NAME])


def stop(bench: Bench) -> SwitchResult:
    """Stop the controller."""
    return bench.switch([], [NAME])


def status(bench: Bench) -> ControllerStatus:
    """Return the status of the controller."""
    return bench.status(NAME)


def positions(bench: Bench) -> dict[str, float]:
    """Return the positions of all joints by name."""
    interface = bench.robot.get(JointStateInterface)
    handles = [] if interface is None else interface.handles()
    return {handle.name: handle.get_position() for handle in handles}


def let_pass(bench: Bench, duration: float) -> None:
    """Let wall time pass [s], without running cycles."""
    bench.clock.sleep_until(bench.clock.now() + duration)


class ControllerConformance:
    """Tests that a controller keeps the contract of `ControllerBase`.

    Derive a test class, and name the controller and its parameters in it.

    Attributes:
        controller: Class of the controller, or its type.
        parameters: Its parameters.
        robot: Class of the robot on which it runs.
        robot_parameters: Parameters of the robot.
        root_parameters: Parameters of the root namespace, e.g. `robot_description`.
        obeys_command_timeout: Whether the controller has the parameters
            `command_timeout` and `command_timeout_action`.
        sag: How far a joint may move after the start of the controller [rad or m].
    """

    controller: str | type[ControllerBase]
    parameters: Mapping[str, object] = {}
    robot: type[RobotHW] = MockRobotHW
    robot_parameters: Mapping[str, object] = {}
    root_parameters: Mapping[str, object] = {}
    obeys_command_timeout = False
    sag = 0.002

    def make_robot_bench(self) -> Bench:
        """Return a bench with the robot and without controllers."""
        return Bench(
            self.robot(), self.robot_parameters, root_parameters=self.root_parameters
        )

    def resting_set_point(self, bench: Bench) -> list[float]:
        """Return a set-point at which the robot hardly moves.

        For an element with the name and the unit of a joint this is the joint's
        position, for every other element 0.
        """
        now = positions(bench)
        return [
            now[element.name]
            if element.unit in {"rad", "m"} and element.name in now
            else min(max(0.0, element.minimum), element.maximum)
            for element in set_points_of(bench).elements
        ]

    @pytest.fixture
    def load(self) -> LoadController:
        """Return a function that loads the controller on a new bench."""

        def load(**more: object) -> Bench:
            bench = self.make_robot_bench()
            bench.load_controller(NAME, self.controller, **{**self.parameters, **more})
            return bench

        return load

    @pytest.fixture
    def bench(self, load: LoadController) -> Bench:
        """Return a bench on which the controller is loaded."""
        return load()

    def needs_command_timeout(self, bench: Bench) -> None:
        """Skip a test of timeouts if the controller has no timeout of set-points."""
        if not self.obeys_command_timeout or controller_of(bench).set_points is None:
            pytest.skip("has no timeout of set-points")

    def test_it_claims_resources_the_robot_has(self, bench: Bench) -> None:
        for claim in status(bench).claimed_resources:
            known = bench.robot.get_interface_resources(claim.hardware_interface)
            assert set(claim.resources) <= set(known)

    def test_it_starts_without_a_jump_and_lets_the_robot_rest(
        self, bench: Bench
    ) -> None:
        bench.step()
        before = positions(bench)

        result = start(bench)
        bench.step(50)

        assert result.ok
        assert status(bench).fault is None
        assert status(bench).state.value == "running"
        assert max(result.jump.values(), default=0.0) < 1e-6
        assert positions(bench) == pytest.approx(before, abs=self.sag)

    def test_its_commands_are_finite(self, bench: Bench) -> None:
        start(bench)

        for _ in range(50):
            bench.step()
            assert all(math.isfinite(command) for command in bench.commands())

    def test_it_stops_and_starts_again_and_again(self, bench: Bench) -> None:
        for _ in range(3):
            assert start(bench).ok
            bench.step(3)
            assert stop(bench).ok
            assert status(bench).state.value == "stopped"
        assert status(bench).fault is None

    def test_it_survives_a_reset_while_it_runs(self, bench: Bench) -> None:
        start(bench)
        bench.step(3)

        bench.manager.update(bench.time, bench.period, reset_controllers=True)
        bench.step(3)

        assert status(bench).state.value == "running"

    @pytest.mark.parametrize("period", [0.0, 0.02])
    def test_it_survives_a_cycle_of_another_length(
        self, bench: Bench, period: float
    ) -> None:
        start(bench)
        bench.step(3)

        bench.manager.update(bench.time + period, period)

        assert status(bench).fault is None
        assert all(math.isfinite(command) for command in bench.commands())

    def test_its_gains_fit_their_schema_and_can_be_set_again(
        self, bench: Bench
    ) -> None:
        tunables = controller_of(bench).tunables
        gains, schema = tunables.values, tunables.schema

        assert set(gains) == set(schema)
        for name, value in gains.items():
            assert schema[name].minimum <= value <= schema[name].maximum
        tunables.apply(tunables.checked(gains))
        assert tunables.values == gains

    def test_its_set_point_has_names_units_and_ranges(self, bench: Bench) -> None:
        port = controller_of(bench).set_points
        if port is None:
            pytest.skip("takes no set-points")

        for element in port.elements:
            assert element.name
            assert element.minimum < element.maximum
        with pytest.raises(StationError):
            port.check([0.0] * (len(port.elements) + 1))
        with pytest.raises(StationError):
            port.check([math.nan] * len(port.elements))

    def test_its_sample_has_one_number_per_joint(self, bench: Bench) -> None:
        controller = controller_of(bench)
        start(bench)
        bench.step(100)
        if controller.sample is None:
            pytest.skip("leaves no samples")

        size = len(controller.joint_names)
        assert all(len(values) == size for values in controller.sample.columns)
        assert controller.sample.stamp <= bench.time

    def test_it_never_makes_a_command_of_a_sensor_that_reads_nan(
        self, bench: Bench
    ) -> None:
        if not isinstance(bench.robot, MockRobotHW):
            pytest.skip("runs on a robot whose sensors do not fail")
        start(bench)
        bench.step(3)
        bench.robot.script.nan_sensors = set(bench.robot.joint_names)

        for _ in range(3):
            bench.step()
            assert all(math.isfinite(command) for command in bench.commands())

        assert status(bench).state.value in {"running", "aborted"}

    def test_without_parameters_it_is_refused_with_a_reason_or_works(self) -> None:
        bench = self.make_robot_bench()

        try:
            bench.load_controller(NAME, self.controller)
        except StationError:
            assert bench.manager.list_controllers() == []
        else:
            assert start(bench).ok

    def test_a_set_point_times_out_on_the_wall_clock_while_simulated_time_stands(
        self, load: LoadController
    ) -> None:
        bench = load(command_timeout=0.2)
        self.needs_command_timeout(bench)
        start(bench)
        bench.step(3)
        port = set_points_of(bench)
        values = self.resting_set_point(bench)
        port.check(values)
        port.post(values)
        bench.pause(3)
        assert port.last == pytest.approx(values)
        taken = port.last
        let_pass(bench, 0.19)
        bench.pause()
        assert port.last is taken

        let_pass(bench, 0.02)
        bench.pause()

        assert port.last is not taken
        assert status(bench).state.value == "running"

    def test_a_timeout_can_stop_the_controller_also_while_simulated_time_stands(
        self, load: LoadController
    ) -> None:
        bench = load(command_timeout=0.2, command_timeout_action="stop")
        self.needs_command_timeout(bench)
        start(bench)
        bench.step(3)
        port = set_points_of(bench)
        port.post(self.resting_set_point(bench))
        bench.pause(3)
        assert status(bench).state.value == "running"

        let_pass(bench, 0.21)
        bench.pause()

        assert status(bench).state.value != "running"
        assert "arrived in time" in str(status(bench).fault)
