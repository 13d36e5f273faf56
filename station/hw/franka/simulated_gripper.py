"""The Franka hand's fingers in a MuJoCo world: they hold the width they are told."""

from math import sqrt

from station.hw.mujoco.world import World

OPEN_WIDTH = 0.08
"""Distance between the fingers when the hand is open [m]. Source: the limits of the
finger joints in panda.urdf, 0.04 m each."""
_STIFFNESS = 5000.0


class SimulatedGripper:
    """Holds the fingers in place, and their weight with them.

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
        self._finger.set_servo([_STIFFNESS], [2.0 * sqrt(_STIFFNESS * inertia)])
        self._width = width
        world.add_actor(self)

    def before_step(self) -> None:
        """Set the motor's control."""
        self._finger.set_controls([_STIFFNESS * self._width / 2.0])

    def after_reset(self) -> None:
        """Nothing to do: the width is held again."""
