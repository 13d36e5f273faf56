"""A robot, a loader and controllers that write the trace of the recorded runs."""

from collections.abc import Mapping, Sequence

from typing_extensions import override

from station.core.control.controller import ControllerBase, ControllerState
from station.core.control.controller_loader import ControllerLoader
from station.core.errors import SwitchRefusedError
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    ResourceConflict,
    RobotHW,
    SwitchState,
)
from station.core.parameters import Parameters


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
