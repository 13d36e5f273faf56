"""The torques that a load configured with `set_load` needs of the motors."""

from collections.abc import Sequence

from station.core.franka.franka_model import GRAVITY_EARTH
from station.hw.franka.arm.load import Load
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics


class ArmLoad:
    """The additional motor torques for the load that a client has configured.

    Without a configured load nothing is computed. Control thread only.

    Args:
        gravity: Acceleration of gravity in the base frame [m/s^2], shape (3,).

    Attributes:
        load: The configured load.
    """

    def __init__(self, gravity: Sequence[float] = GRAVITY_EARTH) -> None:
        # Torques add up over bodies: these are of an arm of which nothing else weighs.
        self._dynamics = FrankaDynamics(None)
        self._gravity = tuple(gravity)
        self.load = Load()

    def weight(self, q: Sequence[float]) -> list[float]:
        """Return the torques that carry the load's weight [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
        """
        return self._dynamics.gravity(q, self.load, self._gravity)

    def torques(
        self, q: Sequence[float], dq: Sequence[float], ddq: Sequence[float]
    ) -> list[float]:
        """Return the torques that carry and move the load [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
            ddq: Joint accelerations [rad/s^2], shape (7,).
        """
        return self._dynamics.torques(q, dq, ddq, self.load, self._gravity)
