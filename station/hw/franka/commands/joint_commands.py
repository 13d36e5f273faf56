"""The arm's joint interfaces: command buffers, their handles, and their limits."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from station.core.description.urdf import Joint
from station.core.franka.franka_robot_state import RobotState
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.limits import (
    JointLimits,
    JointLimitsHandle,
    JointLimitsInterface,
    LimitMode,
    SoftJointLimits,
    make_limits_handle,
)
from station.core.hardware.robot_report import (
    ClampReport,
    JointLimitsReport,
    report_clamps,
)
from station.hw.franka.arm.arm_limits import MotionLimits
from station.hw.franka.arm.control_mode import ControlMode
from station.memory.doubles import Block, Doubles, put
from station.memory.vectors import FiniteCheck

_DOF = 7
# All commands are in one memory, because in every cycle the manager writes them with
# one call for each memory.
_SIZES = {
    "pose": 16,
    "twist": 6,
    "positions": _DOF,
    "velocities": _DOF,
    "efforts": _DOF,
    "pose_elbow": 2,
    "twist_elbow": 2,
}
# Distance from the ends of its range at which a rate-limited joint stops [rad]. The
# low-pass filter behind the limits lags: a joint that stops exactly at the end would
# pass it, and the arm raises an error for any position beyond its range.
_RANGE_MARGIN = 2e-3
_SOURCES = {
    "position": "urdf limit",
    "velocity": "urdf limit",
    "acceleration": "rate limits of the arm",
    "jerk": "rate limits of the arm",
    "effort": "urdf limit",
    "soft": "urdf safety_controller",
}


class JointCommands:
    """Joint state and command handles of one arm.

    Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp,
    FrankaHW::setupJointStateInterface, setupJointCommandInterface,
    setupLimitInterface, enforceLimits, reset; differs: `limit_mode` chooses the limits.

    Args:
        state: The arm's state, whose lists the handles read.
        names: Names of the 7 joints, from base to flange.
        limit_mode: How commands are limited.

    Attributes:
        memory: All commands of the arm, including those of its end effector.
        positions: Commanded positions [rad], shape (7,), changed in place.
        velocities: Commanded velocities [rad/s], shape (7,), changed in place.
        efforts: Commanded torques without gravity [Nm], shape (7,), changed in place.
        has_positions: Whether position commands are taken.
        has_velocities: Whether velocity commands are taken.
        has_efforts: Whether torque commands are taken.
        limit_reports: The limits that are enforced, and their sources.
    """

    def __init__(
        self,
        state: RobotState,
        names: Sequence[str],
        limit_mode: LimitMode = LimitMode.ROS_CONTROL,
    ) -> None:
        self._state = state
        self._limit_mode = limit_mode
        self.memory = Block(_SIZES)
        self.positions = self.memory["positions"]
        self.velocities = self.memory["velocities"]
        self.efforts = self.memory["efforts"]
        self._lower = [-inf] * _DOF
        self._upper = [inf] * _DOF
        self.limit_reports: list[JointLimitsReport] = []
        self._states = JointStateInterface()
        self._position_interface = PositionJointInterface()
        self._velocity_interface = VelocityJointInterface()
        self._effort_interface = EffortJointInterface()
        self._position_limits = JointLimitsInterface[JointLimitsHandle]()
        self._velocity_limits = JointLimitsInterface[JointLimitsHandle]()
        self._effort_limits = JointLimitsInterface[JointLimitsHandle]()
        # Kept here, because asking an interface for a handle would claim its joint.
        self._handles: list[tuple[JointHandle, JointHandle, JointHandle]] = []
        q, dq, tau = state.doubles("q"), state.doubles("dq"), state.doubles("tau_J")
        q_d, dq_d = state.doubles("q_d"), state.doubles("dq_d")
        for i, name in enumerate(names):
            measured = JointStateHandle(name, q, dq, tau, i)
            desired = JointStateHandle(name, q_d, dq_d, tau, i)
            position = JointHandle(desired, self.positions, i)
            velocity = JointHandle(desired, self.velocities, i)
            effort = JointHandle(measured, self.efforts, i)
            self._states.register_handle(measured)
            self._position_interface.register_handle(position)
            self._velocity_interface.register_handle(velocity)
            self._effort_interface.register_handle(effort)
            self._handles.append((position, velocity, effort))
        self.begin_commands(ControlMode.NONE)

    def interfaces(self) -> list[JointStateInterface | JointCommandInterface]:
        """Return the interfaces that controllers may ask for."""
        return [
            self._states,
            self._position_interface,
            self._velocity_interface,
            self._effort_interface,
        ]

    def add_limits(
        self, joints: Sequence[Joint], rates: Sequence[MotionLimits]
    ) -> list[str]:
        """Enforce the limits of the URDF from now on.

        Args:
            joints: The 7 joints of the URDF, from base to flange.
            rates: Acceleration and jerk limits of the joints, shape (7,).

        Returns:
            The joints that have no `<limit>` or no `<safety_controller>`, and so no
            enforced limits.
        """
        skipped = []
        for i, (joint, rate) in enumerate(zip(joints, rates, strict=True)):
            position, velocity, effort = self._handles[i]
            if joint.limit is None or joint.safety is None:
                skipped.append(position.name)
                continue
            if joint.limit.lower is not None and joint.limit.upper is not None:
                self._lower[i], self._upper[i] = joint.limit.lower, joint.limit.upper
            limits = JointLimits(
                min_position=joint.limit.lower,
                max_position=joint.limit.upper,
                max_velocity=joint.limit.velocity,
                max_acceleration=rate.acceleration,
                max_jerk=rate.jerk,
                max_effort=joint.limit.effort,
            )
            soft = SoftJointLimits(
                min_position=joint.safety.soft_lower_limit,
                max_position=joint.safety.soft_upper_limit,
                k_position=joint.safety.k_position,
                k_velocity=joint.safety.k_velocity,
            )
            self.limit_reports.append(
                JointLimitsReport(position.name, limits, soft, _SOURCES)
            )
            mode = self._limit_mode
            if mode is LimitMode.RATE:
                limits = _with_margin(limits)
            for quantity, handle, enforced in (
                ("position", position, self._position_limits),
                ("velocity", velocity, self._velocity_limits),
                ("effort", effort, self._effort_limits),
            ):
                enforced.register_handle(
                    make_limits_handle(mode, quantity, handle, limits, soft)
                )
        return skipped

    def clamps(self) -> list[ClampReport]:
        """Return the commands that limits have changed. Any thread."""
        return report_clamps({
            (handle.name, interface.type_name): handle
            for interface, limits in (
                (self._position_interface, self._position_limits),
                (self._velocity_interface, self._velocity_limits),
                (self._effort_interface, self._effort_limits),
            )
            for handle in limits.handles()
        })

    def begin_commands(self, mode: ControlMode) -> None:
        """Take commands of the kinds in `mode` from now on.

        The buffers are set to commands that hold the arm; earlier commands are lost.
        """
        put(self.positions, self._state.q_d)
        put(self.velocities, [0.0] * _DOF)
        put(self.efforts, [0.0] * _DOF)
        # Otherwise the last command of an earlier motion would limit the first command
        # of this one.
        self._position_limits.reset()
        self._velocity_limits.reset()
        self.has_positions = bool(mode & ControlMode.JOINT_POSITION)
        self.has_velocities = bool(mode & ControlMode.JOINT_VELOCITY)
        self.has_efforts = bool(mode & ControlMode.JOINT_TORQUE)

    def range(self) -> tuple[list[float], list[float]]:
        """Return the lowest and the highest positions that may be commanded [rad]."""
        return self._lower, self._upper

    def checks(self) -> tuple[FiniteCheck, ...]:
        """Return the checks of the taken commands for numbers that are not finite.

        The checks come before limits and filters, which may turn a NaN into a number.
        """
        return tuple(FiniteCheck(commands) for commands, _ in self._taken())

    def limits(self) -> tuple[JointLimitsInterface[JointLimitsHandle], ...]:
        """Return the limits of the commands that are taken."""
        return tuple(limits for _, limits in self._taken())

    def _taken(self) -> list[tuple[Doubles, JointLimitsInterface[JointLimitsHandle]]]:
        kinds = (
            (self.has_positions, self.positions, self._position_limits),
            (self.has_velocities, self.velocities, self._velocity_limits),
            (self.has_efforts, self.efforts, self._effort_limits),
        )
        return [(commands, limits) for is_taken, commands, limits in kinds if is_taken]


def _with_margin(limits: JointLimits) -> JointLimits:
    if limits.min_position is None or limits.max_position is None:
        return limits
    return replace(
        limits,
        min_position=limits.min_position + _RANGE_MARGIN,
        max_position=limits.max_position - _RANGE_MARGIN,
    )
