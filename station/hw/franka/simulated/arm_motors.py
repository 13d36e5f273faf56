"""The motors and internal controllers of an arm in a MuJoCo world.

Torques are those of the client, or of an internal impedance:

    joint:      tau = K (q_d - q) + D (dq_d - dq) + M_ii ddq_d + coriolis(q, dq)
                D = 2 zeta sqrt(K M_ii)
    Cartesian:  tau = J^T (K_x e + D_x de) + coriolis(q, dq) + null space
                D_x = 2 zeta sqrt(K_x)

with M_ii the inertia at each joint; D uses the M_ii of the time when the impedance
starts to act. The terms of the joint impedance in q and dq are part of the motor model,
where the integrator treats D implicitly. The world compensates gravity, and the motors
carry the weight of a configured load. Motors saturate at the effort limits.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotMode, RobotState
from station.core.numerics.rigid_motion import rotation_between
from station.hw.franka.arm.franka_kinematics import frame_pose, zero_jacobian
from station.hw.mujoco.world_joints import WorldJoints

DEFAULT_JOINT_IMPEDANCE = (3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0)
"""Stiffness of the internal controller [Nm/rad]. Source: libfranka@0.9.2
examples/examples_common.cpp, setDefaultBehavior."""
DEFAULT_CARTESIAN_IMPEDANCE = (3000.0, 3000.0, 3000.0, 300.0, 300.0, 300.0)
"""Stiffness of the internal Cartesian controller [N/m, Nm/rad]. Source: as above."""
# Stiffness in the null space, which holds the elbow [Nm/rad].
_NULL_SPACE_STIFFNESS = 20.0
# Damping ratio zeta of the internal controllers.
_DAMPING_RATIO = 1.0
_DAMPING_OF_INVERSE = 1e-4
_ZEROS = [0.0] * 7


class ArmMotors:
    """Drives the 7 joints of one arm. Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state; `tau_J_d`, `tau_J` and `dtau_J` are written.

    Attributes:
        torques_act: Whether the motors follow the client's torques, not an impedance.
        load_weight: Torques that carry the configured load [Nm], shape (7,).
        joint_stiffness: Stiffness of the joint impedance [Nm/rad], shape (7,).
        cartesian_stiffness: Stiffness of the Cartesian impedance [N/m, Nm/rad], (6,).
    """

    def __init__(self, joints: WorldJoints, state: RobotState) -> None:
        self._joints = joints
        self._state = state
        self._limits = joints.effort_limits
        self._damping = _ZEROS
        self._is_cartesian = False
        self.torques_act = False
        self.load_weight = list(_ZEROS)
        self.joint_stiffness = list(DEFAULT_JOINT_IMPEDANCE)
        self.cartesian_stiffness = list(DEFAULT_CARTESIAN_IMPEDANCE)

    def engage_joint_impedance(self) -> None:
        """Let the joint impedance act from the next step on."""
        self.torques_act = self._is_cartesian = False
        self._damping = [
            2.0 * _DAMPING_RATIO * sqrt(k * inertia)
            for k, inertia in zip(
                self.joint_stiffness, self._joints.read_inertia(), strict=True
            )
        ]
        self._joints.set_servo(self.joint_stiffness, self._damping)

    def engage_cartesian_impedance(self) -> None:
        """Let the Cartesian impedance act from the next step on."""
        self._let_motors_be_forces()
        self._is_cartesian = True

    def engage_torques(self) -> None:
        """Let the client's torques act from the next step on."""
        self._let_motors_be_forces()
        self.torques_act = True

    def apply_torques(self, torques: Sequence[float]) -> None:
        """Set the motors' controls.

        Args:
            torques: The client's torques without gravity [Nm], shape (7,).
        """
        clipped = [
            max(-limit, min(limit, tau))
            for tau, limit in zip(torques, self._limits, strict=True)
        ]
        self._state.tau_J_d[:] = clipped
        self._set_controls(clipped)

    def apply_impedance(self, q: Sequence[float], dq: Sequence[float]) -> None:
        """Set the motors' controls so that the arm follows q_d.

        Args:
            q: Positions [rad], shape (7,).
            dq: Velocities [rad/s], shape (7,).
        """
        if self._is_cartesian:
            self._apply_cartesian(q, dq)
            return
        state, joints = self._state, self._joints
        controls = [
            k * q_d + d * dq_d + bias - weight + inertia * ddq_d
            for k, d, q_d, dq_d, ddq_d, bias, weight, inertia in zip(
                self.joint_stiffness,
                self._damping,
                state.q_d,
                state.dq_d,
                state.ddq_d,
                joints.read_bias_forces(),
                joints.read_compensation(),
                joints.read_inertia(),
                strict=True,
            )
        ]
        if state.robot_mode is RobotMode.MOVE:
            state.tau_J_d[:] = [
                max(-limit, min(limit, control - k * position - d * velocity))
                for control, k, d, position, velocity, limit in zip(
                    controls,
                    self.joint_stiffness,
                    self._damping,
                    q,
                    dq,
                    self._limits,
                    strict=True,
                )
            ]
        self._set_controls(controls)

    def read_torques(
        self, dq: Sequence[float], last_dq: Sequence[float], period: float
    ) -> None:
        """Derive the link-side torques of the last step.

        A torque sensor behind the gears measures the torques of motor and brake minus
        the torques that accelerate the rotor and overcome friction. MuJoCo applies the
        damping of the impedance with the velocity at the end of the step, while the
        motor's reading contains the velocity at the beginning.

        Args:
            dq: Velocities at the end of the step [rad/s], shape (7,).
            last_dq: Velocities at the beginning of the step [rad/s], shape (7,).
            period: Duration of the step [s], > 0.
        """
        joints, measured = self._joints, self._state.tau_J
        torques, rates = [], []
        for (
            velocity,
            last,
            force,
            brake,
            weight,
            damping,
            armature,
            own,
            limit,
            old,
        ) in zip(
            dq,
            last_dq,
            joints.read_motor_forces(),
            joints.read_brake_forces(),
            joints.read_compensation(),
            joints.damping,
            joints.armature,
            self._damping,
            self._limits,
            measured,
            strict=True,
        ):
            change = velocity - last
            tau = force + brake + weight - damping * velocity
            tau -= armature * change / period
            if own and abs(force) < limit:
                tau -= own * change
            rates.append((tau - old) / period)
            torques.append(tau)
        measured[:] = torques
        self._state.dtau_J[:] = rates

    def _let_motors_be_forces(self) -> None:
        self.torques_act = self._is_cartesian = False
        self._damping = _ZEROS
        self._joints.set_servo(_ZEROS, _ZEROS)

    def _set_controls(self, controls: list[float]) -> None:
        if any(self.load_weight):
            controls = [a + b for a, b in zip(controls, self.load_weight, strict=True)]
        self._joints.set_controls(controls)

    def _apply_cartesian(self, q: Sequence[float], dq: Sequence[float]) -> None:
        state = self._state
        frames = (state.F_T_EE, state.EE_T_K)
        pose = frame_pose(Frame.STIFFNESS, q, *frames)
        desired = frame_pose(Frame.STIFFNESS, state.q_d, *frames)
        jacobian = np.reshape(zero_jacobian(Frame.STIFFNESS, q, *frames), (7, 6))
        turn = rotation_between(pose, desired)
        error = np.array([
            desired[12] - pose[12], desired[13] - pose[13], desired[14] - pose[14],
            *turn,
        ])  # fmt: skip
        rate = (np.array(state.dq_d) - dq) @ jacobian
        axes = np.reshape((*pose[0:3], *pose[4:7], *pose[8:11]), (3, 3))  # rows: K axes
        stiffness = np.array(self.cartesian_stiffness)
        damping = 2.0 * _DAMPING_RATIO * np.sqrt(stiffness)
        wrench = np.empty(6)
        for part in (slice(0, 3), slice(3, 6)):
            local = stiffness[part] * (axes @ error[part])
            local += damping[part] * (axes @ rate[part])
            wrench[part] = axes.T @ local
        gram = jacobian.T @ jacobian + _DAMPING_OF_INVERSE * np.eye(6)
        stray = _NULL_SPACE_STIFFNESS * (np.array(state.q_d) - q)
        stray += 2.0 * sqrt(_NULL_SPACE_STIFFNESS) * (np.array(state.dq_d) - dq)
        stray -= jacobian @ np.linalg.solve(gram, jacobian.T @ stray)
        bias = np.array(self._joints.read_bias_forces())
        bias -= self._joints.read_compensation()
        self.apply_torques((jacobian @ wrench + stray + bias).tolist())
