"""Script the answers of a robot's switching hooks, and keep their real effects."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from station.core.errors import SwitchRefusedError
from station.core.hardware.robot_hw import ControllerInfo, RobotHW, SwitchState

Prepare = Literal["yes", "no", "raise"]
"""Effect of `prepare_switch`: call the robot's own hook, refuse, or raise an error."""
Answer = Literal["DONE", "ONGOING", "ERROR", "raise"]
"""Answer of `switch_result` and `switch_result_for`; DONE asks the robot's own hook."""


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
