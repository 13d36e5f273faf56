"""The motions of the fingers of a hand: moves, grasps, homing and rest.

Source: franka_ros@c11f000 franka_gazebo/src/franka_gripper_sim.cpp; differs:

- Both fingers together are one motion, and the fingers' motor is a servo with a limit
  on its force.
- Each finger presses with the whole force of a grasp, so that the object feels this
  force from either side; upstream gives each finger half of the force.
- Fingers are at rest when they have been slow for a time, not for a number of samples;
  the threshold is lower in a slow motion.
- A grasp of an object that is between the fingers already does not open them, and a
  grasp that opens the fingers ends in the same way as a grasp that closes them.
- A stop brakes the fingers, ends their force, and then holds their width.
- Homing ends at the first end of the range that the fingers do not reach.
"""

from dataclasses import dataclass
from typing import Protocol

from station.core.franka import GraspRequest, GripperActivity

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
# A servo comes to the closed end by rounding alone, 1e-13 m; pressed, to 0. Counted as
# a width it would be inside of an epsilon that begins at 0, and nothing was grasped.
_CLOSED = 1e-6
# Share of the commanded speed: a slow motion may be below `REST_SPEED` all the way.
_SLOWEST_PART = 0.25
_RESTING = (GripperActivity.IDLE, GripperActivity.HOLDING)


class GripperMotor(Protocol):
    """The motor that moves the fingers; see `SimulatedGripper`."""

    def read_position(self) -> float:
        """Return the distance of each finger from the middle [m]."""

    def read_velocity(self) -> float:
        """Return the velocity of each finger [m/s]."""

    def read_time(self) -> float:
        """Return the time of the motor [s]; never goes back."""

    def hold(self, width: float, *, speed: float, force: float | None) -> None:
        """Go to a width and stay there."""

    def press(self, force: float, *, is_damped: bool) -> None:
        """Let the motor give a force."""


@dataclass(frozen=True, slots=True)
class GripperOutcome:
    """The outcome of a motion.

    Attributes:
        message: Why the motion did not reach its aim; None if it did.
    """

    message: str | None = None


_DONE = GripperOutcome()


class GripperMotion:
    """One motion of the fingers at a time. Control thread.

    Args:
        motor: The motor that moves the fingers.
        max_width: Distance between the open fingers [m].

    Attributes:
        activity: The present activity of the fingers.
        max_width: As given; after a homing, the width that the homing has measured.
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
        """Return the distance between the fingers [m]; 0 where they touch."""
        width = 2.0 * self._motor.read_position()
        return width if width > _CLOSED else 0.0

    def is_grasped(self) -> bool:
        """Return whether an object of the expected width is held."""
        is_holding = self.activity is GripperActivity.HOLDING
        return is_holding and self._grasp.accepts(self.width())

    def home(self) -> None:
        """Begin to close and then to open all the way."""
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
        """Return whether nothing is left to do for `advance`."""
        return self.activity in _RESTING and not self._settles

    def advance(self) -> GripperOutcome | None:
        """Continue the motion from the present state of the fingers; once per cycle.

        Returns:
            How the motion ended, in the cycle in which the motion ends; else None.
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
        # Fingers that have not begun to move are slow as well: the time runs from now.
        self._still_since = self._motor.read_time()
        self._hold(width, speed, force)

    def _hold(self, width: float, speed: float, force: float) -> None:
        self._motor.hold(width, speed=speed, force=force)

    def _stands_still(self) -> bool:
        now = self._motor.read_time()
        if 2.0 * abs(self._motor.read_velocity()) > self._slow:
            self._still_since = now
        return now - self._still_since >= REST_DURATION
