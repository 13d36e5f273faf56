"""A robot and its controller manager, stepped by hand, for tests without threads."""

from collections.abc import Mapping, Sequence

from station.controllers import CONTROLLERS
from station.core.clock import Clock, ManualClock
from station.core.control.controller import ControllerBase, ControllerStatus
from station.core.control.controller_loader import (
    ControllerLoader,
    TableLoader,
    default_loaders,
)
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import (
    SWITCH_BOUND,
    Strictness,
    SwitchRequest,
    SwitchResult,
)
from station.core.facade.station import Station
from station.core.hardware.interfaces.resource_manager import HardwareResourceManager
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW


class Bench:
    """A robot with its manager, whose cycles the test runs.

    Args:
        robot: The robot, not yet initialised; None for a `MockRobotHW`.
        robot_parameters: Parameters of the robot.
        root_parameters: Parameters of the root namespace, e.g. `robot_description`.
        loaders: Source of controllers; None for the table of the station,
            installed packages and `module:Class`.
        clock: Clock of wall time; None for a clock that stands still.
        period: Period of a cycle [s], > 0.

    Attributes:
        robot: The robot, initialised.
        manager: Its controller manager.
        parameters: The root of the parameter tree.
        clock: Wall time.
        period: Period of a cycle [s].
        time: Station time of the last cycle [s].

    Raises:
        StationError: The robot cannot be initialised with these parameters.
    """

    def __init__(
        self,
        robot: RobotHW | None = None,
        robot_parameters: Mapping[str, object] | None = None,
        *,
        root_parameters: Mapping[str, object] | None = None,
        loaders: Sequence[ControllerLoader] | None = None,
        clock: Clock | None = None,
        period: float = 0.001,
    ) -> None:
        self.clock = clock or ManualClock()
        self.period = period
        self.time = 0.0
        self.parameters = Parameters()
        for name, value in (root_parameters or {}).items():
            self.parameters.set(name, value)
        self.parameters.set("hw", dict(robot_parameters or {}))
        self.robot = MockRobotHW() if robot is None else robot
        if isinstance(self.robot, MockRobotHW):
            self.robot.clock = self.clock
        self.robot.init(self.parameters, self.parameters.namespace("hw"))
        known = default_loaders(CONTROLLERS) if loaders is None else loaders
        self.manager = ControllerManager(self.robot, self.parameters, known, self.clock)
        self.manager.pump = self.step
        self.manager.period = period

    def make_station(self) -> Station:
        """Return a station with this robot; from now on its loop runs the cycles."""
        loop = ControlLoop(
            self.robot, self.manager, clock=self.clock, period=self.period
        )
        return Station(loop, self.manager, self.parameters)

    def step(self, cycles: int = 1) -> None:
        """Run cycles."""
        for _ in range(cycles):
            self.time += self.period
            self._cycle(self.period)

    def pause(self, cycles: int = 1) -> None:
        """Run cycles in which station time stands still."""
        for _ in range(cycles):
            self._cycle(0.0)

    def _cycle(self, period: float) -> None:
        self.robot.read(self.time, period)
        self.manager.update(self.time, period)
        self.robot.write(self.time, period)

    def load_controller(
        self, name: str, controller: str | type[ControllerBase], **parameters: object
    ) -> ControllerBase:
        """Load a controller and return it.

        Args:
            name: Name to load it under.
            controller: Its type, `module:Class`, or the class itself.
            parameters: Its parameters.

        Raises:
            StationError: The controller cannot be loaded; the message states the
                reason.
        """
        if not isinstance(controller, str):
            controller_type = f"{controller.__module__}/{controller.__name__}"
            self.manager.register_loader(TableLoader({controller_type: controller}))
        else:
            controller_type = controller
        self.parameters.set(name, {**parameters, "type": controller_type})
        self.manager.load_controller(name)
        return self.manager.get_controller(name)

    def switch(
        self,
        start: Sequence[str] = (),
        stop: Sequence[str] = (),
        strictness: Strictness = Strictness.STRICT,
        *,
        start_asap: bool = False,
        timeout: float = 0.0,
        bound: float | None = SWITCH_BOUND,
        dry_run: bool = False,
        zero_period: bool = False,
    ) -> SwitchResult:
        """Start and stop controllers; see `SwitchRequest`.

        Raises:
            StationError: The switch is refused.
        """
        return self.manager.switch_controller(
            SwitchRequest(
                start,
                stop,
                strictness,
                start_asap=start_asap,
                timeout=timeout,
                bound=bound,
                dry_run=dry_run,
                zero_period=zero_period,
            )
        )

    def status(self, name: str) -> ControllerStatus:
        """Return the status of a controller.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
        """
        self.manager.get_controller(name)
        return next(s for s in self.manager.list_controllers() if s.name == name)

    def state(self, name: str) -> str:
        """Return the state of a controller as ros_control names it, e.g. `running`."""
        return self.manager.get_controller(name).state.value

    def fault(self, name: str) -> str | None:
        """Return the fault that stopped a controller; None if there was none."""
        return self.status(name).fault

    def commands(self) -> list[float]:
        """Return every command of every interface of the robot."""
        return [
            storage[index]
            for interface_type in self.robot.interface_types()
            if isinstance(
                interface := self.robot.get(interface_type), HardwareResourceManager
            )
            for handle in interface.handles()
            for storage, index in handle.command_slots()
        ]
