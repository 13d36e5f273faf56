"""The Franka hand's fingers in a MuJoCo world: they hold the width they are told."""

from math import nan, sqrt

from station.hw.franka.hand.hand_services import MAX_FORCE
from station.hw.mujoco.world import World

OPEN_WIDTH = 0.08
"""Distance between the fingers when the hand is open [m]. Source: the limits of the
finger joints in panda.urdf, 0.04 m each."""
_STIFFNESS = 5000.0
_SPEED = 0.2
"""How fast each finger goes to its place [m/s]. Source: the velocity limit of the
finger joints in panda.urdf."""


class SimulatedGripper:
    """Holds the fingers in place, or presses as strongly as it is told.

    The two fingers move as one: the second follows the first.

    Args:
        world: The world; its gravity compensation covers the fingers.
        finger_joint: The driven finger joint; the other one mimics it.
        width: Distance between the fingers [m], 0 to `OPEN_WIDTH`.

    Attributes:
        effort_limit: What the URDF lets the motor give each finger [N].
    """

    def __init__(
        self, world: World, finger_joint: str, *, width: float = OPEN_WIDTH
    ) -> None:
        self._world = world
        self._finger = world.joints([finger_joint])
        # The second finger follows the first: the motor moves both.
        inertia = 2.0 * self._finger.read_inertia()[0]
        self._damping = 2.0 * sqrt(_STIFFNESS * inertia)
        self.effort_limit = self._finger.effort_limits[0] / 2.0
        self._finger.set_effort_limits([2.0 * MAX_FORCE])
        self._start_width = width
        self._force = 0.0
        self._step = self._reach = 0.0
        self._servo = (0.0, 0.0)
        self._control = nan
        self._target = self._place = 0.0
        self.hold(width)
        world.add_actor(self)

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest position of a finger [m]."""
        return self._finger.lower_limits[0], self._finger.upper_limits[0]

    def read_position(self) -> float:
        """Return how far each finger is from the middle [m]."""
        return self._finger.read_positions()[0]

    def read_velocity(self) -> float:
        """Return how fast each finger moves [m/s], > 0 when opening."""
        return self._finger.read_velocities()[0]

    def read_force(self) -> float:
        """Return what the motor gave each finger in the last step [N]."""
        return self._finger.read_motor_forces()[0] / 2.0

    def read_time(self) -> float:
        """Return for how long the world has moved [s]; a reset does not change it."""
        return self._world.step_count * self._world.timestep

    def hold(
        self, width: float, *, speed: float = 2.0 * _SPEED, force: float | None = None
    ) -> None:
        """Go to a width and stay there.

        Args:
            width: Distance between the fingers [m].
            speed: How fast the width changes, > 0 [m/s].
            force: What each finger presses with at most, > 0 [N]; `effort_limit` when
                None.
        """
        if not self._servo[0]:
            self._set_servo(_STIFFNESS, self._damping)
            self._place = self.read_position()
        self._step = speed / 2.0 * self._world.timestep
        # A place out of reach would be a larger force, and grow while blocked.
        self._reach = 2.0 * (self.effort_limit if force is None else force) / _STIFFNESS
        self._target = width / 2.0

    def press(self, force: float, *, is_damped: bool = False) -> None:
        """Let the motor give a force, whatever the width becomes.

        Args:
            force: On each finger [N], > 0 opens.
            is_damped: Brake the fingers' motion.
        """
        self._set_servo(0.0, self._damping if is_damped else 0.0)
        self._force = force

    def before_step(self) -> None:
        """Set the motor's control."""
        if not self._servo[0]:
            self._set_control(2.0 * self._force)
            return
        way = self._target - self._place
        place = self._place + min(max(way, -self._step), self._step)
        position = self.read_position()
        self._place = min(max(place, position - self._reach), position + self._reach)
        self._set_control(_STIFFNESS * self._place)

    def _set_control(self, control: float) -> None:
        # The motor keeps its control, so most steps of fingers at rest set nothing.
        if control != self._control:
            self._finger.set_controls([control])
            self._control = control

    def after_reset(self) -> None:
        """Hold the width of the beginning again."""
        self._control = nan  # the reset of the world has cleared it
        self.hold(self._start_width)
        self._place = self.read_position()

    def _set_servo(self, stiffness: float, damping: float) -> None:
        if (stiffness, damping) != self._servo:
            self._finger.set_servo([stiffness], [damping])
            self._servo = (stiffness, damping)
