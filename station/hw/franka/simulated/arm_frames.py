"""Frames and load of an arm, and the part of its state that follows from them.

Source: libfranka@0.9.2 include/franka/robot_state.h, RobotState.
"""

from collections.abc import Sequence

from station.core.franka.franka_model import Frame
from station.core.franka.franka_robot_state import RobotState
from station.core.numerics.rigid_motion import times
from station.hw.franka.arm.franka_kinematics import (
    compose,
    frame_pose,
    pose_and_jacobian,
)
from station.hw.franka.arm.load import Load, combine_loads

MAX_EXTENSION = -0.467002423653011
"""Position of joint 4 at which the arm is stretched out most [rad]."""


def elbow_of(q: Sequence[float]) -> list[float]:
    """Return the elbow: position of joint 3 [rad], and sign of joint 4's flip.

    Args:
        q: Joint positions [rad], shape (7,).
    """
    flip = q[3] - MAX_EXTENSION
    return [q[2], float((flip > 0.0) - (flip < 0.0))]


class ArmFrames:
    """Keeps the derived fields of a state. Control thread only.

    Args:
        state: The arm's state.

    Attributes:
        is_cartesian: Whether a Cartesian motion runs. The commanded pose, twist and
            elbow are then the client's; otherwise they follow the joint motion.
    """

    def __init__(self, state: RobotState) -> None:
        self._state = state
        self._refreshed_at = -1.0
        self.is_cartesian = False

    def set_end_effector(
        self, end_effector: Load, nominal_frame: Sequence[float]
    ) -> None:
        """Set the end effector that is mounted at the flange.

        Args:
            end_effector: Mass, centre of mass and inertia of the end effector.
            nominal_frame: Nominal end effector in the flange frame, 16 numbers.
        """
        state = self._state
        state.m_ee = end_effector.mass
        state.F_x_Cee[:] = end_effector.center_of_mass
        state.I_ee[:] = end_effector.inertia
        state.F_T_NE[:] = nominal_frame
        self.set_frame(state.NE_T_EE)
        self.set_load(Load())

    def set_frame(self, frame: Sequence[float]) -> None:
        """Set the end effector in the nominal end effector frame, 16 numbers."""
        state = self._state
        state.NE_T_EE[:] = frame
        state.F_T_EE[:] = compose(state.F_T_NE, state.NE_T_EE)
        self._refreshed_at = -1.0

    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        """Set the stiffness frame in the end effector frame, 16 numbers."""
        self._state.EE_T_K[:] = frame

    def set_load(self, load: Load) -> None:
        """Set the load that the end effector holds."""
        state = self._state
        state.m_load = load.mass
        state.F_x_Cload[:] = load.center_of_mass
        state.I_load[:] = load.inertia
        total = combine_loads(
            Load(state.m_ee, tuple(state.F_x_Cee), tuple(state.I_ee)), load
        )
        state.m_total = total.mass
        state.F_x_Ctotal[:] = total.center_of_mass
        state.I_total[:] = total.inertia

    def invalidate(self) -> None:
        """Let the next `refresh` compute, even if no time has passed."""
        self._refreshed_at = -1.0

    def refresh(self) -> None:
        """Bring the derived fields up to date; cheap when they are."""
        state = self._state
        if self._refreshed_at == state.time:
            return
        self._refreshed_at = state.time
        F_T_EE = state.F_T_EE  # noqa: N806 - libfranka's name
        state.O_T_EE[:] = frame_pose(Frame.END_EFFECTOR, state.q, F_T_EE)
        state.O_T_EE_d[:], jacobian = pose_and_jacobian(state.q_d, F_T_EE)
        state.O_dP_EE_d[:] = times(jacobian, state.dq_d)
        state.elbow[:] = elbow_of(state.q)
        state.elbow_d[:] = elbow_of(state.q_d)
        if not self.is_cartesian:
            state.O_T_EE_c[:] = state.O_T_EE_d
            state.O_dP_EE_c[:] = state.O_dP_EE_d
            state.O_ddP_EE_c[:] = [0.0] * 6
            state.elbow_c[:] = state.elbow_d
            state.delbow_c[:] = [state.dq_d[2], 0.0]
            state.ddelbow_c[:] = [state.ddq_d[2], 0.0]
