"""Move an end effector at a twist while told to, or after poses that keep arriving.

Twists count for as long as they are repeated; poses arrive 10 to 100 times a second,
e.g. from a policy.
"""

from collections.abc import Mapping
from math import sqrt

from typing_extensions import override

from station.controllers.cartesian_motion.cartesian_limits import CartesianLimits
from station.controllers.cartesian_motion.cartesian_motion_controller import (
    LONGEST_TIMEOUT,
    CartesianMotionController,
)
from station.controllers.cartesian_motion.end_effector_sample import (
    PoseSample,
    TwistSample,
)
from station.controllers.franka_arm import PosePort
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import DeclaredParameter, declare_string
from station.core.errors import InvalidCommandError, InvalidGainError
from station.core.franka import Frame
from station.core.hardware.robot_hw import RobotHW
from station.core.numerics.poses import pose_of, to_outer_axes
from station.core.numerics.rigid_motion import numbers_of
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.memory.doubles import zeros

_ROUNDING = 1e-9


class TwistSetPointPort(SetPointPort):
    """Takes `vx vy vz` [m/s] and `wx wy wz` [rad/s]; each vector has a length limit.

    Args:
        limits: Limits of the lengths of both vectors.
        timeout: How long a set-point is valid [s].
        longest: Longest validity that a set-point may ask for [s].
    """

    def __init__(
        self, limits: CartesianLimits, *, timeout: float, longest: float
    ) -> None:
        v, w = limits.translation.velocity, limits.rotation.velocity
        super().__init__(
            [
                *(SetPointElement(f"v{axis}", "m/s", -v, v) for axis in "xyz"),
                *(SetPointElement(f"w{axis}", "rad/s", -w, w) for axis in "xyz"),
            ],
            timeout=timeout,
            longest=longest,
        )
        self._bounds = (v, w)

    @override
    def check_values(self, values: list[float]) -> None:
        """Refuse a malformed set-point, and a vector that is too long.

        Raises:
            InvalidCommandError: As in `SetPointPort.check`, or a vector is too long.
        """
        super().check_values(values)
        for part, bound, unit in zip(
            (values[:3], values[3:6]), self._bounds, ("m/s", "rad/s"), strict=True
        ):
            length = sqrt(sum(value * value for value in part))
            if length > bound * (1.0 + _ROUNDING):
                raise InvalidCommandError(
                    f"The velocity {part} of the command is {length:.4g} {unit} long; "
                    f"allowed is at most {bound} {unit}.",
                    remedy="Divide the three numbers by the same factor.",
                    details={"length": length, "maximum": bound},
                )


FRAMES = ("O", "EE")
"""Axes in which a twist may be given: of the base O, or of the end effector EE."""
_FRAME = declare_string(
    "frame",
    "axes in which the twist is given: `O` (base) or `EE` (end effector)",
    FRAMES[0],
    choices=FRAMES,
)


class CartesianJogController(CartesianMotionController):
    """Moves the end effector at the twist of the set-point, while a button is held.

    A set-point is the velocity of the end effector's origin [m/s] and the angular
    velocity [rad/s]. Every set-point is a heartbeat: when no set-point arrives within
    `command_timeout`, or the set-point is zero, the end effector comes to rest.

    Parameters: those of the base class, and `frame`, `O` or `EE`, the axes in which
    set-points are given. The run-time parameter `frame` is 0 for `O` and 1 for `EE`.
    """

    cycle_sample: TwistSample

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (*super().declared_parameters(), _FRAME)

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        super().init(hw, params)
        frame = float(FRAMES.index(_FRAME.read_str(params)))
        text = "axes of the twist: 0 of the base, 1 of the end effector"
        self.tunables = Tunables(
            {_FRAME.name: Tunable("", 0.0, 1.0, text)},
            {_FRAME.name: frame},
            check=_check_frame,
            apply=self._set_frame,
        )
        self._set_frame({_FRAME.name: frame})

    @override
    def make_port(self, limits: CartesianLimits, timeout: float) -> SetPointPort:
        return TwistSetPointPort(limits, timeout=timeout, longest=LONGEST_TIMEOUT)

    @override
    def rest(self) -> list[float]:
        return [0.0] * 6

    @override
    def steer(self, set_point: list[float]) -> bool:
        is_inner = self.cycle_sample.is_inner
        if is_inner:
            set_point = to_outer_axes(self.generator.pose, set_point)
        self.generator.go_at(set_point)
        return not is_inner

    @override
    def make_sample(self) -> TwistSample:
        frame = Frame.END_EFFECTOR
        return TwistSample(
            self.generator.pose,
            self.generator.twist,
            self.model.pose_source(frame),
            self.model.zero_jacobian_source(frame),
            self.handle.get_robot_state().doubles("dq"),
        )

    def _set_frame(self, values: Mapping[str, float]) -> None:
        self.cycle_sample.is_inner = values[_FRAME.name] != 0.0
        self._update.steered = None


def _check_frame(values: Mapping[str, float]) -> None:
    if values[_FRAME.name] not in {0.0, 1.0}:
        raise InvalidGainError(
            f"Gain '{_FRAME.name}' is {values[_FRAME.name]}; it must be 0 or 1.",
            remedy="Send 0 for the axes of the base, 1 for the end effector's.",
        )


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
