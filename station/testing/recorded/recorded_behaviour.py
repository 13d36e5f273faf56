"""Test that the manager behaves like the recorded manager of ros_control.

`controller_manager.json.gz` holds the answers and the calls of ros_control's controller
manager, operation by operation. A robot, a loader and controllers write the same trace.
"""

import gzip
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from typing_extensions import override

from station.core.clock import ManualClock
from station.core.control.controller import ControllerBase, ControllerState
from station.core.control.controller_loader import ControllerLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import Strictness, SwitchRequest
from station.core.errors import StationError, SwitchRefusedError
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    ResourceConflict,
    RobotHW,
    SwitchState,
)
from station.core.parameters import Parameters
from station.testing.recorded.deliberate_differences import WITHOUT_UPDATES

VECTORS = Path(__file__).parent / "controller_manager.json.gz"
PERIOD = 0.01


def _names(infos: Sequence[ControllerInfo]) -> str:
    return f"[{','.join(info.name for info in infos)}]"


class RecordedRobot(RobotHW):
    """Notes every call of a hook in `trace`, and answers with the next scripted result.

    When no scripted result is left, a switch is possible, and done.
    """

    def __init__(self) -> None:
        super().__init__()
        self.trace: list[str] = []
        self.prepare: list[bool] = []
        self.results: list[SwitchState] = []
        self.results_for: dict[str, list[SwitchState]] = {}

    @override
    def check_for_conflict(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        conflicts = super().check_for_conflict(controllers)
        self.trace.append(
            f"hw.checkForConflict{_names(controllers)}={bool(conflicts):d}"
        )
        return conflicts

    @override
    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        answer = self.prepare.pop(0) if self.prepare else True
        lists = f"start={_names(start)} stop={_names(stop)}"
        self.trace.append(f"hw.prepareSwitch {lists} ->{answer:d}")
        if not answer:
            raise SwitchRefusedError("scripted")

    @override
    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        self.trace.append(f"hw.doSwitch start={_names(start)} stop={_names(stop)}")

    @override
    def switch_result(self) -> SwitchState:
        answer = self.results.pop(0) if self.results else SwitchState.DONE
        self.trace.append(f"hw.switchResult()={answer.name}")
        return answer

    @override
    def switch_result_for(self, controller: ControllerInfo) -> SwitchState:
        script = self.results_for.get(controller.name)
        answer = script.pop(0) if script else SwitchState.DONE
        self.trace.append(f"hw.switchResult({controller.name})={answer.name}")
        return answer

    def script_results(self, trace: Sequence[str]) -> None:
        """Set the answers of the hooks to those of a recorded trace."""
        for line in trace:
            if line.startswith("hw.prepareSwitch"):
                self.prepare.append(line.endswith("1"))
            if not line.startswith("hw.switchResult("):
                continue
            name, _, answer = line.removeprefix("hw.switchResult(").partition(")=")
            target = self.results_for.setdefault(name, []) if name else self.results
            target.append(SwitchState[answer])


class RecordedController(ControllerBase):
    """Records every callback."""

    def __init__(self, loader: "RecordedLoader") -> None:
        super().__init__()
        self._trace = loader.robot.trace
        self._definitions = loader.definitions
        self._name = ""

    def __del__(self) -> None:
        if self._name:
            self._trace.append(f"{self._name}.destroyed")

    @override
    def init_request(
        self, hw: RobotHW, params: Parameters
    ) -> tuple[InterfaceResources, ...]:
        self._name = params.path
        self._trace.append(f"{self._name}.init")
        definition = self._definitions[self._name]
        outcome = definition["init"]
        if outcome in {"false", "throw", "throwint"}:
            raise RuntimeError(outcome)
        if outcome == "ok":
            self.state = ControllerState.INITIALIZED
        claims = definition["claims"]
        assert isinstance(claims, dict)
        return tuple(
            InterfaceResources(interface, tuple(sorted(resources)))
            for interface, resources in claims.items()
            if resources
        )

    @override
    def starting(self, time: float) -> None:
        self._trace.append(f"{self._name}.starting")

    @override
    def update(self, time: float, period: float) -> None:
        self._trace.append(f"{self._name}.update")

    @override
    def stopping(self, time: float) -> None:
        self._trace.append(f"{self._name}.stopping")

    @override
    def waiting(self, time: float) -> None:
        self._trace.append(f"{self._name}.waiting")

    @override
    def aborting(self, time: float) -> None:
        self._trace.append(f"{self._name}.aborting")


class RecordedLoader(ControllerLoader):
    """Knows the four types of the recorded runs."""

    def __init__(self, robot: RecordedRobot) -> None:
        super().__init__("probe_base")
        self.robot = robot
        self.definitions: dict[str, Mapping[str, object]] = {}

    @override
    def declared_types(self) -> list[str]:
        return ["probe/Ctl", "probe/Throw", "probe/ThrowLogic", "probe/Null"]

    @override
    def create(self, controller_type: str) -> ControllerBase | None:
        if controller_type in {"probe/Throw", "probe/ThrowLogic"}:
            raise RuntimeError(controller_type)
        return RecordedController(self) if controller_type == "probe/Ctl" else None

    @override
    def reload(self) -> None:
        self.robot.trace.append("loader.reload")


with gzip.open(VECTORS) as _file:
    RECORDED = json.load(_file)


class Replay:
    """Carries out recorded operations and compares the effects.

    Args:
        robot: The robot, which records the calls of its hooks.
        manager_class: Class of the manager.
    """

    def __init__(
        self, robot: RecordedRobot, manager_class: type[ControllerManager]
    ) -> None:
        self.robot = robot
        self.loader = RecordedLoader(self.robot)
        self.parameters = Parameters()
        self.manager = manager_class(
            self.robot, self.parameters, [self.loader], ManualClock()
        )
        self.manager.pump = self.pump
        self.time = 0.0

    def pump(self) -> None:
        """Run one cycle."""
        self.robot.trace.append("-- update --")
        self.time += PERIOD
        self.manager.update(self.time, PERIOD)

    def states(self) -> dict[str, str]:
        """Return the states of the controllers in the words of the recording."""
        return {
            s.name: "constructed" if s.state.value == "unknown" else s.state.value
            for s in self.manager.list_controllers()
        }

    def run(self, op: dict[str, Any]) -> None:
        """Carry out a recorded operation; assert its result, trace and final states."""
        self.robot.trace.clear()
        expected = list(op.get("trace", []))
        self.robot.script_results(expected)
        try:
            result = getattr(self, f"do_{op['op']}")(op)
        except StationError:
            result = False
        if op["op"] in WITHOUT_UPDATES:
            expected = [line for line in expected if line != "-- update --"]
        if op["op"] == "reload_libraries":
            expected = _without_last_update(expected)
        if "result" in op:
            wanted = op["result"]
            assert result == (False if str(wanted).startswith("EXC") else wanted)
        if op["op"] == "switch":
            self.robot.trace[:] = _without_release(self.robot.trace)
        assert self.robot.trace == expected
        if "states" in op:
            assert self.states() == op["states"]

    def do_define(self, op: dict[str, Any]) -> None:
        """Define a controller that a later operation loads."""
        self.loader.definitions[op["name"]] = op
        self.parameters.set(f"{op['name']}/type", op["type_param"])

    def do_load(self, op: dict[str, Any]) -> bool:
        """Load a controller."""
        self.manager.load_controller(op["name"])
        return True

    def do_unload(self, op: dict[str, Any]) -> bool:
        """Unload a controller."""
        self.manager.unload_controller(op["name"])
        return True

    def do_switch(self, op: dict[str, Any]) -> bool:
        """Switch controllers."""
        self.manager.switch_controller(
            SwitchRequest(
                op["start"],
                op["stop"],
                Strictness.from_value(op["strictness"]),
                start_asap=op.get("start_asap", False),
                timeout=op.get("timeout", 0.0),
            )
        )
        return True

    def do_update(self, op: dict[str, Any]) -> None:
        """Run cycles."""
        for _ in range(op["n"]):
            self.robot.trace.append("-- update --")
            self.time += PERIOD
            self.manager.update(self.time, PERIOD, op["reset_controllers"])

    def do_reload_libraries(self, op: dict[str, Any]) -> bool:
        """Reload the libraries of controllers."""
        self.manager.reload_controller_libraries(force_kill=op["force_kill"])
        return True

    def do_list_controllers(self, op: dict[str, Any]) -> None:
        """Compare the list of controllers with the recorded one."""
        listed = [
            {
                "name": status.name,
                "type": status.type,
                "state": status.state.value,
                "claimed_resources": [
                    {
                        "hardware_interface": claim.hardware_interface,
                        "resources": list(claim.resources),
                    }
                    for claim in status.claimed_resources
                ],
            }
            for status in self.manager.list_controllers()
        ]
        assert listed == op["controllers"]

    def do_list_controller_types(self, op: dict[str, Any]) -> None:
        """Compare the list of controller types with the recorded one."""
        listed = [
            {"type": name, "base": base}
            for name, base in self.manager.list_controller_types()
        ]
        assert listed == op["types(probe only)"]


def _without_release(trace: list[str]) -> list[str]:
    """Drop the do_switch that reports aborted starts to the hardware (CM-67)."""
    if not any(line.endswith(".aborting") for line in trace):
        return trace
    return [line for line in trace if not line.startswith("hw.doSwitch start=[] ")]


def _without_last_update(trace: list[str]) -> list[str]:
    """Drop the cycle in which the original waited for an unload."""
    if trace.count("-- update --") < 2:
        return trace
    last = len(trace) - 1 - trace[::-1].index("-- update --")
    return trace[:last] + trace[last + 1 :]


def _id(cell: dict[str, Any]) -> str:
    start, stop = "".join(cell["start"]), "".join(cell["stop"])
    return f"{cell['strictness']}-{cell['shared_joint']:d}-{start}-{stop}"


class RecordedBehaviour:
    """Tests a controller manager and a robot's hooks against ros_control's recording.

    Derive a test class, and name the manager in it that replaces the station's own.

    Attributes:
        robot: Class of the robot; its hooks write the trace that is compared.
        manager: Class of the manager.
    """

    robot: type[RecordedRobot] = RecordedRobot
    manager: type[ControllerManager] = ControllerManager

    def replay(self) -> Replay:
        """Return a replay with a new robot."""
        return Replay(self.robot(), self.manager)

    @pytest.mark.parametrize(
        "scenario", RECORDED["scenarios"], ids=lambda scenario: scenario["scenario"]
    )
    def test_scenario_agrees_with_the_recording(self, scenario: dict[str, Any]) -> None:
        replay = self.replay()
        for op in scenario["ops"]:
            replay.run(op)

    @pytest.mark.parametrize("cell", RECORDED["matrix"], ids=_id)
    def test_matrix_cell_agrees_with_the_recording(self, cell: dict[str, Any]) -> None:
        replay = self.replay()
        effort = "hardware_interface::EffortJointInterface"
        for number, name in enumerate("ABC", 1):
            joint = "j1" if cell["shared_joint"] else f"j{number}"
            op = {"name": name, "init": "ok", "type_param": "probe/Ctl"}
            replay.do_define({**op, "claims": {effort: [joint]}})
            replay.do_load(op)
        strict = {"strictness": 2}
        replay.do_switch({**strict, "start": ["C"], "stop": []})
        replay.do_switch({**strict, "start": [], "stop": ["C"]})
        replay.do_switch({**strict, "start": ["B"], "stop": []})
        replay.run({**cell, "op": "switch"})
