"""The motors and internal controllers of an arm in a MuJoCo world.

The torques are those of the client, or of an internal impedance:

    joint:      tau = K (q_d - q) + D (dq_d - dq) + M_ii ddq_d + coriolis(q, dq)
                D = 2 zeta sqrt(K M_ii)
    Cartesian:  tau = J^T (K_x e + D_x de) + coriolis(q, dq) + null space
                D_x = 2 zeta sqrt(K_x)

with M_ii the inertia at each joint; D uses the M_ii at the moment when the impedance
begins to act. The terms of the joint impedance in q and dq are part of the motor model,
where the integrator treats D implicitly. The world compensates gravity, and the motors
carry the weight of a configured load. Motors saturate at the effort limits.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.joint_memory import JointMemory
from station.core.numerics.poses import rotation_between
from station.hw.franka.arm.franka_kinematics import frame_pose, zero_jacobian
from station.hw.franka.simulated.joint_motors import JointMotors
from station.hw.mujoco.world_joints import WorldJoints
from station.memory.doubles import put

DEFAULT_JOINT_IMPEDANCE = (3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0)
"""Stiffness of the internal controller [Nm/rad]. Source: libfranka@0.9.2
examples/examples_common.cpp, setDefaultBehavior."""
DEFAULT_CARTESIAN_IMPEDANCE = (3000.0, 3000.0, 3000.0, 300.0, 300.0, 300.0)
"""Stiffness of the internal Cartesian controller [N/m, Nm/rad]. Source: as above."""
# Stiffness in the null space, which holds the elbow [Nm/rad].
_NULL_SPACE_STIFFNESS = 20.0
# Damping ratio zeta of the internal controllers.
_DAMPING_RATIO = 1.0
# Keeps J^T J invertible at a singular pose. If its singular values are above 0.1 this
# changes less than 1 %.
_DAMPING_OF_INVERSE = 1e-4
_ZEROS = [0.0] * 7


class ArmMotors:
    """Drives the 7 joints of one arm. Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state.
        memory: State and commands of the joints.
        motors: Computes the motors' controls.

    Attributes:
        joint_stiffness: Stiffness of the joint impedance [Nm/rad], shape (7,).
        cartesian_stiffness: Stiffness of the Cartesian impedance [N/m, Nm/rad], (6,).
    """

    def __init__(
        self,
        joints: WorldJoints,
        state: RobotState,
        memory: JointMemory,
        motors: JointMotors,
    ) -> None:
        self._joints = joints
        self._state = state
        self._memory = memory
        self._motors = motors
        self.joint_stiffness = list(DEFAULT_JOINT_IMPEDANCE)
        self.cartesian_stiffness = list(DEFAULT_CARTESIAN_IMPEDANCE)

    @property
    def torques_act(self) -> bool:
        """Return whether the motors follow the client's torques, not an impedance."""
        return self._motors.torques_act

    def carry(self, load_weight: Sequence[float]) -> None:
        """Let the motors carry a load from the next step on.

        Args:
            load_weight: Torques that the load needs [Nm], shape (7,).
        """
        put(self._motors.load_weight, load_weight)
        self._motors.is_loaded = any(load_weight)

    def engage_joint_impedance(self) -> None:
        """Let the joint impedance act from the next step on."""
        damping = [
            2.0 * _DAMPING_RATIO * sqrt(k * inertia)
            for k, inertia in zip(
                self.joint_stiffness, self._joints.read_inertia(), strict=True
            )
        ]
        self._engage(self.joint_stiffness, damping)

    def engage_cartesian_impedance(self) -> None:
        """Let the Cartesian impedance act from the next step on."""
        self._engage(_ZEROS, _ZEROS)
        self._motors.is_cartesian = True

    def engage_torques(self) -> None:
        """Let the client's torques act from the next step on."""
        self._engage(_ZEROS, _ZEROS)
        self._motors.torques_act = True

    def apply_torques(self, torques: Sequence[float]) -> None:
        """Set the motors' controls.

        Args:
            torques: Torques without gravity [Nm], shape (7,).
        """
        put(self._memory.torques, torques)
        self._motors.apply_torques()

    def differentiate(self) -> None:
        """Write `dtau_J` of the state; not in every cycle, because few read it."""
        self._motors.differentiate()

    def _engage(self, stiffness: Sequence[float], damping: Sequence[float]) -> None:
        self._motors.engage(stiffness, damping)
        self._joints.set_servo(list(stiffness), list(damping))

    def apply_cartesian_impedance(self) -> None:
        """Set the motors' controls according to the Cartesian impedance."""
        state = self._state
        q, dq = [*self._memory.positions], state.dtheta
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
        # The stiffnesses are along the axes of K: rotate into them and back.
        wrench = np.empty(6)
        for part in (slice(0, 3), slice(3, 6)):
            local = stiffness[part] * (axes @ error[part])
            local += damping[part] * (axes @ rate[part])
            wrench[part] = axes.T @ local
        gram = jacobian.T @ jacobian + _DAMPING_OF_INVERSE * np.eye(6)
        stray = _NULL_SPACE_STIFFNESS * (np.array(state.q_d) - q)
        stray += 2.0 * sqrt(_NULL_SPACE_STIFFNESS) * (np.array(state.dq_d) - dq)
        # Remove the part that would move the end effector.
        stray -= jacobian @ np.linalg.solve(gram, jacobian.T @ stray)
        bias = np.array(self._joints.read_bias_forces())
        # The world compensates gravity, so only Coriolis torques remain.
        bias -= self._joints.read_compensation()
        self.apply_torques((jacobian @ wrench + stray + bias).tolist())
