"""A model of an arm with the true kinematics and links without a mass."""

from collections.abc import Sequence

from station.core.franka import Frame, FrankaModel
from station.core.franka.franka_model import GRAVITY_EARTH
from station.core.numerics.arm_chain import turn_to_inner_axes
from station.hw.franka.arm import franka_kinematics as kinematics
from station.hw.franka.arm.self_collision import clearance
from station.memory.doubles import doubles


class PlainModel(FrankaModel):
    """The kinematics of a Franka arm; every joint has an inertia of 1 kg m^2."""

    def end_effector(self, q: Sequence[float], F_T_EE: Sequence[float]) -> list[float]:  # noqa: N803 - libfranka's name
        return kinematics.frame_pose(Frame.END_EFFECTOR, q, F_T_EE)

    def mass(self, q, I_total, m_total, F_x_Ctotal):  # noqa: N803 - libfranka's names
        return [float(i // 7 == i % 7) for i in range(49)]

    def coriolis(self, q, dq, I_total, m_total, F_x_Ctotal):  # noqa: N803 - libfranka's names
        return [0.0] * 7

    def gravity(self, q, m_total, F_x_Ctotal, gravity_earth=GRAVITY_EARTH):  # noqa: N803 - libfranka's names
        return [0.0] * 7

    def pose(self, frame, q, F_T_EE, EE_T_K):  # noqa: N803 - libfranka's names
        return kinematics.frame_pose(frame, q, F_T_EE, EE_T_K)

    def zero_jacobian(self, frame, q, F_T_EE, EE_T_K):  # noqa: N803 - libfranka's names
        return kinematics.zero_jacobian(frame, q, F_T_EE, EE_T_K)

    def body_jacobian(self, frame, q, F_T_EE, EE_T_K):  # noqa: N803 - libfranka's names
        pose = doubles(self.pose(frame, q, F_T_EE, EE_T_K))
        jacobian = doubles(self.zero_jacobian(frame, q, F_T_EE, EE_T_K))
        turn_to_inner_axes(pose, jacobian, jacobian)
        return [*jacobian]

    def clearance(self, q):
        return clearance(q, has_hand=True)
