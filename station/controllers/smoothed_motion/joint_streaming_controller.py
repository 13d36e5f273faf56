"""Follow positions that arrive 10 to 100 times a second, e.g. from a policy."""

from typing import ClassVar

from typing_extensions import override

from station.controllers.set_point_controller import CommandInterfaceT, JointQuantity
from station.controllers.smoothed_motion.smoothed_motion_controller import (
    SmoothedMotionController,
)
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
)


class JointStreamingController(SmoothedMotionController[CommandInterfaceT]):
    """Moves to the newest set-point on the fastest way that the limits allow.

    The joints would rest at a set-point and all arrive there together, unless another
    set-point replaces it. Set-points may arrive at any rate; the motion between them is
    smooth. When no set-point arrives within `command_timeout`, the joints come to rest
    and hold.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION

    def __init__(self) -> None:
        super().__init__()
        self._followed: list[float] = []
        self._resting: list[float] = []

    @override
    def rest(self) -> list[float]:
        """Return the positions at which the joints rest if they brake now, (n,)."""
        self._resting = self.generator.resting_positions()
        return self._resting

    @override
    def heading(self, set_point: list[float]) -> list[float]:
        here = self.generator.positions
        return [there - now for there, now in zip(set_point, here, strict=True)]

    @override
    def wait(self) -> None:
        self._followed = []
        super().wait()

    @override
    def steer(self, set_point: list[float], period: float) -> None:
        # Set-points are replaced, never changed: an identical list is the same target.
        if set_point is self._followed:
            return
        self._followed = set_point
        if set_point is self._resting:
            self.generator.brake()
        else:
            self.generator.go_to(set_point)


class PositionJointStreamingController(
    JointStreamingController[PositionJointInterface]
):
    """Follows streamed positions by position commands."""


class EffortJointStreamingController(JointStreamingController[EffortJointInterface]):
    """Follows streamed positions by effort commands."""
