"""Controllers whose callbacks a test scripts, on a mock robot."""

import threading
from collections.abc import Callable

from typing_extensions import override

from station.core.clock import Clock
from station.core.control.controller import Controller
from station.core.control.controller_loader import TableLoader, Target
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW
from station.testing.bench import Bench

PERIOD = 0.01
"""Period of a cycle of `ScriptedBench` [s]."""


Actions = dict[str, Callable[[], object]]
"""Actions to run in callbacks, by the callback's name."""


class Scripted(Controller[EffortJointInterface]):
    """Notes every callback and runs the `actions` of the test.

    Parameters: `joints`, the names of the joints that it claims; and `init_raises`,
    the text of the error that `init` raises.

    Attributes:
        joints: The handles of the joints.
        calls: Names of the callbacks so far, oldest first.
        actions: Actions to run in callbacks, by the callback's name.
    """

    @override
    def init(self, interface: EffortJointInterface, params: Parameters) -> None:
        """Claim `joints`.

        Args:
            interface: The robot's interface.
            params: `joints`, names of joints; `init_raises`, the exception of `init`.

        Raises:
            RuntimeError: The parameter `init_raises` is set.
        """
        names = params.get_str_list("joints", [])
        self.joints: list[JointHandle] = [interface.get_handle(name) for name in names]
        self.calls: list[str] = []
        self.actions: Actions = {}
        if params.has("init_raises"):
            raise RuntimeError(params.get_str("init_raises"))

    def command(self, value: float) -> None:
        """Command the same value to all joints."""
        for joint in self.joints:
            joint.set_command(value)

    def _note(self, name: str) -> None:
        self.calls.append(name)
        if name in self.actions:
            self.actions[name]()

    @override
    def starting(self, time: float) -> None:
        self._note("starting")

    @override
    def update(self, time: float, period: float) -> None:
        self._note("update")

    @override
    def stopping(self, time: float) -> None:
        self._note("stopping")

    @override
    def waiting(self, time: float) -> None:
        self._note("waiting")

    @override
    def aborting(self, time: float) -> None:
        self._note("aborting")


class ScriptedPosition(Scripted):
    """A scripted controller with position commands."""

    hardware_interface = PositionJointInterface


class ScriptedVelocity(Scripted):
    """A scripted controller with velocity commands."""

    hardware_interface = VelocityJointInterface


TYPES: dict[str, Target] = {
    "test/Effort": Scripted,
    "test/Position": ScriptedPosition,
    "test/Velocity": ScriptedVelocity,
}
"""The types of the scripted controllers on a `ScriptedBench`."""


class ScriptedBench(Bench):
    """A bench with a mock robot (joints j1, j2, j3) and scripted controllers.

    Args:
        clock: Clock of wall time; None for a clock that stands still.
    """

    robot: MockRobotHW

    def __init__(self, clock: Clock | None = None) -> None:
        super().__init__(
            MockRobotHW(),
            {"joints": ["j1", "j2", "j3"]},
            loaders=[TableLoader(TYPES)],
            clock=clock,
            period=PERIOD,
        )

    def step_elsewhere(self) -> None:
        """Run one cycle in another thread."""
        thread = threading.Thread(target=self.step)
        thread.start()
        thread.join()

    def load(
        self, name: str, *joints: str, kind: str = "Effort", **parameters: object
    ) -> Scripted:
        """Load a scripted controller over some joints and return it.

        Args:
            name: Its name.
            joints: The joints that it claims.
            kind: `Effort`, `Position` or `Velocity`.
            parameters: More parameters.

        Raises:
            StationError: The controller cannot be loaded.
        """
        controller = self.load_controller(
            name, f"test/{kind}", joints=list(joints), **parameters
        )
        assert isinstance(controller, Scripted)
        return controller
