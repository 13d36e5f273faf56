"""Controllers that do what a test says, on the shipped mock robot."""

import threading
from collections.abc import Callable, Sequence

from station.core.clock import Clock, ManualClock
from station.core.control.controller import Controller, ControllerBase
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import Strictness, SwitchRequest, SwitchResult
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW

PERIOD = 0.01


class Scripted(Controller[EffortJointInterface]):
    """Notes every callback and runs what the test has put into `actions`."""

    hardware_interface = EffortJointInterface

    def init(self, interface, params: Parameters) -> None:
        names = params.get_str_list("joints", [])
        self.joints: list[JointHandle] = [interface.get_handle(name) for name in names]
        self.calls: list[str] = []
        self.actions: dict[str, Callable[[], object]] = {}
        if params.has("init_raises"):
            raise RuntimeError(params.get_str("init_raises"))

    def command(self, value: float) -> None:
        """Command all joints."""
        for joint in self.joints:
            joint.set_command(value)

    def _note(self, name: str) -> None:
        self.calls.append(name)
        if name in self.actions:
            self.actions[name]()

    def starting(self, time: float) -> None:
        self._note("starting")

    def update(self, time: float, period: float) -> None:
        self._note("update")

    def stopping(self, time: float) -> None:
        self._note("stopping")

    def waiting(self, time: float) -> None:
        self._note("waiting")

    def aborting(self, time: float) -> None:
        self._note("aborting")


class ScriptedPosition(Scripted):
    """The same over position commands."""

    hardware_interface = PositionJointInterface


class ScriptedVelocity(Scripted):
    """The same over velocity commands."""

    hardware_interface = VelocityJointInterface


TYPES: dict[str, str | type[ControllerBase]] = {
    "test/Effort": Scripted,
    "test/Position": ScriptedPosition,
    "test/Velocity": ScriptedVelocity,
}


class Bench:
    """A mock robot with joints j1, j2, j3, its manager, and a loop by hand."""

    def __init__(self, clock: Clock | None = None) -> None:
        self.clock = clock or ManualClock()
        self.parameters = Parameters()
        self.robot = MockRobotHW()
        self.robot.clock = self.clock
        self.parameters.set("hw/joints", ["j1", "j2", "j3"])
        self.robot.init(self.parameters, self.parameters.namespace("hw"))
        self.manager = ControllerManager(
            self.robot, self.parameters, [TableLoader(TYPES)], self.clock
        )
        self.manager.pump = self.step
        self.time = 0.0

    def step(self, cycles: int = 1) -> None:
        """Run cycles."""
        for _ in range(cycles):
            self.time += PERIOD
            self.robot.read(self.time, PERIOD)
            self.manager.update(self.time, PERIOD)
            self.robot.write(self.time, PERIOD)

    def step_elsewhere(self) -> None:
        """Run one cycle in another thread."""
        thread = threading.Thread(target=self.step)
        thread.start()
        thread.join()

    def load(self, name: str, *joints: str, kind: str = "Effort", **params) -> Scripted:
        """Load a scripted controller over `joints` and return it."""
        self.parameters.set(
            name, {"type": f"test/{kind}", "joints": list(joints), **params}
        )
        self.manager.load_controller(name)
        controller = self.manager.get_controller(name)
        assert isinstance(controller, Scripted)
        return controller

    def switch(
        self,
        start: Sequence[str] = (),
        stop: Sequence[str] = (),
        strictness: Strictness = Strictness.STRICT,
        **rest,
    ) -> SwitchResult:
        """Switch."""
        return self.manager.switch_controller(
            SwitchRequest(start, stop, strictness, **rest)
        )

    def state(self, name: str) -> str:
        """Return the state of a controller in ros_control's word."""
        return self.manager.get_controller(name).state.value

    def fault(self, name: str) -> str:
        """Return why a controller was stopped."""
        return next(
            status.fault
            for status in self.manager.list_controllers()
            if status.name == name
        )
