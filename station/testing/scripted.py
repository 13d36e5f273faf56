"""Controllers and a robot's switching hooks whose answers a test scripts.

The hooks keep their real effects.
"""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from typing_extensions import override

from station.core.clock import Clock
from station.core.control.controller import Controller
from station.core.control.controller_loader import TableLoader, Target
from station.core.errors import SwitchRefusedError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, RobotHW, SwitchState
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW
from station.testing.bench import Bench

PERIOD = 0.01
"""Period of a cycle of `ScriptedBench` [s]."""


Actions = dict[str, Callable[[], object]]
"""Actions to run in callbacks, by the callback's name."""
Prepare = Literal["yes", "no", "raise"]
"""Effect of `prepare_switch`: call the robot's own hook, refuse, or raise an error."""
Answer = Literal["DONE", "ONGOING", "ERROR", "raise"]
"""Answer of `switch_result` and `switch_result_for`; DONE asks the robot's own hook."""


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


class HookError(RuntimeError):
    """The error that a hook raises because its script says so."""


@dataclass
class HookScript:
    """The scripted answers of one robot's hooks; a test may change it between cycles.

    A hook that must fail does not call the robot's own hook, so that the robot does not
    change.

    Attributes:
        prepare: Effect of `prepare_switch`.
        works: Whether `do_switch` succeeds, call by call; the last entry is repeated.
        answers: Results, cycle by cycle; the last entry is repeated.
        switches: How often `do_switch` was called.
        asked: Number of questions for a result. The manager asks twice a cycle unless
            the answer is DONE, so each entry of `answers` covers two questions.
    """

    prepare: Prepare = "yes"
    works: Sequence[bool] = (True,)
    answers: Sequence[Answer] = ("DONE",)
    switches: int = field(default=0, compare=False)
    asked: int = field(default=0, compare=False)

    def begin(
        self,
        prepare: Prepare = "yes",
        works: Sequence[bool] = (True,),
        answers: Sequence[Answer] = ("DONE",),
    ) -> None:
        """Reset the counts, and follow other answers."""
        self.prepare, self.works, self.answers = prepare, works, answers
        self.switches = self.asked = 0

    def install(self, robot: RobotHW) -> None:
        """Let the hooks of `robot` follow this script, before a manager uses it.

        It replaces the hooks of this object, not those of its class.
        """
        prepare, do = robot.prepare_switch, robot.do_switch
        result, result_for = robot.switch_result, robot.switch_result_for

        def prepare_switch(
            start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
        ) -> None:
            self._prepare()
            prepare(start, stop)

        def do_switch(
            start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
        ) -> None:
            self._do()
            do(start, stop)

        def switch_result() -> SwitchState:
            answer = self._answer()
            return result() if answer is SwitchState.DONE else answer

        def switch_result_for(controller: ControllerInfo) -> SwitchState:
            answer = self._answer()
            return result_for(controller) if answer is SwitchState.DONE else answer

        robot.prepare_switch = prepare_switch  # type: ignore[method-assign]
        robot.do_switch = do_switch  # type: ignore[method-assign]
        robot.switch_result = switch_result  # type: ignore[method-assign]
        robot.switch_result_for = switch_result_for  # type: ignore[method-assign]

    def _prepare(self) -> None:
        if self.prepare == "no":
            raise SwitchRefusedError(
                "The robot was told to refuse the switch.",
                remedy="Change the script of its hooks.",
            )
        if self.prepare == "raise":
            raise HookError("prepare_switch was told to raise")

    def _do(self) -> None:
        works = self.works[min(self.switches, len(self.works) - 1)]
        self.switches += 1
        if not works:
            raise HookError("do_switch was told to raise")

    def _answer(self) -> SwitchState:
        said = self.answers[min(self.asked // 2, len(self.answers) - 1)]
        self.asked += 1
        if said == "raise":
            raise HookError("switch_result was told to raise")
        return SwitchState[said]
