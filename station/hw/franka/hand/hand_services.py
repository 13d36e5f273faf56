"""The services of a simulated hand: its commands, their checks, and their results."""

from dataclasses import asdict, replace
from typing import Protocol

from typing_extensions import override

from station.core.errors import GripperCommandError
from station.core.franka import (
    DEFAULT_SPEED,
    GraspRequest,
    GripperAction,
    GripperActivity,
    GripperCommand,
    GripperServices,
    GripperState,
)
from station.core.ports.goal import GoalStatus
from station.hw.franka.hand.gripper_motion import GripperMotion, GripperMotor
from station.hw.franka.hand.hand_limits import check_grasp, check_move
from station.memory.doubles import Doubles

ROOM_TEMPERATURE = 20.0
"""Temperature of a simulated hand [degree Celsius]."""


class FingerSensor(Protocol):
    """Reads the fingers."""

    def read(self) -> None:
        """Bring the readings up to date."""


class HandMotor(GripperMotor, Protocol):
    """A motor that reports its range and its force.

    Attributes:
        effort_limit: Largest force that a controller may give each finger [N].
    """

    effort_limit: float

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest position of a finger [m]."""

    def read_force(self) -> float:
        """Return the force that the motor gave each finger [N]."""

    def sensor(
        self, positions: Doubles, velocities: Doubles, efforts: Doubles
    ) -> FingerSensor:
        """Return a reader of each finger's position, velocity and force."""


class HandServices(GripperServices):
    """The services of a simulated hand. Control thread only.

    Args:
        arm_id: The arm with this hand.
        motor: The motor of the fingers.

    Attributes:
        owner: The controller that claims the fingers; None without such a controller.
        is_moving: Whether `advance` may have something to do.
    """

    def __init__(self, arm_id: str, motor: HandMotor) -> None:
        super().__init__(arm_id)
        self._motor = motor
        self._open_width = 2.0 * motor.limits[1]
        self._motion = GripperMotion(motor, self._open_width)
        self._command: GripperCommand | None = None
        self._last: GripperCommand | None = None
        self._count = 0
        self.owner: str | None = None
        self.is_moving = False

    @override
    def get_state(self) -> GripperState:
        motion = self._motion
        activity = GripperActivity.CONTROLLED if self.owner else motion.activity
        return GripperState(
            width=motion.width(),
            max_width=motion.max_width,
            is_grasped=motion.is_grasped(),
            temperature=ROOM_TEMPERATURE,
            time=self._motor.read_time(),
            activity=activity,
            force=self._motor.read_force(),
            command=self._command,
            last=self._last,
        )

    @override
    def homing(self) -> None:
        self._check_free()
        self._begin(GripperAction.HOMING, {})
        self._motion.home()

    @override
    def move(self, width: float, speed: float = DEFAULT_SPEED) -> None:
        self._check_free()
        check_move(self.name, width, speed, self._open_width)
        self._begin(GripperAction.MOVE, {"width": width, "speed": speed})
        self._motion.move(width, speed)

    @override
    def grasp(self, request: GraspRequest) -> None:
        self._check_free()
        check_grasp(self.name, request, self._open_width)
        self._begin(GripperAction.GRASP, asdict(request))
        self._motion.grasp(request)

    @override
    def stop(self) -> None:
        self._end(GoalStatus.PREEMPTED, "The gripper was told to stop.")
        # A controller that owns the fingers goes on to command them.
        if self.owner is None:
            self._rest()

    @override
    def interrupt(self, reason: str) -> None:
        if self._command is not None:
            self._end(GoalStatus.PREEMPTED, reason)
            self._rest()

    def give_to(self, owner: str | None) -> None:
        """Give the fingers to a controller, or take them back.

        Args:
            owner: Name of the controller; None if no controller claims the fingers.
        """
        if owner is not None and owner != self.owner:
            self._end(GoalStatus.PREEMPTED, f"Controller '{owner}' took the fingers.")
            self._motion.give_up()
        self.owner = owner

    def begin_anew(self) -> None:
        """End the present command: the world was reset."""
        self._end(GoalStatus.PREEMPTED, "A reset put the hand back to its start.")
        self._motion.give_up()

    def advance(self) -> None:
        """Continue the present motion; once per cycle."""
        motion = self._motion
        outcome = None if motion.is_over() else motion.advance()
        self.is_moving = not motion.is_over()
        if outcome is not None:
            if outcome.message is None:
                self._end(GoalStatus.SUCCEEDED, "")
            else:
                self._end(GoalStatus.ABORTED, outcome.message)

    def _rest(self) -> None:
        self._motion.rest()
        self.is_moving = True

    def _begin(self, action: GripperAction, request: dict[str, float]) -> None:
        self._count += 1
        self.is_moving = True
        self._end(GoalStatus.PREEMPTED, f"A newer command took over: {action.value}.")
        self._command = GripperCommand(
            self._count,
            action,
            GoalStatus.ACTIVE,
            "",
            request,
            started=self._motor.read_time(),
        )

    def _end(self, status: GoalStatus, message: str) -> None:
        command, self._command = self._command, None
        if command is not None:
            ended = self._motor.read_time()
            self._last = replace(command, status=status, message=message, ended=ended)

    def _check_free(self) -> None:
        if self.owner is not None:
            raise GripperCommandError(
                f"The gripper of arm '{self.name}' takes no commands: controller "
                f"'{self.owner}' claims its fingers.",
                remedy=f"Stop '{self.owner}' first, or give it the goals.",
                details={"arm_id": self.name, "controller": self.owner},
            )
