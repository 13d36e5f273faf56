"""Kinematics and dynamics of an arm; asking for a handle claims nothing.

All matrices are flat and column-major, as libfranka has them: a pose T has 16 numbers,
T(r, c) = T[4 c + r]; a Jacobian has 42, J(r, c) = J[6 c + r], rows vx vy vz wx wy wz.

Source: franka_ros@c11f000 franka_hw/include/franka_hw/franka_model_interface.h.
"""
# ruff: noqa: N803 - the arguments have libfranka's names.

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from enum import Enum
from typing import ClassVar

from station.core.franka.franka_robot_state import RobotState
from station.core.franka.model_sources import ModelSource
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    ResourceHandle,
)
from station.memory.doubles import Doubles, put

GRAVITY_EARTH = (0.0, 0.0, -9.81)
"""Acceleration of gravity in the base frame of an upright arm [m/s^2]."""


class Frame(Enum):
    """The frames of the arm; the values are libfranka's.

    The frame of a joint is the frame of the link behind the joint.
    """

    JOINT1 = 0
    JOINT2 = 1
    JOINT3 = 2
    JOINT4 = 3
    JOINT5 = 4
    JOINT6 = 5
    JOINT7 = 6
    FLANGE = 7
    END_EFFECTOR = 8
    STIFFNESS = 9

    def __init__(self, index: int) -> None:
        # An attribute, because `value` takes four times as long in every cycle.
        self.index = index


class FrankaModel(ABC):
    """A model of one arm, in libfranka's explicit-argument form. Control thread."""

    @abstractmethod
    def mass(
        self,
        q: Sequence[float],
        I_total: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
    ) -> list[float]:
        """Return the mass matrix [kg m^2], 49 numbers, without the motors' rotors.

        Args:
            q: Joint positions [rad], shape (7,).
            I_total: Inertia of end effector and load [kg m^2], shape (9,).
            m_total: Mass of end effector and load [kg].
            F_x_Ctotal: Centre of mass of both in the flange frame [m], shape (3,).
        """

    @abstractmethod
    def coriolis(
        self,
        q: Sequence[float],
        dq: Sequence[float],
        I_total: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
    ) -> list[float]:
        """Return the Coriolis and centrifugal torques C(q, dq) dq [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
            I_total: Inertia of end effector and load [kg m^2], shape (9,).
            m_total: Mass of end effector and load [kg].
            F_x_Ctotal: Centre of mass of both in the flange frame [m], shape (3,).
        """

    @abstractmethod
    def gravity(
        self,
        q: Sequence[float],
        m_total: float,
        F_x_Ctotal: Sequence[float],
        gravity_earth: Sequence[float] = GRAVITY_EARTH,
    ) -> list[float]:
        """Return the torques that hold the arm [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            m_total: Mass of end effector and load [kg].
            F_x_Ctotal: Centre of mass of both in the flange frame [m], shape (3,).
            gravity_earth: Acceleration of gravity in the base frame [m/s^2], (3,).
        """

    @abstractmethod
    def pose(
        self,
        frame: Frame,
        q: Sequence[float],
        F_T_EE: Sequence[float],
        EE_T_K: Sequence[float],
    ) -> list[float]:
        """Return the pose of a frame in the base frame, 16 numbers.

        Args:
            frame: The frame.
            q: Joint positions [rad], shape (7,).
            F_T_EE: End effector in the flange frame, 16 numbers.
            EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
        """

    def pose_source(
        self, frame: Frame, q: Doubles, F_T_EE: Doubles, EE_T_K: Doubles
    ) -> ModelSource:
        """Return a source that writes the pose of a frame in every cycle; see `pose`.

        Args:
            frame: The frame.
            q: Joint positions [rad], shape (7,). The source reads this memory, and the
                memory of the other arguments, in every cycle.
            F_T_EE: End effector in the flange frame, 16 numbers.
            EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
        """
        return _written(self.pose, frame, q, F_T_EE, EE_T_K)

    @abstractmethod
    def zero_jacobian(
        self,
        frame: Frame,
        q: Sequence[float],
        F_T_EE: Sequence[float],
        EE_T_K: Sequence[float],
    ) -> list[float]:
        """Return the Jacobian of a frame's origin in the axes of the base, 42 numbers.

        Args:
            frame: The frame.
            q: Joint positions [rad], shape (7,).
            F_T_EE: End effector in the flange frame, 16 numbers.
            EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
        """

    def zero_jacobian_source(
        self, frame: Frame, q: Doubles, F_T_EE: Doubles, EE_T_K: Doubles
    ) -> ModelSource:
        """Return a source that writes `zero_jacobian` of a frame in every cycle.

        Args:
            frame: The frame.
            q: Joint positions [rad], shape (7,). The source reads this memory, and the
                memory of the other arguments, in every cycle.
            F_T_EE: End effector in the flange frame, 16 numbers.
            EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
        """
        return _written(self.zero_jacobian, frame, q, F_T_EE, EE_T_K)

    def coriolis_source(self, state: RobotState) -> ModelSource:
        """Return a source that writes `coriolis` with the arm's load in every cycle.

        Args:
            state: The arm's live state; the source reads it in every cycle.
        """
        q, dq = state.doubles("q"), state.doubles("dq")
        inertia, center = state.doubles("I_total"), state.doubles("F_x_Ctotal")

        def write(result: Doubles) -> None:
            put(result, self.coriolis(q, dq, inertia, state.m_total, center))

        return ModelSource(write)

    @abstractmethod
    def body_jacobian(
        self,
        frame: Frame,
        q: Sequence[float],
        F_T_EE: Sequence[float],
        EE_T_K: Sequence[float],
    ) -> list[float]:
        """Return the Jacobian of a frame's origin in its own axes, 42 numbers.

        Args:
            frame: The frame.
            q: Joint positions [rad], shape (7,).
            F_T_EE: End effector in the flange frame, 16 numbers.
            EE_T_K: Stiffness frame in the end effector frame, 16 numbers.
        """

    @abstractmethod
    def clearance(self, q: Sequence[float]) -> float:
        """Return the distance of the arm's two closest parts [m]; takes about 0.1 ms.

        A hand counts as mounted. The distance is negative if the parts overlap.

        Args:
            q: Joint positions [rad], shape (7,).
        """


def _written(
    compute: Callable[[Frame, Doubles, Doubles, Doubles], Sequence[float]],
    frame: Frame,
    *memory: Doubles,
) -> ModelSource:
    """Return a source that writes `compute` of a frame and of memory."""
    return ModelSource(lambda result: put(result, compute(frame, *memory)))


class FrankaModelHandle(ResourceHandle):
    """Evaluates the model of one arm. Control thread only.

    The methods use the present state; `model` has the same methods with arguments.

    Args:
        name: Name of the form `<arm_id>_model`, or the alias `<arm_id>_robot`.
        model: The arm's model.
        state: The arm's live state.

    Attributes:
        model: The model with explicit arguments.
    """

    def __init__(
        self,
        name: str,
        model: FrankaModel,
        state: RobotState,
    ) -> None:
        super().__init__(name)
        self.model = model
        self._state = state
        self._q, self._dq = state.doubles("q"), state.doubles("dq")
        self._frames = (state.doubles("F_T_EE"), state.doubles("EE_T_K"))
        self._inertia = state.doubles("I_total")
        self._center = state.doubles("F_x_Ctotal")

    def get_mass(self) -> list[float]:
        """Return the mass matrix with all loads at the flange [kg m^2], shape (49,)."""
        mass = self._state.m_total
        return self.model.mass(self._q, self._inertia, mass, self._center)

    def get_coriolis(self) -> list[float]:
        """Return the Coriolis and centrifugal torques [Nm], shape (7,)."""
        mass = self._state.m_total
        return self.model.coriolis(self._q, self._dq, self._inertia, mass, self._center)

    def get_gravity(
        self, gravity_earth: Sequence[float] = GRAVITY_EARTH
    ) -> list[float]:
        """Return the torques that hold the arm [Nm], shape (7,).

        Args:
            gravity_earth: Acceleration of gravity in the base frame [m/s^2], (3,).
        """
        mass = self._state.m_total
        return self.model.gravity(self._q, mass, self._center, gravity_earth)

    def get_pose(self, frame: Frame) -> list[float]:
        """Return the pose of a frame in the base frame, 16 numbers."""
        return self.model.pose(frame, self._q, *self._frames)

    def pose_source(self, frame: Frame) -> ModelSource:
        """Return a source that writes `get_pose` of a frame in every cycle."""
        return self.model.pose_source(frame, self._q, *self._frames)

    def get_zero_jacobian(self, frame: Frame) -> list[float]:
        """Return the Jacobian of a frame in the axes of the base, 42 numbers."""
        return self.model.zero_jacobian(frame, self._q, *self._frames)

    def zero_jacobian_source(self, frame: Frame) -> ModelSource:
        """Return a source that writes `get_zero_jacobian` in every cycle."""
        return self.model.zero_jacobian_source(frame, self._q, *self._frames)

    def coriolis_source(self) -> ModelSource:
        """Return a source that writes `get_coriolis` in every cycle."""
        return self.model.coriolis_source(self._state)

    def get_body_jacobian(self, frame: Frame) -> list[float]:
        """Return the Jacobian of a frame in its own axes, 42 numbers."""
        return self.model.body_jacobian(frame, self._q, *self._frames)


class FrankaModelInterface(HardwareResourceManager[FrankaModelHandle]):
    """Models of arms by name."""

    type_name: ClassVar[str] = "franka_hw::FrankaModelInterface"
