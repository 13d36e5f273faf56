"""The port of a controller for trajectories that report no result."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

from station.core.ports.receipt import Receipt
from station.core.trajectory.quintic_spline_segment import PosVelAccState


class TrajectoryPort(ABC):
    """The topic `command` and the service `query_state` of a trajectory controller.

    All methods may be called from any thread.
    """

    @abstractmethod
    def follow_trajectory(
        self, request: Mapping[str, object], receipt: Receipt | None = None
    ) -> None:
        """Check a trajectory and let it replace the present one.

        Args:
            request: The message as JSON-compatible values.
            receipt: Notes the cycle that takes the trajectory.

        Raises:
            StationError: The trajectory cannot be followed; nothing changed.
        """

    @abstractmethod
    def hold(self, receipt: Receipt | None = None) -> None:
        """End the motion in the next cycle and hold the joints.

        Args:
            receipt: Notes the cycle that takes the request.
        """

    @abstractmethod
    def query_state(self, time: float) -> PosVelAccState:
        """Return the desired state of the joints at a time.

        Args:
            time: Station time [s].

        Raises:
            StationError: The controller knows no state at that time.
        """
