"""The contract of `RobotHW`, which every robot must pass."""

import math
from collections.abc import Callable, Mapping, Sequence

import pytest

from station.core.control.hardware_components import ComponentState
from station.core.errors import StationError
from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    RobotHW,
    SwitchState,
)
from station.testing.bench import Bench


def interfaces(bench: Bench) -> list[HardwareResourceManager[ResourceHandle]]:
    """Return the interfaces that hold handles."""
    found = [bench.robot.get(kind) for kind in bench.robot.interface_types()]
    return [i for i in found if isinstance(i, HardwareResourceManager)]


def commandable(bench: Bench) -> list[tuple[str, list[str]]]:
    """Return the wire name and the resources of every interface with commands."""
    return [
        (interface.type_name, interface.get_names())
        for interface in interfaces(bench)
        if any(handle.command_slots() for handle in interface.handles())
    ]


def joint_states(bench: Bench) -> JointStateInterface:
    """Return the interface with the states of all joints."""
    interface = bench.robot.get(JointStateInterface)
    assert interface is not None, "the robot has no JointStateInterface"
    return interface


def states(bench: Bench) -> list[tuple[float, float, float]]:
    """Return position, velocity and effort of every joint."""
    return [
        (handle.get_position(), handle.get_velocity(), handle.get_effort())
        for handle in joint_states(bench).handles()
    ]


class RobotConformance:
    """Tests that a robot keeps the contract of `RobotHW`.

    Derive a test class, and name the robot and its parameters in it; or override the
    fixture `bench`.

    Attributes:
        robot: Class of the robot.
        parameters: Its parameters.
        root_parameters: Parameters of the root namespace, e.g. `robot_description`.
        joints: Joints that the robot must have; empty accepts the joints that it has.
        impossible: Parameters that the robot must refuse.
        sag: How far a joint may move while no controller runs [rad or m].
    """

    robot: type[RobotHW]
    parameters: Mapping[str, object] = {}
    root_parameters: Mapping[str, object] = {}
    joints: Sequence[str] = ()
    impossible: Mapping[str, object] = {}
    sag = 0.002

    @pytest.fixture
    def make_robot(self) -> Callable[[], RobotHW]:
        """Return a factory of robots that are not yet initialised."""
        return self.robot

    @pytest.fixture
    def bench(self, make_robot: Callable[[], RobotHW]) -> Bench:
        """Return a bench with the robot."""
        return Bench(
            make_robot(), self.parameters, root_parameters=self.root_parameters
        )

    def test_it_offers_joint_states_by_name(self, bench: Bench) -> None:
        names = joint_states(bench).get_names()

        assert names
        assert set(self.joints) <= set(names)

    def test_every_interface_has_a_name_on_the_wire(self, bench: Bench) -> None:
        names = bench.robot.get_names()

        assert len(set(names)) == len(names)
        assert all("::" in name or "." in name for name in names)

    def test_its_states_are_finite_from_the_first_cycle_on(self, bench: Bench) -> None:
        for _ in range(5):
            bench.step()
            assert all(math.isfinite(value) for row in states(bench) for value in row)

    def test_it_holds_still_when_nothing_runs(self, bench: Bench) -> None:
        bench.step()
        before = [row[0] for row in states(bench)]

        bench.step(100)

        after = [row[0] for row in states(bench)]
        assert after == pytest.approx(before, abs=self.sag)

    def test_its_rest_commands_fit_its_handles_and_are_finite(
        self, bench: Bench
    ) -> None:
        bench.step()
        for interface in interfaces(bench):
            for handle in interface.handles():
                slots = handle.command_slots()
                rest = interface.origin(handle.name).rest_commands(handle.name)
                limits = interface.origin(handle.name).start_jump_limits(handle.name)
                assert len(rest) == len(limits) == len(slots)
                assert all(math.isfinite(value) for value in rest)
                assert all(limit > 0.0 for limit in limits)

    def test_reading_does_not_change_commands(self, bench: Bench) -> None:
        bench.step()
        before = bench.commands()

        bench.robot.read(bench.time, bench.period)

        assert bench.commands() == before

    def test_every_command_interface_can_be_switched_to_and_off_again(
        self, bench: Bench
    ) -> None:
        bench.step()
        joints = self.joints or joint_states(bench).get_names()
        for type_name, resources in commandable(bench):
            if not type_name.endswith("JointInterface"):
                continue
            names = tuple(r for r in resources if r in joints)
            info = ControllerInfo(
                "it", "test/Type", (InterfaceResources(type_name, names),)
            )
            bench.robot.prepare_switch([info], [])
            bench.robot.do_switch([info], [])
            for _ in range(50):
                bench.step()
                if bench.robot.switch_result_for(info) is SwitchState.DONE:
                    break
            assert bench.robot.switch_result_for(info) is SwitchState.DONE
            bench.robot.do_switch([], [info])
            bench.step()
        assert all(math.isfinite(value) for row in states(bench) for value in row)

    def test_a_failed_controller_can_be_taken_off_without_preparation(
        self, bench: Bench
    ) -> None:
        bench.step()
        info = ControllerInfo("it", "test/Type", ())

        bench.robot.do_switch([], [info])
        bench.step()

    def test_an_empty_switch_is_fine(self, bench: Bench) -> None:
        bench.robot.prepare_switch([], [])
        bench.robot.do_switch([], [])

        assert bench.robot.switch_result() is SwitchState.DONE

    def test_a_cycle_may_take_no_time_or_long(self, bench: Bench) -> None:
        for period in (0.0, 0.02, bench.period):
            bench.robot.read(bench.time, period)
            bench.robot.write(bench.time, period)

        assert all(math.isfinite(value) for row in states(bench) for value in row)

    def test_its_components_go_through_their_states(self, bench: Bench) -> None:
        """Switch off, clean up and activate each component, while cycles go on."""
        manager = bench.manager
        components = manager.hardware_components()
        assert components
        for one in components:
            for state in ("inactive", "unconfigured", "inactive", "active"):
                manager.set_hardware_component_state(one.name, ComponentState(state))
                bench.step(3)
        assert {one.state for one in manager.hardware_components()} == {"active"}
        assert all(math.isfinite(v) for values in states(bench) for v in values)

    def test_its_mode_is_one_word(self, bench: Bench) -> None:
        bench.step()

        assert bench.robot.mode()
        assert " " not in bench.robot.mode()

    def test_impossible_parameters_are_refused_with_a_reason(
        self, bench: Bench, make_robot: Callable[[], RobotHW]
    ) -> None:
        if not self.impossible:
            pytest.skip("no impossible parameters are known")
        robot = make_robot()
        params = bench.parameters.namespace("wrong")
        params.set("", dict(self.impossible))

        with pytest.raises(StationError) as caught:
            robot.init(bench.parameters, params)

        assert "wrong/" in caught.value.message
