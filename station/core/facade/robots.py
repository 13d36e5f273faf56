"""The robots of the station, for any thread: their services, and recovery.

Every method does its work between two cycles, and either succeeds as a whole or raises
and changes nothing.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.errors import (
    ArmCommandError,
    ArmNotFoundError,
    ServiceNotFoundError,
    suggest,
)
from station.core.facade.input_log import InputLog
from station.core.hardware.services import (
    RecoverableRobot,
    RobotServices,
    Service,
    find_services,
)
from station.core.loop.control_loop import ControlLoop
from station.core.ports.command_ticket import CommandTicket

T = TypeVar("T")
ServicesT = TypeVar("ServicesT", bound=RobotServices)
_LONGEST_RECOVERY = 2_000
"""Number of cycles after which a recovering robot must be at rest."""


class Robots:
    """The robots of one station, by name.

    Args:
        loop: The loop.
        manager: Its controller manager.
        inputs: Receives services and recoveries.
    """

    def __init__(
        self,
        loop: ControlLoop,
        manager: ControllerManager,
        inputs: InputLog | None = None,
    ) -> None:
        self._inputs = inputs or InputLog(loop)
        self._loop = loop
        self._manager = manager
        self._handles: dict[str, list[RobotServices]] = {}
        for handle in find_services(loop.hw):
            self._handles.setdefault(handle.name, []).append(handle)

    def names(self, kind: type[RobotServices] = RobotServices) -> list[str]:
        """Return the names of the robots that have services of that kind."""
        return [
            name
            for name, handles in self._handles.items()
            if any(isinstance(handle, kind) for handle in handles)
        ]

    def kinds(self) -> list[type[RobotServices]]:
        """Return the classes of all services, each once."""
        handles = (one for handles in self._handles.values() for one in handles)
        return list(dict.fromkeys(type(handle) for handle in handles))

    def get(self, name: str, kind: type[ServicesT]) -> ServicesT | None:
        """Return a robot's services of one kind; None if it has none of that kind.

        Raises:
            ArmNotFoundError: There is no such robot.
        """
        return next((h for h in self._of(name) if isinstance(h, kind)), None)

    def services(self, name: str) -> dict[str, Service]:
        """Return the declared services of a robot by name.

        Raises:
            ArmNotFoundError: There is no such robot.
        """
        declared: dict[str, Service] = {}
        for handle in self._of(name):
            declared |= handle.services()
        return declared

    def find_service(
        self, name: str, service_name: str
    ) -> tuple[Service, Callable[..., object]]:
        """Return a declared service of a robot, and the method that carries it out.

        The method is for the control thread: `ControlLoop.run_in_cycle` calls it.

        Args:
            name: The robot.
            service_name: The service.

        Raises:
            ArmNotFoundError: There is no such robot.
            ServiceNotFoundError: The robot has no such service.
        """
        for handle in self._of(name):
            found = handle.services().get(service_name)
            if found is not None:
                method = getattr(handle, service_name)
                return found, self._noted(name, service_name, method)
        raise ServiceNotFoundError(
            f"Robot '{name}' has no service '{service_name}'.",
            remedy=suggest(service_name, self.services(name)),
            details={"robot": name, "service": service_name},
        )

    def _noted(
        self, name: str, service: str, method: Callable[..., object]
    ) -> Callable[..., object]:
        """Return a service that is noted as an input once it is done."""

        def call(**arguments: object) -> object:
            answer = method(**arguments)
            self._inputs.note_in_cycle(
                "service", robot=name, service=service, arguments=arguments
            )
            return answer

        return call

    def run(
        self,
        action: Callable[[], T],
        *,
        moves: bool = False,
        voids: str | None = None,
    ) -> T:
        """Run `action` between two cycles and return its result.

        Args:
            action: Short, and must not wait.
            moves: Whether the action can move the robot; it is then refused while the
                station is stopped.
            voids: Why all earlier set-points and goals are void once `action` is done;
                None if they stay valid.

        Raises:
            StoppedError: `moves` is true and the station is stopped.
            LoopError: The loop died or hangs.
        """

        def act() -> T:
            result = action()
            if voids is not None:
                self._loop.control_cycle.next_epoch(voids)
            if moves or voids is not None:
                self._inputs.note_in_cycle("operation", what=_name_of(action))
            return result

        return self._loop.run_in_cycle(act, moves=moves)

    def delay_next_cycle(self, cycles: int) -> None:
        """Make the loop's next cycle begin late by some nominal periods."""
        self._loop.delay_next_cycle(cycles)

    def forget_interrupted(self) -> None:
        """Forget the controllers that an error has stopped: no recovery starts them."""
        self._manager.controller_update.interrupted = ()

    def recover(
        self, name: str, *, restart: bool | Sequence[str] = False
    ) -> tuple[str, ...]:
        """Clear a robot's errors; every earlier command is void.

        Without an error nothing happens. Returns when the robot is at rest, or at once
        while time is paused.

        Args:
            name: The robot.
            restart: Whether to start the controllers again that the interruption has
                stopped, or the names of the controllers to start; with a first update
                whose period is zero.

        Returns:
            Names of the controllers that were started again.

        Raises:
            ArmNotFoundError: There is no such robot.
            ControllerNotFoundError: No controller of a name in `restart` is loaded.
            ArmCommandError: The robot cannot recover now.
            StoppedError: The station is stopped and controllers were to be started.
            SwitchRefusedError: The controllers cannot be started; the robot recovered.
        """
        kind: type[RecoverableRobot] = RecoverableRobot  # type: ignore[type-abstract]
        robot = self.get(name, kind)
        return self._recover([] if robot is None else [robot], restart=restart)

    def recover_all(self, *, restart: bool | Sequence[str] = False) -> tuple[str, ...]:
        """Clear the errors of all robots, or of none if one of them cannot recover.

        Args:
            restart: As for `recover`.

        Returns:
            Names of the controllers that were started again.

        Raises:
            ControllerNotFoundError: No controller of a name in `restart` is loaded.
            ArmCommandError: A robot cannot recover now.
            StoppedError: The station is stopped and controllers were to be started.
            SwitchRefusedError: The controllers cannot be started; the robots recovered.
        """
        return self._recover(self._recoverable(), restart=restart)

    def _recover(
        self, robots: Sequence[RecoverableRobot], *, restart: bool | Sequence[str]
    ) -> tuple[str, ...]:
        named = () if isinstance(restart, bool) else tuple(restart)
        for name in named:
            self._manager.get_controller(name)
        if restart:
            self._loop.stop_latch.check()

        def clear() -> bool:
            # Check all of them first: either all recover or none does.
            for robot in robots:
                robot.check_recovery()
            recovered = [robot.name for robot in robots if robot.error_recovery()]
            if recovered:
                self._inputs.note_in_cycle("recover", robots=recovered)
                names = "' and '".join(recovered)
                did = "was" if len(recovered) == 1 else "were"
                self._loop.control_cycle.next_epoch(f"Arm '{names}' {did} recovered.")
            return bool(recovered)

        if not self._loop.run_in_cycle(clear):
            return ()
        for robot in robots:
            self.wait_until_recovered(robot)
        interrupted = self._manager.controller_update.interrupted if restart else ()
        started = self._start_again(named or interrupted)
        if restart or all(one.remedy() is None for one in self._recoverable()):
            self._manager.controller_update.interrupted = ()
        return started

    def _start_again(self, names: tuple[str, ...]) -> tuple[str, ...]:
        if not names:
            return ()
        ticket = CommandTicket(lambda: self._loop.cycle)
        request = SwitchRequest(names, (), zero_period=True, ticket=ticket)
        self._inputs.note_command(
            "switch", ticket, start=names, stop=(), zero_period=True
        )
        return self._manager.switch_controller(request).started

    def wait_until_recovered(self, robot: RecoverableRobot) -> None:
        """Wait until a recovery has ended; return at once while time is paused.

        Raises:
            ArmCommandError: The robot does not come to rest.
        """
        for _ in range(_LONGEST_RECOVERY):
            if not robot.is_recovering() or self._loop.speed.paused:
                return
            # Without a control thread the caller runs the cycles itself.
            if self._manager.pump is not None:
                self._manager.pump()
            else:
                self._loop.run_in_cycle(lambda: None)
        raise ArmCommandError(
            f"Arm '{robot.name}' did not come to rest.", remedy="Recover once more."
        )

    def _recoverable(self) -> list[RecoverableRobot]:
        handles = (one for handles in self._handles.values() for one in handles)
        return [handle for handle in handles if isinstance(handle, RecoverableRobot)]

    def _of(self, name: str) -> list[RobotServices]:
        handles = self._handles.get(name)
        if handles is None:
            raise ArmNotFoundError(
                f"There is no arm '{name}'.",
                remedy=suggest(name, self._handles),
                details={"arm_id": name},
            )
        return handles


def _name_of(action: Callable[..., object]) -> str:
    """Return the qualified name of an action."""
    return str(getattr(action, "__qualname__", type(action).__qualname__))
