"""The Franka hand's fingers in a MuJoCo world: they hold the width they are told."""

from math import sqrt

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
    """

    def __init__(
        self, world: World, finger_joint: str, *, width: float = OPEN_WIDTH
    ) -> None:
        self._finger = world.joints([finger_joint])
        # The second finger follows the first: the motor moves both.
        inertia = 2.0 * self._finger.read_inertia()[0]
        self._damping = 2.0 * sqrt(_STIFFNESS * inertia)
        self._step = _SPEED * world.timestep
        self._start_width = width
        self._force = 0.0
        self._is_pressing = True
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

    def hold(self, width: float) -> None:
        """Go to a width and stay there.

        Args:
            width: Distance between the fingers [m].
        """
        if self._is_pressing:
            self._finger.set_servo([_STIFFNESS], [self._damping])
            self._is_pressing = False
            self._place = self.read_position()
        self._target = width / 2.0

    def press(self, force: float) -> None:
        """Let the motor give a force, whatever the width becomes.

        Args:
            force: On each finger [N], > 0 opens.
        """
        if not self._is_pressing:
            self._finger.set_servo([0.0], [0.0])
            self._is_pressing = True
        self._force = force

    def before_step(self) -> None:
        """Set the motor's control."""
        if self._is_pressing:
            self._finger.set_controls([2.0 * self._force])
            return
        way = self._target - self._place
        self._place += min(max(way, -self._step), self._step)
        self._finger.set_controls([_STIFFNESS * self._place])

    def after_reset(self) -> None:
        """Hold the width of the beginning again."""
        self.hold(self._start_width)
        self._place = self.read_position()
