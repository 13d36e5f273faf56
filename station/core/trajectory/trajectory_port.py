"""Where a controller takes trajectories for which nobody waits."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

from station.core.trajectory.quintic_spline_segment import PosVelAccState


class TrajectoryPort(ABC):
    """The topic `command` and the service `query_state` of a trajectory controller.

    All methods may be called from any thread.
    """

    @abstractmethod
    def follow(self, request: Mapping[str, object]) -> None:
        """Check a trajectory and let it replace the present one.

        Args:
            request: The message as JSON-compatible values.

        Raises:
            StationError: It cannot be followed; nothing changed.
        """

    @abstractmethod
    def hold(self) -> None:
        """End the motion in the next cycle and hold the joints."""

    @abstractmethod
    def query_state(self, time: float) -> PosVelAccState:
        """Return where the joints shall be at a station time [s].

        Raises:
            StationError: Nothing is known about that time.
        """
