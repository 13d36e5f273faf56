"""The torques that a load configured with `set_load` needs of the motors."""

from collections.abc import Sequence

from station.core.description.robot_files import RobotFiles
from station.core.franka.franka_model import GRAVITY_EARTH
from station.hw.franka.arm.load import Load
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics

_NO_LOAD = Load()


class ArmLoad:
    """The additional motor torques for the load that a client has configured.

    Without a configured load nothing is computed. Control thread only.

    Args:
        description: The URDF of the arm.
        gravity: Acceleration of gravity in the base frame [m/s^2], shape (3,).
    """

    def __init__(
        self,
        description: RobotFiles,
        gravity: Sequence[float] = GRAVITY_EARTH,
    ) -> None:
        # Two models: changing the load of one costs more than evaluating it.
        self._bare = FrankaDynamics(description)
        self._loaded = FrankaDynamics(description)
        self._gravity = tuple(gravity)
        self.load = _NO_LOAD

    def weight(self, q: Sequence[float]) -> list[float]:
        """Return the torques that carry the load's weight [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
        """
        with_load = self._loaded.gravity(q, self.load, self._gravity)
        without = self._bare.gravity(q, _NO_LOAD, self._gravity)
        return [a - b for a, b in zip(with_load, without, strict=True)]

    def torques(
        self, q: Sequence[float], dq: Sequence[float], ddq: Sequence[float]
    ) -> list[float]:
        """Return the torques that carry and move the load [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
            ddq: Joint accelerations [rad/s^2], shape (7,).
        """
        with_load = self._loaded.torques(q, dq, ddq, self.load, self._gravity)
        without = self._bare.torques(q, dq, ddq, _NO_LOAD, self._gravity)
        return [a - b for a, b in zip(with_load, without, strict=True)]
