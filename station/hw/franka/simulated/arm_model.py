"""The model of one arm: kinematics in plain floats, dynamics by MuJoCo."""

from collections.abc import Sequence

from typing_extensions import override

from station.core.description.robot_files import RobotFiles
from station.core.franka.franka_model import GRAVITY_EARTH, FrankaModel
from station.hw.franka.arm import franka_kinematics as kinematics
from station.hw.franka.arm.load import Load
from station.hw.franka.arm.self_collision import clearance
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics


class ArmModel(FrankaModel):
    """The model of one arm, built from the URDF of the arm. Control thread only.

    Args:
        description: The URDF of a Franka arm.

    Raises:
        RobotDescriptionError: The URDF does not describe a Franka arm.
    """

    def __init__(self, description: RobotFiles) -> None:
        self._dynamics = FrankaDynamics(description)

    @override
    def mass(
        self,
        q: Sequence[float],
        I_total: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
    ) -> list[float]:
        load = Load(m_total, tuple(F_x_Ctotal), tuple(I_total))
        return self._dynamics.mass(q, load)

    @override
    def coriolis(
        self,
        q: Sequence[float],
        dq: Sequence[float],
        I_total: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
    ) -> list[float]:
        load = Load(m_total, tuple(F_x_Ctotal), tuple(I_total))
        return self._dynamics.coriolis(q, dq, load)

    @override
    def gravity(
        self,
        q: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
        gravity_earth: Sequence[float] = GRAVITY_EARTH,
    ) -> list[float]:
        return self._dynamics.gravity(
            q, Load(m_total, tuple(F_x_Ctotal)), gravity_earth
        )

    pose = staticmethod(kinematics.frame_pose)
    zero_jacobian = staticmethod(kinematics.zero_jacobian)
    body_jacobian = staticmethod(kinematics.body_jacobian)

    @override
    def clearance(self, q: Sequence[float]) -> float:
        return clearance(q, has_hand=True).distance
