"""Mass matrix, Coriolis and gravity torques of the arm with a load at its flange.

The links are those of the URDF, without rotor inertia, friction, hand and fingers: all
that is mounted at the flange is the load, as in libfranka. `core.numerics.arm_dynamics`
does the arithmetic, once for each set of joint positions, however many results are
requested and however often.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from station.core.description.robot_files import RobotFiles
from station.core.description.urdf import Joint, Pose
from station.core.errors import RobotDescriptionError
from station.core.franka.franka_model import GRAVITY_EARTH
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.model_sources import (
    CoriolisSource,
    ModelSource,
    ToolJacobianSource,
    ToolPoseSource,
)
from station.core.numerics.arm_chain import new_links, place_links
from station.core.numerics.arm_dynamics import ArmDynamics
from station.hw.franka.arm.arm_description import find_prefix
from station.hw.franka.arm.franka_kinematics import CHAIN, DOF, FLANGE_OFFSET
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.simulated.end_effector import as_transform
from station.hw.mujoco.inertia import combine
from station.hw.urdf_loader import load_urdf
from station.memory.doubles import Doubles, Storage, own, put, viewed, zeros

_NO_LOAD = RigidBody()
_MASS, _CORIOLIS, _GRAVITY = -1, -2, -3
_MOMENTS = 10
# Largest distance between a link's pose in a URDF and its real pose [m].
_TOLERANCE = 1e-3
_LAST = slice((DOF - 1) * _MOMENTS, DOF * _MOMENTS)


class FrankaDynamics:
    """Dynamics of one arm. Not thread safe: one instance per thread.

    Source of the conventions: libfranka@0.9.2 include/franka/model.h, Model.

    Args:
        description: The URDF of a Franka arm; None for links without mass, to compute
            the load only.

    Attributes:
        links: Poses of the links 1 to 7 and the flange at the positions of the last
            call.

    Raises:
        RobotDescriptionError: The URDF does not describe a Franka arm.
    """

    def __init__(self, description: RobotFiles | None) -> None:
        self._bodies = zeros(_MOMENTS * DOF)
        if description is not None:
            put(self._bodies, read_bodies(description))
        self._bare = [*self._bodies[_LAST]]
        self.links: Storage = own(new_links(CHAIN))
        self._dynamics = ArmDynamics(CHAIN, self._bodies, self.links)
        self._load = _NO_LOAD
        self._mass, self._coriolis = zeros(DOF * DOF), zeros(DOF)
        self._weight = zeros(DOF)
        # By quantity, the version and arguments for which it was computed.
        self._known: dict[int, tuple[int, bytes]] = {}

    def mass(self, q: Sequence[float], load: RigidBody = _NO_LOAD) -> list[float]:
        """Return the mass matrix [kg m^2], 7 x 7, flat.

        Args:
            q: Joint positions [rad], shape (7,).
            load: Body fixed to the flange.
        """
        self._set(q, load)
        if self.is_new(_MASS):
            self._dynamics.mass(self._mass)
        return [*self._mass]

    def coriolis(
        self, q: Sequence[float], dq: Sequence[float], load: RigidBody = _NO_LOAD
    ) -> list[float]:
        """Return the Coriolis and centrifugal torques C(q, dq) dq [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
            load: Body fixed to the flange.
        """
        self._set(q, load)
        rates = viewed(dq)
        if self.is_new(_CORIOLIS, rates.tobytes()):
            self._dynamics.coriolis(rates, self._coriolis)
        return [*self._coriolis]

    def gravity(
        self,
        q: Sequence[float],
        load: RigidBody = _NO_LOAD,
        gravity_earth: Sequence[float] = GRAVITY_EARTH,
    ) -> list[float]:
        """Return the torques that hold the arm against gravity [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            load: Body fixed to the flange.
            gravity_earth: Acceleration of gravity in the base frame [m/s^2], (3,).
        """
        self._set(q, load)
        acceleration = viewed(gravity_earth)
        if self.is_new(_GRAVITY, acceleration.tobytes()):
            self._dynamics.gravity(acceleration, self._weight)
        return [*self._weight]

    def torques(
        self,
        q: Sequence[float],
        dq: Sequence[float],
        ddq: Sequence[float],
        load: RigidBody = _NO_LOAD,
        gravity_earth: Sequence[float] = GRAVITY_EARTH,
    ) -> list[float]:
        """Return the torques of a motion, M ddq + C dq + g [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
            ddq: Joint accelerations [rad/s^2], shape (7,).
            load: Body fixed to the flange.
            gravity_earth: Acceleration of gravity in the base frame [m/s^2], (3,).
        """
        mass = self.mass(q, load)
        weight = self.gravity(q, load, gravity_earth)
        rest = zip(self.coriolis(q, dq, load), weight, strict=True)
        return [
            sum(m * a for m, a in zip(mass[row : row + DOF], ddq, strict=True)) + c + g
            for row, (c, g) in zip(range(0, DOF * DOF, DOF), rest, strict=True)
        ]

    def is_new(self, what: int, arguments: bytes = b"") -> bool:
        """Return whether a quantity must be computed anew, and note it as computed.

        So two controllers that ask the same in a cycle cost only one computation.

        Args:
            what: Number of the computed quantity; the numbers of frames stand for their
                Jacobians.
            arguments: Further numbers on which it depends, as bytes.
        """
        wanted = (self._dynamics.version, arguments)
        if self._known.get(what) == wanted:
            return False
        self._known[what] = wanted
        return True

    def move_to(self, q: Sequence[float]) -> Storage:
        """Return `links` at the given joint positions [rad], shape (7,)."""
        self._dynamics.move_to(q)
        return self.links

    def tool_pose_source(self, q: Doubles, tool: Doubles) -> ToolPoseSource:
        """Return a source of the pose of a body fixed to the flange.

        Args:
            q: Joint positions [rad], shape (7,); read in every cycle, like `tool`.
            tool: Pose of the body in the frame of the flange, 16 numbers.
        """
        return ToolPoseSource(self._dynamics, q, self.links, tool)

    def tool_jacobian_source(self, q: Doubles, tool: Doubles) -> ModelSource:
        """Return a source of the Jacobian of a body fixed to the flange, (42,).

        Args:
            q: Joint positions [rad], shape (7,); read in every cycle, like `tool`.
            tool: Pose of the body in the frame of the flange, 16 numbers.
        """
        return ToolJacobianSource(self.tool_pose_source(q, tool))

    def coriolis_source(
        self, state: RobotState, load: Callable[[], RigidBody]
    ) -> ModelSource:
        """Return a source of the Coriolis torques of a state, shape (7,).

        Args:
            state: The arm's state; read in every cycle.
            load: Returns the load; called when it may have changed.
        """
        q, dq = state.doubles("q"), state.doubles("dq")
        center, inertia = state.doubles("F_x_Ctotal"), state.doubles("I_total")

        def put_load() -> None:
            self._set(q, load())

        return CoriolisSource(self._dynamics, state, q, dq, center, inertia, put_load)

    def _set(self, q: Sequence[float], load: RigidBody) -> None:
        self._dynamics.move_to(q)
        # By identity first: `ArmModel` passes the same object while nothing changes.
        if load is not self._load and load != self._load:
            self._load = load
            added = _moments_at_link7(load)
            link = [a + b for a, b in zip(self._bare, added, strict=True)]
            put(self._bodies[_LAST], link)
            self._dynamics.change_bodies()


class ArmLoad:
    """The additional motor torques for the load that a client has configured.

    Without a configured load nothing is computed. Control thread only.

    Args:
        gravity: Acceleration of gravity in the base frame [m/s^2], shape (3,).

    Attributes:
        load: The configured load.
    """

    def __init__(self, gravity: Sequence[float] = GRAVITY_EARTH) -> None:
        # Torques of bodies add up, so this arm has no mass except the load.
        self._dynamics = FrankaDynamics(None)
        self._gravity = tuple(gravity)
        self._ddq = [0.0] * 7
        self.load = RigidBody()

    def note_motion(
        self, before: Sequence[float], velocities: Sequence[float], period: float
    ) -> None:
        """Store the change of the velocities in a step.

        Args:
            before: Joint velocities before the step [rad/s], shape (7,).
            velocities: Joint velocities after the step [rad/s], shape (7,).
            period: Duration of the step, > 0 [s].
        """
        pairs = zip(velocities, before, strict=True)
        self._ddq = [(new - old) / period for new, old in pairs]

    def weight(self, q: Sequence[float]) -> list[float]:
        """Return the torques that carry the load's weight [Nm], shape (7,).

        Args:
            q: Joint positions [rad], shape (7,).
        """
        return self._dynamics.gravity(q, self.load, self._gravity)

    def torques(self, q: Sequence[float], dq: Sequence[float]) -> list[float]:
        """Return the torques that carry and move the load [Nm], shape (7,).

        The accelerations are those of the motion that was stored last.

        Args:
            q: Joint positions [rad], shape (7,).
            dq: Joint velocities [rad/s], shape (7,).
        """
        return self._dynamics.torques(q, dq, self._ddq, self.load, self._gravity)


def _moments_at_link7(load: RigidBody) -> list[float]:
    """Return mass and moments of a load in the frame of link 7, 10 numbers."""
    x, y, z = load.center_of_mass
    inertia = np.reshape(load.inertia, (3, 3))
    # Six moments describe a symmetric tensor; rounding may make it slightly
    # asymmetric.
    return _moments(load.mass, [x, y, z + FLANGE_OFFSET], (inertia + inertia.T) / 2.0)


def _moments(
    mass: float, center: Sequence[float], inertia: NDArray[np.float64]
) -> list[float]:
    """Return mass and moments in the form of `ArmDynamics`, 10 numbers.

    Args:
        mass: Mass of a body [kg].
        center: Its centre of mass [m], shape (3,).
        inertia: Its inertia about the centre of mass [kg m^2], shape (3, 3).
    """
    second = np.trace(inertia) / 2.0 * np.eye(3) - inertia
    second += mass * np.outer(center, center)
    upper = second[np.triu_indices(3, 1)]
    first = [mass * value for value in center]
    return [mass, *first, *np.diag(second).tolist(), *upper.tolist()]


def read_bodies(description: RobotFiles) -> list[float]:
    """Return mass and moments of the links 1 to 7 in their own frames, 70 numbers.

    `station.core.numerics.arm_dynamics` defines them.

    Args:
        description: The URDF of a Franka arm.

    Raises:
        RobotDescriptionError: The URDF does not describe a Franka arm.
    """
    prefix, urdf = find_prefix(description), load_urdf(description)
    joints = [urdf.joints[f"{prefix}joint{number}"] for number in range(1, DOF + 1)]
    _check_geometry(description, joints)
    found: list[float] = []
    for joint in joints:
        inertial = urdf.links[joint.child].inertial
        if inertial is None:
            found += [0.0] * _MOMENTS
            continue
        body = combine([(Pose(), inertial)])
        xx, yy, zz, xy, xz, yz = body.inertia
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        found += _moments(body.mass, body.origin.xyz, tensor)
    return found


def _check_geometry(description: RobotFiles, joints: Sequence[Joint]) -> None:
    """Refuse a URDF whose joints are not at the places of a Franka arm's joints.

    Raises:
        RobotDescriptionError: A joint is elsewhere, or turns about another axis.
    """
    links, pose = new_links(CHAIN), Pose()
    place_links(CHAIN, zeros(DOF), links)
    for number, joint in enumerate(joints):
        pose = pose.compose(joint.origin)
        expected = links[16 * number : 16 * number + 16]
        away = [abs(a - b) for a, b in zip(as_transform(pose), expected, strict=True)]
        if max(away) > _TOLERANCE or joint.axis != (0.0, 0.0, 1.0):
            raise RobotDescriptionError(
                f"{description.urdf_path} is no Franka arm: joint {joint.name} is not "
                "where that of a Panda or FR3 is, or turns about another axis than z.",
                remedy="Use example-robot-data:panda, or a URDF of a Panda or FR3.",
            )
