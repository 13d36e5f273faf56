"""Frames and load of an arm, and the part of its state that follows from them.

Source: libfranka@0.9.2 include/franka/robot_state.h, RobotState.
"""

from collections.abc import Sequence

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.arm.franka_kinematics import (
    CHAIN,
    compose,
)
from station.hw.franka.arm.load import Load, combine_loads
from station.hw.franka.simulated.end_effector_state import EndEffectorState

MAX_EXTENSION = -0.467002423653011
"""Position of joint 4 at which the arm is stretched out most [rad]."""


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
        self._end_effector = EndEffectorState(state.doubles, CHAIN, MAX_EXTENSION)
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
        state.F_x_Cee = end_effector.center_of_mass
        state.I_ee = end_effector.inertia
        state.F_T_NE = nominal_frame
        self.set_frame(state.NE_T_EE)
        self.set_load(Load())

    def set_frame(self, frame: Sequence[float]) -> None:
        """Set the end effector in the nominal end effector frame, 16 numbers."""
        state = self._state
        state.NE_T_EE = frame
        state.F_T_EE = compose(state.F_T_NE, state.NE_T_EE)
        self._refreshed_at = -1.0

    def set_stiffness_frame(self, frame: Sequence[float]) -> None:
        """Set the stiffness frame in the end effector frame, 16 numbers."""
        self._state.EE_T_K = frame

    def set_load(self, load: Load) -> None:
        """Set the load that the end effector holds."""
        state = self._state
        state.m_load = load.mass
        state.F_x_Cload = load.center_of_mass
        state.I_load = load.inertia
        total = combine_loads(
            Load(state.m_ee, tuple(state.F_x_Cee), tuple(state.I_ee)), load
        )
        state.m_total = total.mass
        state.F_x_Ctotal = total.center_of_mass
        state.I_total = total.inertia

    def invalidate(self) -> None:
        """Let the next `refresh` compute, even if no time has passed."""
        self._refreshed_at = -1.0

    def refresh(self) -> bool:
        """Bring the derived fields up to date; return False when they were."""
        state = self._state
        # Few cycles have a reader of poses: they are computed for the first one that
        # asks.
        if self._refreshed_at == state.time:
            return False
        self._refreshed_at = state.time
        self._end_effector.refresh()
        # In a Cartesian motion `CartesianStep` writes the commanded fields.
        if not self.is_cartesian:
            self._end_effector.command_desired()
        return True
