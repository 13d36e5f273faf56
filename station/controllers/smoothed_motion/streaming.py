"""Follow positions that arrive 10 to 100 times a second, e.g. from a policy."""

from typing import ClassVar

from typing_extensions import override

from station.controllers.forward_command_controller import JointQuantity
from station.controllers.forward_command_controller.joint_set_point_controller import (
    CommandInterfaceT,
)
from station.controllers.smoothed_motion.smoothed_motion_controller import (
    SmoothedMotionController,
)


class JointStreamingControllerBase(SmoothedMotionController[CommandInterfaceT]):
    """Goes to the newest set-point on the fastest way the limits allow.

    A set-point is where to rest unless another one follows; all joints would arrive
    together. Set-points may arrive at any pace: the motion is smooth between them. When
    none arrives within `command_timeout`, the joints come to rest and hold.
    """

    quantity: ClassVar[JointQuantity] = JointQuantity.POSITION

    def __init__(self) -> None:
        super().__init__()
        self._followed: list[float] = []
        self._resting: list[float] = []

    @override
    def rest(self) -> list[float]:
        """Brake; return where that ends, shape (n,)."""
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
        if set_point is self._followed:
            return
        self._followed = set_point
        if set_point is self._resting:
            self.generator.brake()
        else:
            self.generator.go_to(set_point)
