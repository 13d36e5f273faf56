"""Follow poses that arrive 10 to 100 times a second, e.g. from a policy."""

from typing_extensions import override

from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits
from station.controllers.cartesian_motion.cartesian_motion_controller import (
    LONGEST_TIMEOUT,
    CartesianMotionController,
)
from station.controllers.cartesian_motion.end_effector_sample import PoseSample
from station.controllers.franka_arm import PosePort
from station.core.franka import Frame
from station.core.hardware.robot_hw import RobotHW
from station.core.numerics.poses import pose_of
from station.core.numerics.rigid_motion import numbers_of
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointPort
from station.memory.doubles import zeros


class CartesianStreamingController(CartesianMotionController):
    """Moves to the newest pose as fast as the limits allow.

    A set-point is the pose of the end effector in the base frame O: position [m], then
    unit quaternion x y z w. The end effector would rest at this pose, and position and
    orientation would arrive together, unless another set-point follows. When no
    set-point arrives within `command_timeout`, the end effector comes to rest and
    holds.
    """

    cycle_sample: PoseSample

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        super().init(hw, params)
        self._resting: list[float] = []

    @override
    def make_sample(self) -> PoseSample:
        source = self.model.pose_source(Frame.END_EFFECTOR)
        return PoseSample(self.generator.pose, source)

    @override
    def make_port(self, limits: CartesianLimits, timeout: float) -> SetPointPort:
        return PosePort(
            "xyzw", tolerance=0.01, timeout=timeout, longest=LONGEST_TIMEOUT
        )

    @override
    def rest(self) -> list[float]:
        resting = zeros(7)
        near = self.cycle_sample.near
        numbers_of(self.generator.resting_pose(), near, resting)
        self._resting = [*resting]
        return self._resting

    @override
    def steer(self, set_point: list[float]) -> bool:
        if set_point is self._resting:
            self.generator.brake()
        else:
            self.generator.go_to(pose_of(set_point[:3], set_point[3:]))
        return True
