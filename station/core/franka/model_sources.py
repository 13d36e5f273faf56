"""Quantities derived from an arm's state, written into memory every cycle."""

from collections.abc import Callable
from typing import Any

from station.core.numerics.arm_chain import zero_jacobian
from station.core.numerics.arm_dynamics import ArmDynamics
from station.core.numerics.rigid_motion import compose
from station.memory.doubles import Doubles, Storage, own, own_zeros
from station.memory.vectors import copy_into


class ModelSource:
    """Writes a quantity with a Python function; subclasses need no function.

    Args:
        function: Writes the numbers into memory.
    """

    def __init__(self, function: Callable[[Doubles], object]) -> None:
        self.function: Callable[[Doubles], object] | None = function

    def write(self, result: Doubles) -> None:
        """Write the quantity in the present state."""
        if self.function is not None:
            self.function(result)


class ToolPoseSource(ModelSource):
    """Writes the pose of a body fixed to the flange of an arm, 16 numbers.

    Args:
        dynamics: The dynamics of the arm.
        q: Joint positions of the arm [rad], shape (n,).
        links: Poses of the links, and of the flange, that `dynamics` places.
        tool: Pose of the body in the frame of the flange, 16 numbers.
    """

    def __init__(
        self, dynamics: ArmDynamics, q: Doubles, links: Storage, tool: Doubles
    ) -> None:
        self.function = None
        self.dynamics = dynamics
        self.q = q
        self.links = links
        self.end = 16 * len(q)
        self.flange = own([0.0] * 16)
        self.tool = tool

    def write(self, result: Doubles) -> None:
        """Write the present pose."""
        self.dynamics.move_links(self.q)
        copy_into(self.flange, 0, self.links[self.end :], 16)
        compose(self.flange, self.tool, result)


class ToolJacobianSource(ModelSource):
    """Writes the Jacobian of a body fixed to the flange, in the axes of the base.

    Args:
        pose: Source of the pose of the body.
    """

    def __init__(self, pose: ToolPoseSource) -> None:
        self.function = None
        self.source = pose
        self.pose = own([0.0] * 16)

    def write(self, result: Doubles) -> None:
        """Write the present Jacobian, 6 n numbers."""
        self.source.write(self.pose)
        zero_jacobian(self.source.links, self.pose, result)


class CoriolisSource(ModelSource):
    """Writes the Coriolis and centrifugal torques [Nm], shape (n,).

    Args:
        dynamics: The dynamics of the arm.
        state: State of the arm; its `m_total` is read in every cycle.
        q: Joint positions of the arm [rad], shape (n,).
        dq: Joint velocities of the arm [rad/s], shape (n,).
        center: Centre of mass of end effector and load, `F_x_Ctotal` [m], shape (3,).
        inertia: Inertia of both, `I_total` [kg m^2], shape (9,).
        put_load: Writes the load of the state into `dynamics`.
    """

    def __init__(
        self,
        dynamics: ArmDynamics,
        state: Any,  # noqa: ANN401 - whatever has `m_total`
        q: Doubles,
        dq: Doubles,
        center: Doubles,
        inertia: Doubles,
        put_load: Callable[[], None],
    ) -> None:
        self.function = None
        self.dynamics = dynamics
        self.state = state
        self.q = q
        self.dq = dq
        self.center = center
        self.inertia = inertia
        self.put_load = put_load
        self.mass = -1.0
        self.load = own_zeros(12)
        self.changes = -1

    def write(self, result: Doubles) -> None:
        """Write the present torques."""
        if self.is_another_load():
            self.put_load()
            self.changes = self.dynamics.changes
        self.dynamics.move_links(self.q)
        self.dynamics.coriolis(self.dq, result)

    def is_another_load(self) -> bool:
        """Store the load; return whether it differs from that in `dynamics`."""
        mass: float = self.state.m_total
        differs = self.changes != self.dynamics.changes or mass != self.mass
        self.mass = mass
        load = self.load
        for k in range(3):
            if load[k] != self.center[k]:
                load[k] = self.center[k]
                differs = True
        for k in range(9):
            if load[3 + k] != self.inertia[k]:
                load[3 + k] = self.inertia[k]
                differs = True
        return differs
