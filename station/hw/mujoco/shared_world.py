"""A MuJoCo world and the robots in it, as the control loop sees them."""

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import Protocol

import mujoco
import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.core.description.urdf import Pose
from station.core.hardware.robot_hw import SimulatedWorld
from station.core.hardware.robot_report import (
    ContactReport,
    MovingBaseReport,
    SceneObjectReport,
)
from station.hw.mujoco.bases import moving_bases
from station.hw.mujoco.world import World
from station.hw.mujoco.world_joints import joint_position_address

_FARTHEST = 1.0
"""Distance beyond which bodies do not count as near [m]."""
MOST_CONTACTS = 64
"""Largest number of reported contacts: a pile of objects has hundreds."""


class RobotInWorld(Protocol):
    """A robot whose world can be reset."""

    def begin_anew(self) -> None:
        """Continue from the pose to which the world was reset. Control thread."""

    def longest_period(self) -> float:
        """Return the longest time that may pass for the robot in one cycle [s]."""


class SharedWorld(SimulatedWorld):
    """Resets one MuJoCo world for all robots in it. Control thread only.

    Args:
        world: The MuJoCo world.
        keyframes: The named poses: joint name to position [rad or m].

    Attributes:
        world: As given.
    """

    def __init__(
        self,
        world: World,
        keyframes: Mapping[str, Mapping[str, float]] | None = None,
    ) -> None:
        self.world = world
        self._keyframes = keyframes or {}
        self._robots: list[RobotInWorld] = []

    def add_robot(self, robot: RobotInWorld) -> None:
        """Add a robot, which starts again after every reset of the world."""
        self._robots.append(robot)

    @override
    def time(self) -> float:
        return self.world.time

    @override
    def reset(self, positions: Mapping[str, float]) -> None:
        self.world.reset(positions)
        for robot in self._robots:
            robot.begin_anew()

    @override
    def keyframes(self) -> Mapping[str, Mapping[str, float]]:
        return self._keyframes

    @override
    def place_object(self, name: str, pose: Pose) -> None:
        self.world.place_object(name, pose)

    @override
    def scene(self) -> Sequence[SceneObjectReport]:
        return self.world.scene()

    @override
    def bases(self) -> Sequence[MovingBaseReport]:
        return moving_bases(self.world.model, self.world.data)

    @override
    def contacts(self) -> Sequence[ContactReport]:
        return touching(self.world.model, self.world.data)

    @override
    def distances(self) -> Callable[[], tuple[str, str, float] | None]:
        model, data = self.world.model, self.world.data
        things = {thing.name for thing in self.world.scene()}
        touching_now = {one.bodies for one in self.contacts()}
        pairs = _pairs(model, things, touching_now)
        if not len(pairs):
            return lambda: None
        first, second = pairs.T
        reach = model.geom_rbound[first] + model.geom_rbound[second]
        # A plane has size 0, so it has no bound and is always measured.
        reach[model.geom_type[second] == mujoco.mjtGeom.mjGEOM_PLANE] = inf

        def find() -> tuple[str, str, float] | None:
            middle = data.geom_xpos
            bounds = np.linalg.norm(middle[first] - middle[second], axis=1) - reach
            best, found = _FARTHEST, -1
            for k in np.argsort(bounds).tolist():
                if bounds[k] >= best:
                    break
                one, other = first[k], second[k]
                far = mujoco.mj_geomDistance(model, data, one, other, best, None)
                if far < best:
                    best, found = far, k
            if found < 0:
                return None
            one, other = pairs[found].tolist()
            return _body_of(model, one), _body_of(model, other), best

        return find

    @override
    def nearness(
        self,
        joints: Sequence[str],
        margin: float,
        carried: Mapping[str, str] | None = None,
    ) -> Callable[[Sequence[float]], Sequence[tuple[str, str, float]]]:
        model, data = self.world.model, self.world.data
        addresses = [joint_position_address(model, name) for name in joints]
        model.geom_margin[:] = margin
        grips = [
            (name, link, _pose_of(data, link).inverse().compose(_pose_of(data, name)))
            for name, link in (carried or {}).items()
            if model.body(name).jntnum[0]  # a body fixed to the world stays there
        ]

        def find(pose: Sequence[float]) -> Sequence[tuple[str, str, float]]:
            data.qpos[addresses] = pose
            mujoco.mj_kinematics(model, data)
            for name, link, grip in grips:
                self.place_object(name, _pose_of(data, link).compose(grip))
            mujoco.mj_collision(model, data)
            if not data.ncon:
                return ()
            contact = data.contact
            found = zip(contact.geom.tolist(), contact.dist.tolist(), strict=True)
            return [
                (_body_of(model, one), _body_of(model, other), distance)
                for (one, other), distance in found
                if distance < margin
            ]

        return find

    @override
    def longest_period(self) -> float:
        """Return the largest of the robots' longest periods [s]; inf without robots."""
        return max((robot.longest_period() for robot in self._robots), default=inf)


def _pairs(
    model: mujoco.MjModel, things: set[str], left_out: set[tuple[str, str]]
) -> NDArray[np.int64]:
    """Return pairs of a robot's geometry and another body's geometry, shape (k, 2).

    Args:
        model: The world's model.
        things: Names of the bodies that belong to no robot.
        left_out: Pairs of bodies to leave out.
    """
    body = model.geom_bodyid
    solid = np.flatnonzero(model.geom_contype | model.geom_conaffinity).tolist()
    # Links fixed to the world, such as the base of an arm, cannot come near anything.
    links = [
        one
        for one in solid
        if model.body_weldid[body[one]] and _body_of(model, one) not in things
    ]
    found = [
        (one, other)
        for one in links
        for other in solid
        if model.body_rootid[body[one]] != model.body_rootid[body[other]]
        # A robot's first moving link is always near the floor: the pair is left out.
        and (body[other] or model.body_weldid[model.body_parentid[body[one]]])
        and not (other in links and other < one)
        and (
            model.geom_contype[one] & model.geom_conaffinity[other]
            or model.geom_contype[other] & model.geom_conaffinity[one]
        )
        and left_out.isdisjoint({
            (_body_of(model, one), _body_of(model, other)),
            (_body_of(model, other), _body_of(model, one)),
        })
    ]
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def touching(model: mujoco.MjModel, data: mujoco.MjData) -> list[ContactReport]:
    """Return the contacts of the last step. For the thread that steps the world.

    MuJoCo gives a force in the axes of the contact, whose first axis points from the
    first geometry to the second one (MuJoCo documentation, `mjContact`,
    `mj_contactForce`).

    Args:
        model: The world's model.
        data: The world's data.
    """
    found = []
    wrench = np.zeros(6)
    for i in range(min(data.ncon, MOST_CONTACTS)):
        contact = data.contact[i]
        mujoco.mj_contactForce(model, data, i, wrench)
        axes = contact.frame.reshape(3, 3)  # its rows
        first, second = (_body_of(model, geom) for geom in contact.geom)
        found.append(
            ContactReport(
                (first, second),
                tuple(contact.pos.tolist()),
                tuple((axes.T @ wrench[:3]).tolist()),
            )
        )
    return found


def _pose_of(data: mujoco.MjData, body: str) -> Pose:
    found = data.body(body)
    (x, y, z), (w, i, j, k) = found.xpos.tolist(), found.xquat.tolist()
    return Pose((x, y, z), (w, i, j, k))


def _body_of(model: mujoco.MjModel, geom: int) -> str:
    name: str = model.body(model.geom_bodyid[geom]).name
    return name
