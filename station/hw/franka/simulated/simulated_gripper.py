"""The fingers of a Franka hand in a MuJoCo world."""

from math import sqrt

from station.hw.franka.hand.hand_limits import MAX_FORCE, OPEN_WIDTH
from station.hw.franka.simulated.finger_motor import FingerMotor, FingerSensor
from station.hw.mujoco.world import World
from station.memory.doubles import Doubles

_STIFFNESS = 5000.0
_SPEED = 0.2
"""Largest velocity of each finger [m/s]. Source: the velocity limit of the
finger joints in panda.urdf."""


class SimulatedGripper:
    """Holds the fingers at a width, or presses with a given force.

    The second finger mimics the first finger.

    Args:
        world: The world; its gravity compensation covers the fingers.
        finger_joint: The driven finger joint; the other finger joint mimics this one.
        width: Distance between the fingers [m], 0 to `OPEN_WIDTH`.

    Attributes:
        effort_limit: Largest force of the motor on each finger, from the URDF [N].
    """

    def __init__(
        self, world: World, finger_joint: str, *, width: float = OPEN_WIDTH
    ) -> None:
        self._world = world
        self._finger = world.joints([finger_joint])
        # The second finger follows the first, so the motor moves both.
        inertia = 2.0 * self._finger.read_inertia()[0]
        self._damping = 2.0 * sqrt(_STIFFNESS * inertia)
        self.effort_limit = self._finger.effort_limits[0] / 2.0
        self._finger.set_effort_limits([2.0 * MAX_FORCE])
        self._start_width = width
        self._memory = self._finger.simulator_memory()
        self._motor = FingerMotor(self._memory)
        self._servo = (0.0, 0.0)
        self.hold(width)
        world.add_actor(self, self._motor)

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest position of a finger [m]."""
        return self._finger.lower_limits[0], self._finger.upper_limits[0]

    def read_position(self) -> float:
        """Return the distance of each finger from the middle [m]."""
        return self._memory.positions[0]

    def read_velocity(self) -> float:
        """Return the velocity of each finger [m/s], > 0 when opening."""
        return self._memory.velocities[0]

    def read_force(self) -> float:
        """Return the force of the motor on each finger in the last step [N]."""
        return self._memory.motor_forces[0] / 2.0

    def sensor(
        self, positions: Doubles, velocities: Doubles, efforts: Doubles
    ) -> FingerSensor:
        """Return a reader that copies the fingers into memory; see `FingerSensor`."""
        return FingerSensor(self._memory, positions, velocities, efforts)

    def read_time(self) -> float:
        """Return the simulated time since the world was made [s], resets included."""
        return self._world.step_count * self._world.timestep

    def hold(
        self, width: float, *, speed: float = 2.0 * _SPEED, force: float | None = None
    ) -> None:
        """Go to a width and hold it.

        Args:
            width: Distance between the fingers [m].
            speed: Rate at which the width changes, > 0 [m/s].
            force: Largest force of each finger, > 0 [N]; None takes `effort_limit`.
        """
        motor = self._motor
        # After a force the servo starts from the present position, without a jump.
        if not self._servo[0]:
            self._set_servo(_STIFFNESS, self._damping)
            motor.place = self.read_position()
        motor.step = speed / 2.0 * self._world.timestep
        # A target farther ahead would press blocked fingers more and more.
        motor.reach = 2.0 * (self.effort_limit if force is None else force) / _STIFFNESS
        motor.target = width / 2.0

    def press(self, force: float, *, is_damped: bool = False) -> None:
        """Make the motor give a force, whatever the width.

        Args:
            force: Force on each finger [N], > 0 opens.
            is_damped: Whether to damp the motion of the fingers.
        """
        self._set_servo(0.0, self._damping if is_damped else 0.0)
        self._motor.force = 2.0 * force

    def after_reset(self) -> None:
        """Hold the initial width again."""
        self.hold(self._start_width)
        self._motor.place = self.read_position()

    def _set_servo(self, stiffness: float, damping: float) -> None:
        if (stiffness, damping) != self._servo:
            self._finger.set_servo([stiffness], [damping])
            self._servo = (stiffness, damping)
            self._motor.stiffness = stiffness
