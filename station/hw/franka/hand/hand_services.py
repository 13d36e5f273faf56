"""The services of a simulated hand: its commands, their checks, and their results."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
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
from station.hw.franka.hand.hand_limits import check_grasp, check_move
from station.memory.doubles import Doubles

MOVE_TOLERANCE = 0.001
"""Distance from the commanded width at which a move has arrived [m]."""
REST_SPEED = 0.003
"""Rate of the width below which the fingers count as at rest [m/s]."""
REST_DURATION = 0.1
"""Time for which the fingers must be slow before they count as at rest [s]."""
MOVE_FORCE = 70.0
"""Largest force of a finger during a move [N]. Source: continuous force in the
datasheet of the Franka Hand."""
HOMING_SPEED = 0.02
# Width below which the fingers count as closed [m]. A servo reaches the closed end with
# a rounding error of 1e-13 m, and pressed fingers reach 0. Otherwise this width could
# lie within an epsilon that begins at 0, although no object was grasped.
_CLOSED = 1e-6
# Share of the commanded speed below which fingers are at rest, if it is less than
# `REST_SPEED`: a slow motion may be below `REST_SPEED` all the time.
_SLOWEST_PART = 0.25
_RESTING = (GripperActivity.IDLE, GripperActivity.HOLDING)


class GripperMotor(Protocol):
    """The motor that moves the fingers; see `SimulatedGripper`."""

    def read_position(self) -> float:
        """Return the distance of each finger from the middle [m]."""

    def read_velocity(self) -> float:
        """Return the velocity of each finger [m/s]."""

    def read_time(self) -> float:
        """Return the time of the motor [s]; never decreases."""

    def hold(self, width: float, *, speed: float, force: float | None) -> None:
        """Go to a width and hold it."""

    def press(self, force: float, *, is_damped: bool) -> None:
        """Make the motor give a force."""


@dataclass(frozen=True, slots=True)
class GripperOutcome:
    """The outcome of a motion.

    Attributes:
        message: Why the motion missed its aim; None if it did not.
    """

    message: str | None = None


_DONE = GripperOutcome()


class GripperMotion:
    """One motion of the fingers at a time: moves, grasps, homing. Control thread.

    Source:
        franka_ros@c11f000 franka_gazebo/src/franka_gripper_sim.cpp; differs:

        - Both fingers together are one motion, and the fingers' motor is a servo with a
          limit on its force.
        - Each finger presses with the whole force of a grasp, so that the object feels
          this force from either side; upstream gives each finger half of the force.
        - Fingers are at rest when they have been slow for a time, not for a number of
          samples; the threshold is lower in a slow motion.
        - A grasp does not open the fingers if the object is between them already, and a
          grasp that opens the fingers ends in the same way as one that closes them.
        - A stop brakes the fingers, ends their force, and then holds their width.
        - Homing ends at the first end of the range that the fingers do not reach.

    Args:
        motor: The motor that moves the fingers.
        max_width: Distance between the open fingers [m].

    Attributes:
        activity: The present activity of the fingers.
        max_width: As given; after a homing, the width that the homing measured.
    """

    def __init__(self, motor: GripperMotor, max_width: float) -> None:
        self._motor = motor
        self._open_width = max_width
        self.max_width = max_width
        self.activity = GripperActivity.IDLE
        self._target = 0.0
        self._slow = REST_SPEED
        self._still_since = 0.0
        self._settles = False
        self._pressing_force = 0.0
        self._grasp = GraspRequest(0.0, 0.0)

    def width(self) -> float:
        """Return the distance between the fingers [m]; 0 if they touch."""
        width = 2.0 * self._motor.read_position()
        return width if width > _CLOSED else 0.0

    def is_grasped(self) -> bool:
        """Return whether an object of the expected width is held."""
        is_holding = self.activity is GripperActivity.HOLDING
        return is_holding and self._grasp.accepts(self.width())

    def home(self) -> None:
        """Begin to close and then open all the way."""
        self._go(GripperActivity.HOMING, 0.0, HOMING_SPEED, MOVE_FORCE)

    def move(self, width: float, speed: float) -> None:
        """Begin to go to a width.

        Args:
            width: Distance between the fingers [m].
            speed: Rate at which the width changes, > 0 [m/s].
        """
        self._go(GripperActivity.MOVING, width, speed, MOVE_FORCE)

    def grasp(self, request: GraspRequest) -> None:
        """Begin to close, or to open if the fingers are too close, until blocked."""
        opens = self.width() <= request.width - request.epsilon_inner
        self._grasp = request
        self._pressing_force = request.force if opens else -request.force
        end = self._open_width if opens else 0.0
        self._go(GripperActivity.GRASPING, end, request.speed, request.force)

    def rest(self) -> None:
        """Brake, end the force, and hold the width at which the fingers stop."""
        self.activity = GripperActivity.IDLE
        self._settles = True
        self._slow = REST_SPEED
        self._still_since = self._motor.read_time()
        self._motor.press(0.0, is_damped=True)

    def give_up(self) -> None:
        """End the motion without a command to the motor: a controller takes over."""
        self.activity = GripperActivity.IDLE
        self._settles = False

    def is_over(self) -> bool:
        """Return whether `advance` has nothing left to do."""
        return self.activity in _RESTING and not self._settles

    def advance(self) -> GripperOutcome | None:
        """Continue the motion from the present state of the fingers; once per cycle.

        Returns:
            How the motion ended, if it ends in this cycle; else None.
        """
        match self.activity:
            case GripperActivity.MOVING:
                return self._advance_move()
            case GripperActivity.GRASPING:
                return self._advance_grasp() if self._stands_still() else None
            case GripperActivity.HOMING:
                return self._advance_homing() if self._stands_still() else None
            case _:
                if self._settles and self._stands_still():
                    self._settles = False
                    self._hold(self.width(), 2.0 * HOMING_SPEED, MOVE_FORCE)
                return None

    def _advance_move(self) -> GripperOutcome | None:
        if abs(self.width() - self._target) <= MOVE_TOLERANCE:
            self.activity = GripperActivity.IDLE  # the servo does the rest
            return _DONE
        return self._fail_blocked() if self._stands_still() else None

    def _advance_grasp(self) -> GripperOutcome:
        grasp, width = self._grasp, self.width()
        if grasp.accepts(width):
            self.activity = GripperActivity.HOLDING
            self._motor.press(self._pressing_force, is_damped=True)
            return _DONE
        self.rest()
        return GripperOutcome(
            f"The fingers came to rest at {width:.4f} m; expected was more than "
            f"{grasp.width - grasp.epsilon_inner:.4f} and less than "
            f"{grasp.width + grasp.epsilon_outer:.4f} m.",
        )

    def _advance_homing(self) -> GripperOutcome | None:
        if abs(self.width() - self._target) > MOVE_TOLERANCE:
            return self._fail_blocked()
        if self._target == 0.0:
            end = self._open_width
            self._go(GripperActivity.HOMING, end, HOMING_SPEED, MOVE_FORCE)
            return None
        self.max_width = self.width()
        self.activity = GripperActivity.IDLE
        return _DONE

    def _fail_blocked(self) -> GripperOutcome:
        width = self.width()
        self.rest()
        return GripperOutcome(
            f"Something blocks the fingers at {width:.4f} m, on their way to "
            f"{self._target:.4f} m.",
        )

    def _go(
        self, activity: GripperActivity, width: float, speed: float, force: float
    ) -> None:
        self.activity = activity
        self._settles = False
        self._target = width
        self._slow = min(REST_SPEED, _SLOWEST_PART * speed)
        # Fingers that have not begun to move are slow, too: the time counts from now.
        self._still_since = self._motor.read_time()
        self._hold(width, speed, force)

    def _hold(self, width: float, speed: float, force: float) -> None:
        self._motor.hold(width, speed=speed, force=force)

    def _stands_still(self) -> bool:
        now = self._motor.read_time()
        if 2.0 * abs(self._motor.read_velocity()) > self._slow:
            self._still_since = now
        return now - self._still_since >= REST_DURATION


ROOM_TEMPERATURE = 20.0
"""Temperature of a simulated hand [degree Celsius]."""


class FingerSensor(Protocol):
    """Reads the fingers."""

    def read(self) -> None:
        """Bring the readings up to date."""


class HandMotor(GripperMotor, Protocol):
    """A motor that also reports its range and its force.

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
        """Return an object that reads each finger's position, velocity and force."""


class HandCommands:
    """The present command of a hand, and the last one. Control thread only.

    Args:
        read_time: Returns the time of the hand [s].

    Attributes:
        present: The command that runs; None without one.
        last: The last command that ended; None if there is none.
    """

    def __init__(self, read_time: Callable[[], float]) -> None:
        self._read_time = read_time
        self._count = 0
        self.present: GripperCommand | None = None
        self.last: GripperCommand | None = None

    def begin(self, action: GripperAction, request: dict[str, float]) -> None:
        """Note that a command begins, which ends the present one."""
        self.end(GoalStatus.PREEMPTED, f"A newer command took over: {action.value}.")
        self._count += 1
        status, started = GoalStatus.ACTIVE, self._read_time()
        self.present = GripperCommand(self._count, action, status, "", request, started)

    def end(self, status: GoalStatus, message: str) -> None:
        """Note how the present command has ended, if there is one."""
        command, self.present = self.present, None
        if command is not None:
            ended = self._read_time()
            self.last = replace(command, status=status, message=message, ended=ended)


class HandServices(GripperServices):
    """The services of a simulated hand. Control thread only.

    Args:
        arm_id: The arm with this hand.
        motor: The motor of the fingers.

    Attributes:
        owner: The controller that claims the fingers; None without such a controller.
        is_moving: Whether `advance` may have work to do.
    """

    def __init__(self, arm_id: str, motor: HandMotor) -> None:
        super().__init__(arm_id)
        self._motor = motor
        self._open_width = 2.0 * motor.limits[1]
        self._motion = GripperMotion(motor, self._open_width)
        self._commands = HandCommands(motor.read_time)
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
            command=self._commands.present,
            last=self._commands.last,
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
        self._commands.end(GoalStatus.PREEMPTED, "The gripper was told to stop.")
        # A controller that owns the fingers continues to command them.
        if self.owner is None:
            self._rest()

    @override
    def interrupt(self, reason: str) -> None:
        if self._commands.present is not None:
            self._commands.end(GoalStatus.PREEMPTED, reason)
            self._rest()

    def give_to(self, owner: str | None) -> None:
        """Give the fingers to a controller, or take them back.

        Args:
            owner: Name of the controller; None if no controller claims the fingers.
        """
        if owner is not None and owner != self.owner:
            self._commands.end(
                GoalStatus.PREEMPTED, f"Controller '{owner}' took the fingers."
            )
            self._motion.give_up()
        self.owner = owner

    def begin_anew(self) -> None:
        """End the present command, because the world was reset."""
        self._commands.end(
            GoalStatus.PREEMPTED, "A reset put the hand back to its start."
        )
        self._motion.give_up()

    def advance(self) -> None:
        """Continue the present motion; once per cycle."""
        motion = self._motion
        outcome = None if motion.is_over() else motion.advance()
        self.is_moving = not motion.is_over()
        if outcome is not None:
            if outcome.message is None:
                self._commands.end(GoalStatus.SUCCEEDED, "")
            else:
                self._commands.end(GoalStatus.ABORTED, outcome.message)

    def _rest(self) -> None:
        self._motion.rest()
        self.is_moving = True

    def _begin(self, action: GripperAction, request: dict[str, float]) -> None:
        self.is_moving = True
        self._commands.begin(action, request)

    def _check_free(self) -> None:
        if self.owner is not None:
            raise GripperCommandError(
                f"The gripper of arm '{self.name}' takes no commands: controller "
                f"'{self.owner}' claims its fingers.",
                remedy=f"Stop '{self.owner}' first, or give it the goals.",
                details={"arm_id": self.name, "controller": self.owner},
            )
