"""Build a simulated world with one robot that has a URDF."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import inf, sqrt

import mujoco
import numpy as np

from station.core.description.robot_files import RobotFiles
from station.core.description.srdf import disabled_collisions
from station.core.description.urdf import Joint, JointType, Pose, Urdf
from station.core.description.urdf_repair import Repair
from station.core.errors import ParameterError, RobotDescriptionError
from station.core.geometry.scene import SceneObject
from station.hw.mujoco.joint_drives import VELOCITY_GAIN
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_object,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.mujoco.mujoco_robot_parameters import MujocoRobotParameters
from station.hw.mujoco.robot_transmissions import driven_joints
from station.hw.mujoco.sensors import add_sensors
from station.hw.mujoco.world import World

Pair = tuple[str, str]
_MOST_NAMED = 12


def rigid_neighbours(urdf: Urdf) -> list[Pair]:
    """Return the pairs of links with only one moving joint between them.

    Links that are rigidly joined to a joint's parent are as near to its child as the
    parent is. Pairs that a joint connects directly are left out, because they are never
    tested for contact, and so are links without collision shapes.

    Args:
        urdf: The robot.
    """
    groups: dict[str, list[str]] = {}
    for name, link in urdf.links.items():
        root, _ = urdf.fixed_root(name)
        members = groups.setdefault(root, [])
        if link.collisions:
            members.append(name)
    pairs: set[Pair] = set()
    direct = {_sorted(j.parent, j.child) for j in urdf.joints.values()}
    for joint in urdf.joints.values():
        if joint.type.moves:
            above, _ = urdf.fixed_root(joint.parent)
            below = groups.get(joint.child, [])
            pairs |= {_sorted(a, b) for a, b in product(groups[above], below)}
    return sorted(pairs - direct)


def touching_pairs(model: mujoco.MjModel, data: mujoco.MjData) -> list[Pair]:
    """Return the pairs of bodies that touch now, by name, without the world."""
    found: set[Pair] = set()
    for number in range(int(data.ncon)):
        contact = data.contact[number]
        bodies = [int(model.geom_bodyid[geom]) for geom in contact.geom]
        # Body 0 is the world, with the floor.
        if 0 not in bodies:
            first, second = (model.body(body).name for body in bodies)
            found.add(_sorted(first, second))
    return sorted(found)


def tell_pairs(pairs: Sequence[Pair], why: str) -> list[Repair]:
    """Return a repair that lists pairs which are excluded from self-collision.

    Args:
        pairs: Names of links.
        why: The reason, as a clause.
    """
    if not pairs:
        return []
    return [
        Repair(
            "self_collision",
            f"{len(pairs)} pair(s) of links",
            why,
            "",
            f"never touch: {_names(pairs)}",
        )
    ]


def tell_contacts(pairs: Sequence[Pair]) -> Repair:
    """Return a repair that lists links which touch at the start and push apart.

    Args:
        pairs: Names of links, at least one pair.
    """
    return Repair(
        "start_pose",
        f"{len(pairs)} pair(s) of links",
        f"they touch in the start pose: {_names(pairs)}",
        "",
        "left to push each other apart; self_collision: srdf excludes them",
    )


def _names(pairs: Iterable[Pair]) -> str:
    names = [f"{first} and {second}" for first, second in pairs]
    more = len(names) - _MOST_NAMED
    shown = ", ".join(names[:_MOST_NAMED])
    return f"{shown} and {more} more" if more > 0 else shown


def _sorted(first: str, second: str) -> Pair:
    return (first, second) if first <= second else (second, first)


_FLOOR = "floor"
_TOUCHES = 1e-6
"""Depth in the floor up to which a robot counts as standing on it [m]."""
_MOST_DAMPING = 2.0
"""Share of a velocity that damping may take in a step of RK4, which is explicit: above
2.78 the velocity would grow. The margin is for other poses than the first one."""


@dataclass(frozen=True, slots=True)
class SimulatedRobot:
    """A world with one robot in it.

    Attributes:
        world: The world, at the robot's start pose and at rest.
        base: The root link's pose at the start.
        repairs: Repairs of the robot's contacts and of its start pose.
    """

    world: World
    base: Pose
    repairs: tuple[Repair, ...]


def simulate_robot(
    description: RobotFiles,
    urdf: Urdf,
    parameters: MujocoRobotParameters,
    objects: Sequence[SceneObject] = (),
) -> SimulatedRobot:
    """Return a world with the robot in it, at its start pose and at rest.

    Args:
        description: The robot description.
        urdf: The parsed URDF of the description.
        parameters: Place and properties of the robot.
        objects: The other objects in the world.

    Raises:
        ParameterError: A start position or a sensor's link is impossible.
        RobotDescriptionError: The robot cannot be simulated.
    """
    try:
        return _Simulation(description, urdf, parameters, objects).make()
    except RobotDescriptionError as exc:
        raise RobotDescriptionError(
            f"{description.urdf_path}: {exc.message}", remedy=exc.remedy
        ) from exc


class _Simulation:
    """Builds the world, checks the start pose, and builds it again if necessary."""

    def __init__(
        self,
        description: RobotFiles,
        urdf: Urdf,
        parameters: MujocoRobotParameters,
        objects: Sequence[SceneObject],
    ) -> None:
        self._urdf = urdf
        self._parameters = parameters
        self._objects = objects
        self._start = _start_positions(urdf, parameters.initial_positions)
        self._base = parameters.base
        self._pairs: list[Pair] = []
        self._repairs: list[Repair] = []
        if parameters.self_collision == "srdf":
            pairs = disabled_collisions(description.srdf_path)
            self._pairs += [pair for pair in pairs if urdf.links.keys() >= {*pair}]
            if self._pairs and description.srdf_path is not None:
                why = f"{description.srdf_path.name} disables their collisions"
                self._repairs += tell_pairs(self._pairs, why)
            if not parameters.strict:
                self._exclude(rigid_neighbours(urdf), "one joint alone separates them")

    def make(self) -> SimulatedRobot:
        """Return the world at the robot's start pose."""
        world = self._build()
        lenient = not self._parameters.strict
        found = self._find_touching(world)
        if found and lenient and self._parameters.self_collision == "srdf":
            self._exclude(found, "they touch in the start pose")
            world = self._build()
        elif found:
            self._repairs.append(tell_contacts(found))
        depth = depth_in_floor(world.model, world.data) if lenient else 0.0
        if depth > _TOUCHES and self._lift(depth):
            world = self._build()
        self._choose_integrator(world)
        self._tell_additions()
        return SimulatedRobot(world, self._base, tuple(self._repairs))

    def _choose_integrator(self, world: World) -> None:
        """Integrate by RK4 if the parameters ask for it, or if the robot has no motors.

        The error of one Euler step in the coupling of joints is of first order: a
        double pendulum loses 12 % of its energy in 5 s. Motors need the implicit
        damping of `implicitfast`, and rotors decouple the joints that they drive.

        Raises:
            ParameterError: RK4 is requested, and the damping is too strong for it.
        """
        wanted = self._parameters.integrator
        if wanted == "implicitfast" or (wanted == "auto" and world.model.nu):
            return
        rate = _damping_rate(world.model, world.data)
        if rate * world.timestep <= _MOST_DAMPING:
            world.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
        elif wanted == "rk4":
            raise ParameterError(
                f"robot.integrator is 'rk4', and damping stops a joint at the rate of "
                f"{rate:.4g}/s; with a timestep of {world.timestep:g} s it may be "
                f"{_MOST_DAMPING / world.timestep:.4g}/s.",
                remedy=f"Set robot.timestep to {_MOST_DAMPING / rate:.2g} or less, or "
                "robot.integrator to auto.",
                details={"parameter": "robot/integrator"},
            )

    def _tell_additions(self) -> None:
        """List the additions of the simulation among the repairs."""
        armature, moves = self._parameters.armature, self._start
        if armature > 0.0 and driven_joints(self._urdf):
            problem = "its URDF states no inertia of rotors and gears"
            new = f"{armature:g} kg m^2, or kg, at each joint that a motor drives"
            self._repairs.append(Repair("armature", "robot", problem, "", new))
        if self._parameters.gravity_compensation and moves:
            problem = "its joints would have to carry its weight"
            new = "each link is lifted by its weight (gravity_compensation: true)"
            self._repairs.append(Repair("gravity", "robot", problem, "", new))

    def _build(self) -> World:
        parameters = self._parameters
        spec = new_world(parameters.timestep, floor=parameters.has_floor)
        options = RobotOptions(
            base=self._base,
            base_type=parameters.base_type,
            armature=parameters.armature,
            slide_armature=parameters.armature,
            gravity_compensation=parameters.gravity_compensation,
            disabled_collisions=tuple(self._pairs),
            self_collision=parameters.self_collision != "off",
        )
        add_robot(spec, self._urdf, options)
        add_sensors(spec, parameters.sensors, parameters.magnetic_field)
        for one in self._objects:
            add_object(spec, one)
        world = World(compile_world(spec), self._objects)
        world.begin_at(self._start)
        return world

    def _find_touching(self, world: World) -> list[Pair]:
        """Return the pairs of the robot's links that touch now."""
        robot = set(self._urdf.links)
        touching = touching_pairs(world.model, world.data)
        return [pair for pair in touching if robot.issuperset(pair)]

    def _exclude(self, pairs: list[Pair], why: str) -> None:
        known = {frozenset(pair) for pair in self._pairs}
        new = [pair for pair in pairs if frozenset(pair) not in known]
        self._pairs += new
        self._repairs += tell_pairs(new, why)

    def _lift(self, depth: float) -> bool:
        """Lift a robot out of the floor; return False if its place is configured."""
        problem = f"its start pose is {depth:.4g} m deep in the floor"
        place = f"base at z = {self._base.xyz[2]:.4g} m"
        if self._parameters.has_own_place:
            new = "left there, because base_xyz says so"
            self._repairs.append(Repair("start_pose", "robot", problem, "", new))
            return False
        x, y, z = self._base.xyz
        self._base = Pose((x, y, z + depth), self._base.quaternion)
        new = f"base at z = {z + depth:.4g} m, so that it stands on the floor"
        self._repairs.append(Repair("start_pose", "robot", problem, place, new))
        return True


def _damping_rate(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Return the largest rate at which damping and servos stop a motion [1/s].

    Args:
        model: The world's model.
        data: The world's data, at the start pose.
    """
    inverse = np.eye(model.nv)
    mujoco.mj_solveM(model, data, inverse, inverse.copy())
    inertia = data.M[model.M_rowadr + model.M_rownnz - 1]
    damping = model.dof_damping.copy()
    dofs = model.jnt_dofadr[model.actuator_trnid[:, 0]]
    servos = np.maximum(VELOCITY_GAIN * inertia[dofs], -model.actuator_biasprm[:, 2])
    np.add.at(damping, dofs, servos)
    return float(np.abs(np.linalg.eigvals(inverse * damping)).max(initial=0.0))


def _start_positions(urdf: Urdf, wanted: Mapping[str, float]) -> dict[str, float]:
    moving = {
        name: joint
        for name, joint in urdf.joints.items()
        if joint.type is not JointType.FIXED and joint.mimic is None
    }
    for name in wanted:
        if name not in moving:
            raise ParameterError(
                f"initial_positions names '{name}'; no joint of that name moves by "
                "itself.",
                remedy=f"Choose among {', '.join(moving) or 'none'}.",
                details={"joint": name},
            )
    positions = {
        name: _start_position(joint, wanted.get(name)) for name, joint in moving.items()
    }
    for joint in urdf.joints.values():
        if joint.type is not JointType.FIXED and joint.mimic is not None:
            leader = positions[joint.mimic.joint]
            positions[joint.name] = joint.mimic.multiplier * leader + joint.mimic.offset
    return positions


def _start_position(joint: Joint, wanted: float | None) -> float:
    """Return the start position of a joint: as configured, or 0, or mid-range.

    Raises:
        ParameterError: The configured position is outside the joint's range.
    """
    limit = joint.limit
    if limit is None or limit.lower is None or limit.upper is None:
        return wanted or 0.0
    if wanted is None:
        inside = limit.lower < 0.0 < limit.upper
        return 0.0 if inside else (limit.lower + limit.upper) / 2.0
    if not limit.lower <= wanted <= limit.upper:
        raise ParameterError(
            f"initial_positions/{joint.name} is {wanted}; the joint's range is "
            f"{limit.lower} to {limit.upper}.",
            remedy="Choose a position within the range.",
            details={"joint": joint.name},
        )
    return wanted


def depth_in_floor(model: mujoco.MjModel, data: mujoco.MjData) -> float:
    """Return the depth of the lowest body in the floor [m]; 0 if none is in it.

    Bodies that cannot move are ignored: contacts do not push them out of the floor.

    Args:
        model: The world's model.
        data: The world's data, with the contacts of its present pose.
    """
    floor = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, _FLOOR)
    lowest = 0.0
    for number in range(int(data.ncon)):
        geoms = [int(geom) for geom in data.contact[number].geom]
        if floor not in geoms:
            continue
        (geom,) = (geom for geom in geoms if geom != floor)
        # Only geometries of robots have a group.
        if model.geom_group[geom]:
            lowest = min(lowest, _lowest_point(model, data, geom))
    return -lowest


def _lowest_point(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Return the height of a geometry's lowest point [m]."""
    height = float(data.geom_xpos[geom][2])
    row = data.geom_xmat[geom].reshape(3, 3)[2]
    size = model.geom_size[geom]
    match mujoco.mjtGeom(int(model.geom_type[geom])):
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return height - float(size[0])
        case mujoco.mjtGeom.mjGEOM_BOX:
            return height - float(np.abs(row) @ size)
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            across = sqrt(max(0.0, 1.0 - float(row[2]) ** 2))
            return height - float(size[0]) * across - float(size[1] * abs(row[2]))
        case mujoco.mjtGeom.mjGEOM_MESH:
            mesh = int(model.geom_dataid[geom])
            first = int(model.mesh_vertadr[mesh])
            points = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
            return height + float((points @ row).min())
    return inf
