"""The guard of a simulated robot, made from the collision geometry of its URDF."""

from collections.abc import Callable, Mapping, Sequence
from math import inf

import mujoco
import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.core.description.urdf import Pose, Urdf
from station.core.errors import ParameterError
from station.core.geometry.capsules import LinkCapsule, enclosing_capsule
from station.core.geometry.clearances import Clearances
from station.core.geometry.guard import Guard
from station.core.geometry.scene import SceneObject
from station.core.hardware.limits import JointLimits
from station.core.hardware.transmissions import RawJointData
from station.hw.link_guard import LinkGuard
from station.hw.mujoco.joint_command_modes import JointCommandModes
from station.hw.mujoco.world_joints import WorldJoints
from station.memory.doubles import doubles, put, zeros
from station.reports import Clearance

_Matrix = NDArray[np.float64]
# A drive brakes with 0.24 of its largest force over the inertia at the joint, see
# `joint_drives`. The inertia is the largest one in some random poses, so there is a
# reserve.
_SHARE_OF_FORCE = 0.2
_POSES = 60
# Speed and acceleration of joints without such limits [rad/s or m/s, rad/s^2 or m/s^2].
_FASTEST, _HARDEST = 10.0, 1000.0
# Larger than any jerk that matters: drives limit only the acceleration.
_ANY_JERK = 1e9
# A joint that no controller commands counts as moving above this speed [rad/s or m/s].
_MOVES = 1e-3
# Largest number of checked poses on a line: weak drives brake for more than a metre.
_MOST_STEPS = 60
_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
_ROUND = 24
"""Number of corners of the polygon around a cylinder."""


class RobotGuard(LinkGuard):
    """Keeps one simulated robot with a fixed base clear of its scene.

    The robot may lag behind its commands. So margins are enlarged by the largest
    distance of any point of the robot from its commanded place.

    Args:
        name: Name of the robot.
        model: The world's model.
        data: The world's data; control thread only.
        urdf: The robot.
        driven: Joints with a motor, as the control loop sees them.
        joints: State and commands of these joints, in the same order.
        modes: Joints that controllers command, and the quantity of the command.
        limits: Limits of these joints.

    Attributes:
        is_active: Whether the guard checks every command.
    """

    def __init__(
        self,
        name: str,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        *,
        urdf: Urdf,
        driven: WorldJoints,
        joints: RawJointData,
        modes: JointCommandModes,
        limits: Mapping[str, JointLimits],
    ) -> None:
        super().__init__(name, Pose())
        self._model, self._data, self._urdf = model, data, urdf
        self._driven, self._joints, self._modes = driven, joints, modes
        self._limits = limits
        self._is_made = self.is_active = False
        moving = [
            one.name for one in urdf.joints.values() if one.type.moves and not one.mimic
        ]
        self._names = [*joints.names, *(n for n in moving if n not in joints.names)]
        numbers = [model.joint(name).id for name in self._names]
        self._qpos = model.jnt_qposadr[numbers]
        self._dofs = model.jnt_dofadr[numbers]
        self._last: list[str | None] = []

    @override
    def links(self) -> Sequence[str]:
        model, links = self._model, self._urdf.links
        bodies = np.unique(model.geom_bodyid[model.geom_contype > 0]).tolist()
        found = [model.body(b).name for b in bodies if model.body_weldid[b]]
        return [one for one in found if one in links]

    @override
    def positions(self) -> Mapping[str, float]:
        return dict(zip(self._names, self._data.qpos[self._qpos].tolist(), strict=True))

    @override
    def report(self) -> Clearance | None:
        # The capsules are fitted when the first object with a role is added.
        return super().report() if self._is_made else None

    @override
    def nearest_at(self, positions: Mapping[str, float]) -> Clearance | None:
        return super().nearest_at(positions) if self._is_made else None

    @override
    def watch(self, *, is_active: bool) -> None:
        # Only a robot that was not guarded has to be located anew.
        if not self.is_active:
            self.restart()
        self.is_active = is_active

    def restart(self) -> None:
        """Begin anew from the present state of the robot; control thread."""
        self._last = []

    @override
    def prepare(
        self, objects: Sequence[SceneObject], arm_margin: float | None
    ) -> Callable[[], None]:
        if not self._is_made:
            if all(one.role == "object" for one in objects):
                return lambda: None
            self._make()
        if any(one.role != "object" for one in objects):
            self.refuse_efforts([
                name for name, kind in self._modes.in_use if kind == "effort"
            ])
        return super().prepare(objects, None)

    def refuse_efforts(self, joints: Sequence[str]) -> None:
        """Refuse efforts as commands of joints, because the guard cannot slow them.

        Args:
            joints: Names of the joints that efforts would command.

        Raises:
            ParameterError: There are such joints.
        """
        if joints:
            raise ParameterError(
                f"'{self.arm_id}' keeps clear of its scene by positions and "
                f"velocities alone, and {', '.join(joints)} would be commanded by "
                "efforts.",
                remedy="Command positions or velocities, or take the roles away.",
                details={"joints": [*joints]},
            )

    def limit(self, period: float) -> None:
        """Slow commands that would bring the robot too near its scene; control thread.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        guard, joints = self.guard, self._joints
        q = self._data.qpos[self._qpos].tolist()
        dq = self._data.qvel[self._dofs].tolist()
        kinds = [*self._modes.commanded, *([None] * (len(q) - len(joints.names)))]
        beginning = self._follow(kinds, q, dq)
        goals, rates = self._wanted(kinds, q, dq, period)
        guard.period = period
        put(guard.v, rates)
        # Without a velocity limit a joint can jump, which is no motion to be checked.
        steps = zip(rates, self._speed, strict=True)
        if any(abs(v) > 1.01 * most for v, most in steps) or not guard.passes():
            guard.catch_up(doubles(goals))
            for i, kind in enumerate(kinds):
                if kind != "position":
                    guard.v[i] = rates[i]
            guard.slow()
            rates = [*guard.v]
            for i, kind in enumerate(self._modes.commanded):
                goals[i] = guard.q_d[i] + rates[i] * period
                if kind == "position":
                    joints.position_command[i] = goals[i]
                elif kind == "velocity":
                    joints.velocity_command[i] = rates[i]
        else:
            # For a new position command, the step from the joint is lag, not velocity.
            for i in beginning:
                rates[i] = dq[i]
        put(
            guard.ddq_d,
            [(v - old) / period for v, old in zip(rates, guard.dq_d, strict=True)],
        )
        put(guard.dq_d, rates)
        put(guard.q_d, goals)

    def _follow(
        self, kinds: Sequence[str | None], q: Sequence[float], dq: Sequence[float]
    ) -> list[int]:
        """Start at the measured position for joints without earlier position commands.

        Returns:
            The joints whose position commands begin now.
        """
        guard, beginning = self.guard, []
        for i, kind in enumerate(kinds):
            is_new = not self._last or kind != self._last[i]
            if is_new or kind != "position":
                guard.q_d[i] = q[i]
            if is_new:
                guard.dq_d[i] = dq[i]
                if kind == "position":
                    beginning.append(i)
        self._last = [*kinds]
        return beginning

    def _wanted(
        self,
        kinds: Sequence[str | None],
        q: Sequence[float],
        dq: Sequence[float],
        period: float,
    ) -> tuple[list[float], list[float]]:
        """Return the commanded positions and velocities; store the lag."""
        guard, joints = self.guard, self._joints
        goals, rates, lag = [*q], [0.0] * len(q), 0.0
        for i, kind in enumerate(kinds):
            if kind == "position":
                goals[i] = joints.position_command[i]
                rates[i] = (goals[i] - guard.q_d[i]) / period
                lag += self._reach[i] * abs(guard.q_d[i] - q[i])
            elif kind == "velocity":
                rates[i] = joints.velocity_command[i]
                off = dq[i] - guard.dq_d[i]
                lag += self._reach[i] * 0.5 * off * off / self._acceleration[i]
            elif abs(dq[i]) > _MOVES:
                rates[i] = dq[i]
        guard.clearances.lag = lag
        return goals, rates

    def _make(self) -> None:
        """Make the capsules and the arithmetic, which takes some time."""
        model, data = self._model, mujoco.MjData(self._model)
        data.qpos[self._model.jnt_qposadr] = 0.0
        mujoco.mj_kinematics(model, data)
        bodies, rows, longest = self._tree(data)
        capsules, owners = self._capsules(data, bodies)
        self._is_made = True
        size = len(self._names)
        clearances = Clearances(
            doubles([0.0] * 4 * (size + 1)),
            [number for one in capsules for number in one.numbers()],
            owners,
            [number for row in rows for number in row],
            longest,
        )
        clearances.most_steps = _MOST_STEPS
        self._reach = [0.0] * size
        for joint, reach in zip(clearances.joints, clearances.reach, strict=True):
            self._reach[joint] = max(self._reach[joint], reach)
        limits = [self._limits.get(name, JointLimits()) for name in self._names]
        self._speed = [one.max_velocity or _FASTEST for one in limits]
        self._acceleration = self._decelerations(data, limits)
        self.guard = Guard(
            clearances,
            [one.link for one in capsules],
            {
                **{
                    name: zeros(size)
                    for name in ("q_d", "dq_d", "ddq_d", "q", "dq", "tau_J_d")
                },
                "O_T_EE_c": zeros(16),
                "O_dP_EE_c": zeros(6),
                "O_ddP_EE_c": zeros(6),
            },
            velocity=self._speed,
            acceleration=self._acceleration,
            jerk=[_ANY_JERK] * size,
            torque_step=0.0,
            translation=[0.0] * 4,
            period=float(model.opt.timestep),
        )

    def _tree(
        self, data: mujoco.MjData
    ) -> tuple[dict[int, tuple[int, _Matrix]], list[list[float]], list[float]]:
        """Describe the robot's moving links, with all joints at 0.

        Returns:
            For each body the index of the moving link that it is fixed to, and the pose
            of that link; the rows of `place_tree`; the largest absolute position in the
            range of each joint, 1 without a range.
        """
        model, rows, longest = self._model, list[list[float]](), list[float]()
        frames: dict[int, tuple[int, _Matrix]] = {0: (-1, np.eye(4))}
        for body in range(1, model.nbody):
            parent, above = frames.get(model.body_parentid[body], (-1, np.eye(4)))
            if model.body(body).name not in self._urdf.links:
                continue
            if not model.body_jntnum[body]:
                frames[body] = parent, above
                continue
            number = int(model.body_jntadr[body])
            name = model.joint(number).name
            factor, offset, mimic = 1.0, 0.0, self._urdf.joints[name].mimic
            while mimic is not None:
                factor, offset = (
                    factor * mimic.multiplier,
                    factor * mimic.offset + offset,
                )
                name = mimic.joint
                mimic = self._urdf.joints[name].mimic
            slides = model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE
            pose = _pose(data.xpos[body], data.xmat[body])
            pose[:3, :3] = pose[:3, :3] @ _turned_to(model.jnt_axis[number])
            local = np.linalg.inv(above) @ pose
            rows.append([
                float(parent), float(self._names.index(name)), float(slides), factor,
                offset, *local[:3, :3].T.ravel().tolist(), *local[:3, 3].tolist(),
            ])  # fmt: skip
            limited = bool(model.jnt_limited[number])
            longest.append(
                float(np.abs(model.jnt_range[number]).max()) if limited else 1.0
            )
            frames[body] = len(rows) - 1, pose
        return frames, rows, longest

    def _capsules(
        self, data: mujoco.MjData, bodies: Mapping[int, tuple[int, _Matrix]]
    ) -> tuple[list[LinkCapsule], list[int]]:
        """Return a capsule around each geometry of a moving link, and its link."""
        model, found, owners = self._model, list[LinkCapsule](), list[int]()
        for geom in np.flatnonzero(
            model.geom_contype | model.geom_conaffinity
        ).tolist():
            body = int(model.geom_bodyid[geom])
            link, frame = bodies.get(body, (-1, np.eye(4)))
            if link < 0:
                continue
            points, thicker = _points(model, geom)
            pose = np.linalg.inv(frame) @ _pose(
                data.geom_xpos[geom], data.geom_xmat[geom]
            )
            one = enclosing_capsule(
                model.body(body).name, points @ pose[:3, :3].T + pose[:3, 3]
            )
            found.append(
                LinkCapsule(one.link, one.first, one.second, one.radius + thicker)
            )
            owners.append(link)
        return found, owners

    def _decelerations(
        self, data: mujoco.MjData, limits: Sequence[JointLimits]
    ) -> list[float]:
        """Return each joint's possible deceleration in any pose [rad/s^2 or m/s^2]."""
        model, random = self._model, np.random.default_rng(1)
        lower, upper = np.full(model.nq, -np.pi), np.full(model.nq, np.pi)
        limited = model.jnt_limited.astype(bool)
        lower[model.jnt_qposadr[limited]] = model.jnt_range[limited, 0]
        upper[model.jnt_qposadr[limited]] = model.jnt_range[limited, 1]
        inertia = np.zeros(model.nv)
        for _ in range(_POSES):
            data.qpos[self._qpos] = random.uniform(lower, upper)[self._qpos]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            mujoco.mj_makeM(model, data)
            diagonal = data.M[model.M_rowadr + model.M_rownnz - 1]
            inertia = np.maximum(inertia, diagonal)
        forces = [*self._driven.effort_limits]
        forces += [inf] * (len(self._names) - len(forces))
        return [
            min(
                _SHARE_OF_FORCE * force / float(inertia[dof]),
                _HARDEST,
                limit.max_acceleration or _HARDEST,
            )
            for force, dof, limit in zip(forces, self._dofs, limits, strict=True)
        ]


def _pose(place: _Matrix, axes: _Matrix) -> _Matrix:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes.reshape(3, 3), place
    return pose


def _turned_to(axis: _Matrix) -> _Matrix:
    """Return axes with the given z axis."""
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    across /= np.linalg.norm(across)
    return np.column_stack([across, np.cross(axis, across), axis])


def _points(model: mujoco.MjModel, geom: int) -> tuple[_Matrix, float]:
    """Return points, and a distance [m] from them, that together enclose a geometry."""
    kinds, size = mujoco.mjtGeom, model.geom_size[geom]
    match kinds(int(model.geom_type[geom])):
        case kinds.mjGEOM_SPHERE:
            return np.zeros((1, 3)), float(size[0])
        case kinds.mjGEOM_BOX:
            return _CORNERS * size, 0.0
        case kinds.mjGEOM_CYLINDER:
            angles = np.arange(_ROUND) * (2.0 * np.pi / _ROUND)
            radius = size[0] / np.cos(np.pi / _ROUND)
            circle = np.column_stack([np.cos(angles), np.sin(angles)]) * radius
            ends = [np.column_stack([circle, np.full(_ROUND, z)]) for z in (-1, 1)]
            return np.vstack(ends) * [1.0, 1.0, size[1]], 0.0
        case _:
            mesh = int(model.geom_dataid[geom])
            first = int(model.mesh_vertadr[mesh])
            corners = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
            graph = int(model.mesh_graphadr[mesh])
            if graph >= 0:
                # Only the corners of the convex hull (MuJoCo, `mesh_graph`).
                count = int(model.mesh_graph[graph])
                begin = graph + 2 + count
                corners = corners[model.mesh_graph[begin : begin + count]]
            return corners.astype(np.float64), 0.0
