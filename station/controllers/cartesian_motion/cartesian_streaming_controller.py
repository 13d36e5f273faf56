"""Follow poses that arrive 10 to 100 times a second, e.g. from a policy."""

from collections.abc import Sequence

from typing_extensions import override

from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits
from station.controllers.cartesian_motion.cartesian_motion_controller import (
    LONGEST_TIMEOUT,
    CartesianMotionController,
)
from station.controllers.franka_arm import PosePort
from station.core.control.controller import ControllerSample
from station.core.franka import Frame
from station.core.franka.franka_robot_state import RobotState
from station.core.hardware.robot_hw import RobotHW
from station.core.numerics.rigid_motion import pose_of, quaternion_of
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointPort


class CartesianStreamingController(CartesianMotionController):
    """Moves to the newest pose as fast as the limits allow.

    A set-point is the pose of the end effector in the base frame O: position [m], then
    unit quaternion x y z w. The end effector would rest at this pose, and position and
    orientation would arrive together, unless another set-point follows. When no
    set-point arrives within `command_timeout`, the end effector comes to rest and
    holds.
    """

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        super().init(hw, params)
        self._followed: list[float] = []
        self._resting: list[float] = []
        self._target: list[float] = []
        self._quaternion = [0.0, 0.0, 0.0, 1.0]

    @override
    def make_port(self, limits: CartesianLimits, timeout: float) -> SetPointPort:
        return PosePort(
            "xyzw", tolerance=0.01, timeout=timeout, longest=LONGEST_TIMEOUT
        )

    @override
    def rest(self) -> list[float]:
        self._resting = _numbers(self.generator.resting_pose(), self._quaternion)
        return self._resting

    @override
    def steer(self, set_point: list[float]) -> None:
        if set_point is self._resting:
            self.generator.brake()
            return
        if set_point is not self._followed:
            self._followed = set_point
            self._target = pose_of(set_point[:3], set_point[3:])
        self.generator.go_to(self._target)

    @override
    def sample_of(self, time: float, state: RobotState) -> ControllerSample:
        desired = _numbers(self.generator.pose, self._quaternion)
        self._quaternion = desired[3:]
        actual = _numbers(self.model.get_pose(Frame.END_EFFECTOR), self._quaternion)
        errors = [d - a for d, a in zip(desired, actual, strict=True)]
        return ControllerSample(time, desired, actual, errors, desired)


def _numbers(pose: Sequence[float], near: list[float]) -> list[float]:
    """Return a pose in the form of a set-point, 7 numbers.

    Args:
        pose: The pose, 16 numbers, column-major.
        near: Of the two quaternions of the orientation, the one nearer to this
            quaternion is returned, so that samples do not jump.
    """
    x, y, z, w = quaternion_of(pose)
    a, b, c, d = near
    if x * a + y * b + z * c + w * d < 0.0:
        x, y, z, w = -x, -y, -z, -w
    return [*pose[12:15], x, y, z, w]
