"""The model of one arm: its kinematics and dynamics under libfranka's names."""

from collections.abc import Sequence

from typing_extensions import override

from station.core.description.robot_files import RobotFiles
from station.core.franka.franka_model import GRAVITY_EARTH, Frame, FrankaModel
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.model_sources import ModelSource
from station.core.numerics.arm_chain import turn_to_inner_axes
from station.hw.franka.arm.franka_kinematics import place_frame, place_jacobian
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.self_collision import link_distances
from station.hw.franka.simulated.franka_dynamics import FrankaDynamics
from station.memory.doubles import Doubles, doubles, viewed


class ArmModel(FrankaModel):
    """The model of one arm, built from the URDF of the arm. Control thread only.

    An answer is computed once for equal arguments, so that several controllers that ask
    in one cycle cost as much as one.

    Args:
        description: The URDF of a Franka arm.

    Raises:
        RobotDescriptionError: The URDF does not describe a Franka arm.
    """

    def __init__(self, description: RobotFiles) -> None:
        self._dynamics = FrankaDynamics(description)
        self._jacobians: dict[Frame, Doubles] = {}
        self._distances = link_distances(has_hand=True)
        self._load = RigidBody()
        self._center = doubles(self._load.center_of_mass)
        self._inertia = doubles(self._load.inertia)

    @override
    def mass(
        self,
        q: Sequence[float],
        I_total: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
    ) -> list[float]:
        return self._dynamics.mass(q, self._load_of(I_total, m_total, F_x_Ctotal))

    @override
    def coriolis(
        self,
        q: Sequence[float],
        dq: Sequence[float],
        I_total: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
    ) -> list[float]:
        load = self._load_of(I_total, m_total, F_x_Ctotal)
        return self._dynamics.coriolis(q, dq, load)

    @override
    def gravity(
        self,
        q: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
        gravity_earth: Sequence[float] = GRAVITY_EARTH,
    ) -> list[float]:
        # The inertia has no weight, so the one of the last load is used.
        load = self._load_of(self._inertia, m_total, F_x_Ctotal)
        return self._dynamics.gravity(q, load, gravity_earth)

    @override
    def pose(
        self,
        frame: Frame,
        q: Sequence[float],
        F_T_EE: Sequence[float],
        EE_T_K: Sequence[float],
    ) -> list[float]:
        return [*place_frame(frame, self._dynamics.move_to(q), F_T_EE, EE_T_K)]

    @override
    def pose_source(
        self, frame: Frame, q: Doubles, F_T_EE: Doubles, EE_T_K: Doubles
    ) -> ModelSource:
        if frame is not Frame.END_EFFECTOR:
            return super().pose_source(frame, q, F_T_EE, EE_T_K)
        return self._dynamics.tool_pose_source(q, F_T_EE)

    @override
    def zero_jacobian(
        self,
        frame: Frame,
        q: Sequence[float],
        F_T_EE: Sequence[float],
        EE_T_K: Sequence[float],
    ) -> list[float]:
        links = self._dynamics.move_to(q)
        tools = viewed(F_T_EE), viewed(EE_T_K)
        if self._dynamics.is_new(frame.index, tools[0].tobytes() + tools[1].tobytes()):
            pose = place_frame(frame, links, *tools)
            self._jacobians[frame] = place_jacobian(frame, links, pose)
        return [*self._jacobians[frame]]

    @override
    def zero_jacobian_source(
        self, frame: Frame, q: Doubles, F_T_EE: Doubles, EE_T_K: Doubles
    ) -> ModelSource:
        if frame is not Frame.END_EFFECTOR:
            return super().zero_jacobian_source(frame, q, F_T_EE, EE_T_K)
        return self._dynamics.tool_jacobian_source(q, F_T_EE)

    @override
    def coriolis_source(self, state: RobotState) -> ModelSource:
        inertia, center = state.doubles("I_total"), state.doubles("F_x_Ctotal")
        return self._dynamics.coriolis_source(
            state, lambda: self._load_of(inertia, state.m_total, center)
        )

    @override
    def body_jacobian(
        self,
        frame: Frame,
        q: Sequence[float],
        F_T_EE: Sequence[float],
        EE_T_K: Sequence[float],
    ) -> list[float]:
        links = self._dynamics.move_to(q)
        pose = place_frame(frame, links, F_T_EE, EE_T_K)
        jacobian = place_jacobian(frame, links, pose)
        turn_to_inner_axes(pose, jacobian, jacobian)
        return [*jacobian]

    @override
    def clearance(self, q: Sequence[float]) -> float:
        return self._distances.measure(self._dynamics.move_to(q))

    def _load_of(
        self, inertia: Sequence[float], mass: float, center: Sequence[float]
    ) -> RigidBody:
        """Return the load; the same object as long as the numbers are the same."""
        # Two views of doubles are compared without making Python's floats. Other
        # sequences never equal a view, and are compared as a load.
        if (
            mass != self._load.mass
            or center != self._center
            or inertia != self._inertia
        ):
            load = RigidBody(mass, tuple(center), tuple(inertia))
            if load != self._load:
                self._load = load
                self._center, self._inertia = doubles(center), doubles(inertia)
        return self._load
