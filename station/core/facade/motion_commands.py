"""The commands that make the robot move: set-points, goals, trajectories.

Every command is checked first: the station must be armed, the controller must run, and
the epoch, if the caller names one, must be the present one.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence

from station.core.control.controller import ControllerBase, TrajectoryPort
from station.core.control.controller_manager import ControllerManager
from station.core.errors import (
    ControllerNotFoundError,
    ControllerStateError,
    InvalidCommandError,
    InvalidTrajectoryError,
    StaleEpochError,
    StationError,
    counted,
    show,
)
from station.core.facade.input_log import InputLog
from station.core.loop.control_loop import ControlLoop
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import Goal, GoalPort
from station.core.ports.set_point import SetPoint, SetPointPort
from station.core.trajectory import PosVelAccState
from station.reports import Clearance

_ACCEPTANCE = 0.02
"""Time within which a running loop should pick a command up [s]."""


def _anybody() -> None:
    """Admit every caller."""


class MotionCommands:
    """Passes set-points, goals and trajectories on to controllers. Any thread.

    Args:
        loop: The loop.
        manager: The loop's controller manager.
        inputs: Receives each command.
    """

    def __init__(
        self,
        loop: ControlLoop,
        manager: ControllerManager,
        inputs: InputLog | None = None,
    ) -> None:
        self._inputs = inputs or InputLog(loop)
        self.loop = loop
        self.manager = manager

    def set_point(self, name: str) -> SetPoint:
        """Return the elements of a controller's set-point, and the last set-point.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            InvalidCommandError: The controller takes no set-points.
        """
        port = self._set_point_port(name)
        last, size = port.last, len(port.elements)
        values = None if last is None else tuple(last[:size])
        return SetPoint(tuple(port.elements), values)

    def ticket(self) -> CommandTicket:
        """Return a new ticket, which goes with a command and then to `wait_for`."""
        return CommandTicket(lambda: self.loop.cycle)

    def wait_for(self, ticket: CommandTicket) -> int | None:
        """Return the cycle that accepted a command; None if no cycle does so soon.

        No cycle does while the simulation is paused, or if a newer command has replaced
        this one.
        """
        loop = self.loop
        # A loop that does not run, or is stepped, accepts nothing during this wait.
        if loop.advances:
            deadline = loop.clock.now() + max(_ACCEPTANCE, 4.0 * loop.period)
            loop.clock.wait_for(ticket.done, deadline)
        return ticket.accepted_cycle

    def set_command(
        self,
        name: str,
        values: Sequence[float | None],
        epoch: int | None = None,
        timeout: float | None = None,
        rates: list[float] | None = None,
        ticket: CommandTicket | None = None,
    ) -> int:
        """Give a running controller a new set-point; return the epoch it belongs to.

        Args:
            name: The controller.
            values: One number per element of the set-point. None leaves an element at
                its last command, so that callers can move different elements
                independently, unless their calls overlap in time. Calls through the
                API do not overlap, because each of them holds the lock of control.
            epoch: The epoch in which the caller decided; None takes the present one.
            timeout: How long the set-point is valid [s wall time], 0 without limit;
                None takes the controller's own timeout.
            rates: Rate of change of each element; only for controllers that use rates
                as a feed-forward.
            ticket: Notes the cycle that takes the set-point.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            ControllerStateError: The controller is not running.
            InvalidCommandError: The controller takes no set-points or no rates, or the
                numbers are malformed.
            StaleEpochError: `epoch` is not the present epoch.
            StoppedError: The station is stopped.
            LoopError: The loop died.
        """
        port = self._set_point_port(name)
        if not isinstance(values, Iterable) or isinstance(
            values, (str, bytes, Mapping)
        ):
            raise InvalidCommandError(
                f"The command for '{name}' is {show(values)}; it must be a list.",
                remedy="Send a list with one number per element.",
                details={"expected": [element.name for element in port.elements]},
            )
        generation = port.generation
        whole = self._whole(name, port, values)
        port.check(whole, timeout, rates)
        present = self._check_may_move(name, epoch)
        ticket = ticket or self.ticket()
        # A stop or reset in between changes the generation and voids the set-point.
        port.post([*whole, *(rates or [])], timeout, generation, ticket)
        self._inputs.note_command(
            "set_point", ticket, name=name, values=whole, timeout=timeout, rates=rates
        )
        return present

    def _whole(
        self, name: str, port: SetPointPort, values: Sequence[float | None]
    ) -> list[float]:
        """Return a set-point with each None replaced by the value in force.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            ControllerStateError: The controller is not running.
            InvalidCommandError: The set-point in force is not known.
            StoppedError: The station is stopped.
            LoopError: The loop died.
        """
        given = [value for value in values if value is not None]
        if len(given) == len(values):
            return given
        # Check first, so that after a stop the error is `StoppedError`.
        self._check_may_move(name, None)
        controller = self.manager.get_controller(name)
        size, in_force = len(port.elements), port.newest
        if in_force is None and (sample := controller.sample) is not None:
            in_force = list(sample.desired)
        if in_force is None or len(in_force) < size or len(values) != size:
            raise InvalidCommandError(
                f"The command for '{name}' leaves elements out, which cannot be "
                "filled in.",
                remedy=f"Send {counted(size, 'value')}, each a number or null, once "
                "the controller has run for a cycle.",
                details={"expected": [element.name for element in port.elements]},
            )
        return [
            present if value is None else value
            for value, present in zip(values, in_force[:size], strict=True)
        ]

    def let_go(self, names: Iterable[str], reason: str) -> None:
        """End the motions of controllers whose commander has lost control.

        Their set-points expire now, as if their client had fallen silent: the
        `command_timeout` parameters of a controller decide whether it holds or stops. A
        set-point that no cycle has picked up yet is dropped. Goals are cancelled and
        trajectories end, so that the joints hold. Controllers without a command are
        left alone.

        Args:
            names: The controllers; names that are no longer loaded are left out.
            reason: Why the goals end, in one sentence.
        """
        for name in names:
            try:
                controller = self.manager.get_controller(name)
            # It was unloaded meanwhile and has nothing left to end.
            except ControllerNotFoundError:
                continue
            if controller.set_points is not None:
                controller.set_points.expire()
            goals = [] if controller.goals is None else controller.goals.goals()
            ended = [self._cancel(name, goal, goals, reason) for goal in goals]
            if controller.trajectories is not None and not any(ended):
                self.hold(name)

    def hold(self, name: str) -> None:
        """Let a controller end its trajectory without a goal, and hold the joints.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            InvalidCommandError: The controller takes no trajectories.
        """
        ticket = self.ticket()
        self._trajectory_port(name).hold(ticket)
        self._inputs.note_command("hold_trajectory", ticket, name=name)

    def submit_goal(
        self,
        name: str,
        request: Mapping[str, object],
        epoch: int | None = None,
        admit: Callable[[], None] = _anybody,
        ticket: CommandTicket | None = None,
    ) -> Goal:
        """Give a running controller a goal; it replaces the active goal.

        Args:
            name: The controller.
            request: The goal message of the controller's action.
            epoch: The epoch in which the caller decided; None takes the present one.
            admit: Called before the goal is planned and afterwards; raises a
                StationError when the caller may not move the robot.
            ticket: Notes the cycle that takes the goal.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            ControllerStateError: The controller is not running.
            InvalidCommandError: The controller takes no goals, or `request` is
                malformed.
            InvalidTrajectoryError: `request` cannot be followed.
            StaleEpochError: `epoch` is not the present epoch.
            StoppedError: The station is stopped.
            LoopError: The loop died.
            StationError: `admit` refuses, or one of these conditions arose while the
                goal was planned; nothing moves.
        """
        port = self._goal_port(name)
        admit()
        present = self._check_may_move(name, epoch)
        ticket = ticket or self.ticket()
        goal = port.submit(request, ticket)
        goal.explain = self._watch_guards()
        self._inputs.note_command("goal", ticket, name=name, request=request)
        try:
            # Ask again: control may have changed hands, or a stop may have come, since
            # the goal was admitted.
            admit()
            self._check_may_move(name, present)
        except StationError as error:
            goal.withdraw(f"It did not begin: {error.message}")
            raise
        return goal

    def _watch_guards(self) -> Callable[[], str]:
        """Return a function that names the arms slowed by guards since this call."""
        guards = tuple(self.loop.hw.guards())

        def clearances() -> list[Clearance]:
            found = (guard.report() for guard in guards)
            return [one for one in found if one is not None]

        before = {one.arm: one.interventions for one in clearances()}

        def explain() -> str:
            # A change of the scene resets the count.
            slowed = [
                one
                for one in clearances()
                if one.interventions not in (0, before.get(one.arm))
            ]
            return " ".join(
                f"The guard holds '{one.arm}' back: '{one.link}' is "
                f"{1e3 * one.distance:.0f} mm from '{one.object}' and has to stay "
                f"{1e3 * one.margin:.0f} mm away."
                if one.is_slowing
                else f"The guard has slowed '{one.arm}' on its way."
                for one in slowed
            )

        return explain

    def goals(self, name: str) -> list[Goal]:
        """Return the latest goals of a controller, oldest first.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            InvalidCommandError: The controller takes no goals.
        """
        return self._goal_port(name).goals()

    def goal(self, name: str, identifier: str) -> Goal:
        """Return one goal of a controller.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            GoalNotFoundError: The controller knows no such goal.
            InvalidCommandError: The controller takes no goals.
        """
        return self._goal_port(name).get(identifier)

    def cancel_goal(self, name: str, identifier: str) -> Goal:
        """Ask a goal to end; the joints hold from the next cycle on.

        This is possible at any time, also while the station is stopped. A goal that has
        ended stays as it is.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            GoalNotFoundError: The controller knows no such goal.
            InvalidCommandError: The controller takes no goals.
        """
        port = self._goal_port(name)
        goal = port.get(identifier)
        self._cancel(name, goal, port.goals())
        return goal

    def _cancel(
        self, name: str, goal: Goal, goals: list[Goal], reason: str | None = None
    ) -> bool:
        """Ask a goal to end; return whether it had not ended yet."""
        ticket = self.ticket()
        if goal.ended is None:
            goal.ended = ticket
        if not goal.ask_to_end(reason):
            return False
        # Goals have other identifiers in a re-run, so the place in the list is noted.
        behind = goals[::-1].index(goal) if goal in goals else 0
        self._inputs.note_command("cancel_goal", ticket, name=name, behind=behind)
        return True

    def follow_trajectory(
        self,
        name: str,
        request: Mapping[str, object],
        epoch: int | None = None,
        ticket: CommandTicket | None = None,
        admit: Callable[[], None] = _anybody,
    ) -> int:
        """Let a running controller follow a trajectory without a goal.

        Args:
            name: The controller.
            request: The trajectory message.
            epoch: The epoch in which the caller decided; None takes the present one.
            ticket: Notes the cycle that takes the trajectory.
            admit: Called before the trajectory is planned and afterwards; raises a
                StationError when the caller may not move the robot.

        Returns:
            The epoch that the trajectory belongs to.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            ControllerStateError: The controller is not running.
            InvalidTrajectoryError: `request` cannot be followed.
            InvalidCommandError: The controller takes no trajectories.
            StaleEpochError: `epoch` is not the present epoch.
            StoppedError: The station is stopped.
            LoopError: The loop died.
            StationError: `admit` refuses, or one of these conditions arose while the
                trajectory was planned; nothing moves.
        """
        port = self._trajectory_port(name)
        admit()
        present = self._check_may_move(name, epoch)
        ticket = ticket or self.ticket()
        port.follow_trajectory(request, ticket)
        self._inputs.note_command("trajectory", ticket, name=name, request=request)
        try:
            admit()
            self._check_may_move(name, present)
        except StationError:
            port.hold()
            raise
        return present

    def query_state(self, name: str, time: float | None = None) -> PosVelAccState:
        """Return the desired state of a controller's joints at a time.

        Args:
            name: The controller.
            time: Station time [s]; None takes the present.

        Raises:
            ControllerNotFoundError: No such controller is loaded.
            ControllerStateError: The controller is not running.
            InvalidCommandError: The controller takes no trajectories.
            InvalidTrajectoryError: `time` is before its trajectory, or not finite.
        """
        port = self._trajectory_port(name)
        when = self.loop.time if time is None else time
        # True only for infinities and NaN.
        if when - when != 0.0:
            raise InvalidTrajectoryError(
                f"The time asked for is {when}.", remedy="Give a finite time."
            )
        self._check_running(name, self.manager.get_controller(name))
        return port.query_state(when)

    def _check_may_move(self, name: str, epoch: int | None) -> int:
        """Return the present epoch, if the controller may move the robot.

        Raises:
            ControllerStateError: The controller is not running.
            StaleEpochError: `epoch` is not the present epoch.
            StoppedError: The station is stopped.
            LoopError: The loop died.
        """
        self.loop.check_alive()
        self.loop.stop_latch.check()
        self._check_running(name, self.manager.get_controller(name))
        present = self.loop.epoch
        if epoch is not None and epoch != present:
            raise StaleEpochError(
                f"The command belongs to epoch {epoch}; the station is in {present}.",
                remedy="Look at the state again, then command with the new epoch.",
                details={"epoch": present},
            )
        return present

    @staticmethod
    def _check_running(name: str, controller: ControllerBase) -> None:
        """Refuse commands of a controller that does not run.

        Raises:
            ControllerStateError: The controller is not running.
        """
        if not controller.is_running():
            raise ControllerStateError(
                f"Controller '{name}' is {controller.state.value}; it takes commands "
                "while it is running.",
                remedy=f"Start controller '{name}' first.",
                details={"controller": name, "state": controller.state.value},
            )

    def _set_point_port(self, name: str) -> SetPointPort:
        port = self.manager.get_controller(name).set_points
        if port is None:
            raise _takes_none(name, "set-points", "a group controller")
        return port

    def _goal_port(self, name: str) -> GoalPort:
        port = self.manager.get_controller(name).goals
        if port is None:
            raise _takes_none(name, "goals", "a JointTrajectoryController")
        return port

    def _trajectory_port(self, name: str) -> TrajectoryPort:
        port = self.manager.get_controller(name).trajectories
        if port is None:
            raise _takes_none(name, "trajectories", "a JointTrajectoryController")
        return port


def _takes_none(name: str, what: str, instead: str) -> InvalidCommandError:
    return InvalidCommandError(
        f"Controller '{name}' takes no {what}.",
        remedy=f"Command {instead} of a *_controllers package.",
        details={"controller": name},
    )
