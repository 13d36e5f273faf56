"""Build a MuJoCo model from robots described by URDFs and objects of a scene.

`new_world` makes an empty world, `add_robot` puts a robot into it (any number of
robots, and more than one of a kind, under different names), `add_object` an object, and
`compile_world` makes the model. This module contains nothing about particular robots.

Names: a body has its link's name. A link without mass and shapes becomes a site of the
same name on the link that carries it. A joint's motor has the joint's name.

Motors: force = ctrl + bias with the bias -K q - D dq. K and D are 0 in the compiled
model, so a motor is a pure force source; `World` changes them while it runs to make a
servo, whose damping the integrator then treats implicitly. The force is limited to the
URDF's effort; a joint whose effort limit is 0 is passive and has no motor.
"""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import mujoco

from station.core.description.urdf import (
    Joint,
    JointType,
    Link,
    Mimic,
    Pose,
    Shape,
    Urdf,
)
from station.core.errors import RobotDescriptionError
from station.core.geometry.scene import SceneObject, check_mesh_file
from station.hw.mujoco.bases import BaseType, add_base_joints
from station.hw.mujoco.inertia import carried_inertials, combine, is_rigid_body

_BINARY_STL_HEADER = 84
_BINARY_STL_TRIANGLE = 50
_MAX_REASON = 200
_LEAST_CORNERS = 4


def add_mesh(spec: mujoco.MjSpec, name: str, shape: Shape) -> None:
    """Add a mesh asset; MuJoCo uses the convex hull of the mesh for collisions.

    MuJoCo reads binary STL and OBJ itself; other formats (Collada, ASCII STL) are read
    with trimesh and handed over as vertices and faces.

    Args:
        spec: The world; changed.
        name: Name of the new asset.
        shape: A shape of kind `mesh`.

    Raises:
        RobotDescriptionError: The file is missing, too large, has no triangles or is
            of an unknown format.
    """
    path = shape.mesh
    if path is None:
        raise RobotDescriptionError(
            f"The mesh '{name}' has no file.", remedy="Name a file in the URDF."
        )
    check_mesh_file(path)
    mesh = spec.add_mesh(name=name, scale=shape.size)
    mesh.info = str(path)  # for `compile_world`, if MuJoCo refuses the mesh
    # The link's inertia comes from the URDF; thin or open meshes are not an error.
    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX
    is_obj = path.suffix.lower() == ".obj"
    if is_obj:
        _check_obj(path)
    if is_obj or _is_binary_stl(path):
        mesh.file = str(path)
        return
    vertices, faces = _load_with_trimesh(path)
    mesh.uservert = vertices
    mesh.userface = faces


def _check_obj(path: Path) -> None:
    """Refuse a truncated OBJ file, which MuJoCo does not notice or does not name.

    Raises:
        RobotDescriptionError: The mesh has no triangles, or a triangle refers to a
            corner that is missing.
    """
    corners = faces = highest = 0
    with path.open("rb") as file:
        for line in file:
            words = line.split()
            if not words:
                continue
            if words[0] == b"v":
                corners += 1
            elif words[0] == b"f":
                faces += 1
                numbers = [word.partition(b"/")[0] for word in words[1:]]
                known = [int(n) for n in numbers if n.isdigit()]  # < 0 count backwards
                highest = max(highest, *known, 0)
    if not faces or corners < _LEAST_CORNERS:
        problem = f"has {corners} corners and {faces} triangles"
    elif highest > corners:
        problem = f"has a triangle with corner {highest}, and {corners} corners"
    else:
        return
    raise RobotDescriptionError(
        f"The mesh file {path} {problem}.",
        remedy="Use another file; this one is empty or cut.",
    )


def _is_binary_stl(path: Path) -> bool:
    if path.suffix.lower() != ".stl":
        return False
    with path.open("rb") as file:
        header = file.read(_BINARY_STL_HEADER)
    triangles = int.from_bytes(header[-4:], "little")
    size = _BINARY_STL_HEADER + _BINARY_STL_TRIANGLE * triangles
    return len(header) == _BINARY_STL_HEADER and path.stat().st_size == size


def _load_with_trimesh(path: Path) -> tuple[list[float], list[int]]:
    # Imported on demand: trimesh takes half a second, and most robots do not need it.
    import trimesh
    from collada import DaeError

    # Errors that trimesh's readers raise for an empty or truncated file.
    foreign = (ValueError, LookupError, OSError, TypeError, AttributeError, DaeError)
    try:
        mesh = trimesh.load_scene(path).to_mesh()
    except foreign as exc:
        reason = " ".join(str(exc).split())[:_MAX_REASON].removesuffix(".")
        raise RobotDescriptionError(
            f"The mesh file {path} cannot be read: {reason}.",
            remedy="Use another file, or convert this one to STL or OBJ.",
        ) from exc
    if len(mesh.faces) == 0:
        raise RobotDescriptionError(
            f"The mesh file {path} has no triangles.", remedy="Use another file."
        )
    return mesh.vertices.ravel().tolist(), mesh.faces.ravel().tolist()


_COLLISION_GROUP = 3
# Between the link's name and the number of the shape.
_COLLISION = "_collision_"
# The part of MuJoCo's error message that names the refused element.
_ELEMENT = re.compile(r"Element name '(?P<name>[^']+)', id \d+")
# Time constant of constraints that are hard on a real robot (mechanical stops, mimic
# joints), in time steps; MuJoCo allows no less than 2 (its `refsafe`).
_HARD_CONSTRAINT_STEPS = 2.0
# Part that MuJoCo's default impedance of a stop, 0.95, leaves. A stop that would yield
# by more than 0.3 degrees is made stiffer.
_IMPEDANCE_LEFT = 0.05
_MOST_YIELD = 0.005
_STIFF_IMPEDANCE = 0.9995
_LEAST_INERTIA = 1e-3
# Stiffness of friction relative to that of the contact. MuJoCo's friction is soft: a
# held object creeps in proportion to its load. 0.5 kg between fingers that press with
# 20 N creeps by 3 mm in 10 s with MuJoCo's pyramids and a ratio of 1, and by 0.015 mm
# with cones and a ratio of 100.
_FRICTION_STIFFNESS = 100.0


@dataclass(frozen=True, slots=True)
class RobotOptions:
    """The place of a robot in the world, and properties that its URDF does not state.

    Attributes:
        base: The root link's pose in the world.
        armature: Inertia of rotor and gears as seen at each revolute joint that a motor
            drives [kg m^2], >= 0. Source of the default: mujoco_menagerie
            franka_emika_panda/panda.xml, the `panda` default class.
        slide_armature: Inertia at each prismatic joint that a motor drives [kg], >= 0.
        gravity_compensation: Whether each link is lifted by a force equal to its
            weight, so that the motors need not carry the robot.
        disabled_collisions: Pairs of links that are never tested for contact, besides
            pairs joined by a joint.
        self_collision: Whether the robot's links can touch one another at all.
        base_type: How the root link is held.
    """

    base: Pose = field(default_factory=Pose)
    armature: float = 0.1
    slide_armature: float = 0.0
    gravity_compensation: bool = True
    disabled_collisions: tuple[tuple[str, str], ...] = ()
    self_collision: bool = True
    base_type: BaseType = "fixed"


def new_world(timestep: float, *, floor: bool = True) -> mujoco.MjSpec:
    """Return a world with gravity along -z and an optional floor at z = 0.

    Args:
        timestep: Duration of a simulation step, the loop's period [s], > 0.
        floor: Whether there is a floor.
    """
    spec = mujoco.MjSpec()
    spec.option.timestep = timestep
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.impratio = _FRICTION_STIFFNESS
    # Without automatic resets, because a diverged simulation must be reported.
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    spec.compiler.degree = False
    spec.compiler.autolimits = False
    if floor:
        spec.worldbody.add_geom(
            name="floor",
            type=mujoco.mjtGeom.mjGEOM_PLANE,
            size=[0.0, 0.0, 0.1],
        )
    return spec


def add_robot(spec: mujoco.MjSpec, urdf: Urdf, options: RobotOptions) -> None:
    """Add a robot to the world.

    Args:
        spec: The world; changed.
        urdf: The robot. Its names must not be in the world yet; see
            `RobotFiles.with_prefix`.
        options: Place and properties.

    Raises:
        RobotDescriptionError: MuJoCo refuses an element of the robot, e.g. a name that
            another robot in the world has.
    """
    with _refusals_explained(spec):
        _RobotBuilder(spec, urdf, options).build()


def compile_world(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Return the compiled model.

    Raises:
        RobotDescriptionError: MuJoCo refuses an element of a URDF, e.g. an inertia that
            no rigid body has, or a name used twice.
    """
    with _refusals_explained(spec):
        return spec.compile()


@contextmanager
def _refusals_explained(spec: mujoco.MjSpec) -> Iterator[None]:
    try:
        yield
    except RobotDescriptionError:
        raise
    except ValueError as exc:
        reason = " ".join(str(exc).split()).removeprefix("Error: ")
        reason = reason.replace("; use 'balanceinertia' to fix", "")
        where = "<robot>"
        found = _ELEMENT.search(reason)
        if found is not None:
            where = f"the element named {found['name']!r}"
            reason = reason[: found.start()].strip()
            mesh = spec.mesh(found["name"])
            if mesh is not None and mesh.info:
                link, is_of_link, _ = found["name"].rpartition(_COLLISION)
                if is_of_link:
                    where = f"link {link!r} <collision>"
                raise RobotDescriptionError(
                    f"{where}: MuJoCo cannot use the mesh file {mesh.info}: {reason}.",
                    remedy="Use another file, with four corners that are not in one "
                    "plane.",
                ) from exc
        raise RobotDescriptionError(
            f"{where}: MuJoCo cannot simulate it: {reason}",
            remedy="correct that element of the URDF; a link that moves needs an "
            "<inertial> that some body can have",
        ) from exc


class _RobotBuilder:
    """Adds the links and joints of a URDF to the world, from the root on."""

    def __init__(self, spec: mujoco.MjSpec, urdf: Urdf, options: RobotOptions) -> None:
        self._spec = spec
        self._urdf = urdf
        self._options = options
        self._hard = _HARD_CONSTRAINT_STEPS * spec.option.timestep
        # The body that carries each link; frame-only links share their parent's.
        self._body_of_link: dict[str, str] = {}

    def build(self) -> None:
        self._add_link(
            self._urdf.links[self._urdf.root],
            parent=self._spec.worldbody,
            pose=self._options.base,
            joint=None,
            is_base=self._options.base_type != "fixed",
        )
        for joint in self._urdf.joints.values():
            self._add_motor_or_mimic(joint)
        self._exclude_collisions()

    def _add_link(
        self,
        link: Link,
        *,
        parent: mujoco.MjsBody,
        pose: Pose,
        joint: Joint | None,
        is_base: bool = False,
    ) -> None:
        """Add a link at `pose` in `parent`, and all links below that link.

        Args:
            link: The link.
            parent: Body to which the link is added.
            pose: Pose of the link's frame in the frame of the parent.
            joint: The moving joint between them, or None if there is none.
            is_base: Whether the link is a base that moves in the world.
        """
        if joint is None and link.is_frame_only and not is_base:
            parent.add_site(name=link.name, pos=pose.xyz, quat=pose.quaternion)
            self._body_of_link[link.name] = parent.name
            body, origin = parent, pose
        else:
            body = parent.add_body(name=link.name, pos=pose.xyz, quat=pose.quaternion)
            self._fill_body(body, link, moves=joint is not None or is_base)
            if is_base:
                add_base_joints(self._spec, body, self._options.base_type)
            if joint is not None:
                self._add_joint(body, joint)
            origin = Pose()
        for below in self._urdf.joints_below(link.name):
            self._add_link(
                self._urdf.links[below.child],
                parent=body,
                pose=origin.compose(below.origin),
                joint=None if below.type is JointType.FIXED else below,
            )

    def _fill_body(self, body: mujoco.MjsBody, link: Link, *, moves: bool) -> None:
        self._body_of_link[link.name] = body.name
        body.gravcomp = 1.0 if self._options.gravity_compensation else 0.0
        body.explicitinertial = True
        parts = list(carried_inertials(self._urdf, link).values())
        if parts:
            inertial = combine(parts)
            # A link that cannot move needs no inertia, and MuJoCo refuses invalid ones.
            if moves or is_rigid_body(inertial):
                body.mass = inertial.mass
                body.ipos = inertial.origin.xyz
                ixx, iyy, izz, ixy, ixz, iyz = inertial.inertia
                body.fullinertia = [ixx, iyy, izz, ixy, ixz, iyz]
        for number, shape in enumerate(link.collisions):
            try:
                self._add_shape(body, f"{link.name}{_COLLISION}{number}", shape)
            except RobotDescriptionError as exc:
                raise RobotDescriptionError(
                    f"link {link.name!r} <collision>: {exc.message}", remedy=exc.remedy
                ) from exc

    def _add_shape(self, body: mujoco.MjsBody, name: str, shape: Shape) -> None:
        geom = body.add_geom(
            name=name,
            pos=shape.origin.xyz,
            quat=shape.origin.quaternion,
            group=_COLLISION_GROUP,
        )
        if not self._options.self_collision:
            # It touches geometries of type 1, the floor and objects, but not itself.
            geom.contype, geom.conaffinity = 2, 1
        match shape.kind:
            case "box":
                geom.type = mujoco.mjtGeom.mjGEOM_BOX
                geom.size = [edge / 2.0 for edge in shape.size]
            case "sphere":
                geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
                geom.size[0] = shape.size[0]
            case "cylinder":
                geom.type = mujoco.mjtGeom.mjGEOM_CYLINDER
                geom.size[:2] = [shape.size[0], shape.size[1] / 2.0]
            case _:
                geom.type = mujoco.mjtGeom.mjGEOM_MESH
                geom.meshname = name
                add_mesh(self._spec, name, shape)

    def _add_joint(self, body: mujoco.MjsBody, joint: Joint) -> None:
        slides = joint.type is JointType.PRISMATIC
        kind, options = mujoco.mjtJoint, self._options
        # A joint without a motor, of its own or of its leader, has no rotor.
        is_driven = _has_motor(
            joint if joint.mimic is None else self._urdf.joints[joint.mimic.joint]
        )
        armature = options.slide_armature if slides else options.armature
        added = body.add_joint(
            name=joint.name,
            type=kind.mjJNT_SLIDE if slides else kind.mjJNT_HINGE,
            axis=joint.axis,
            armature=armature if is_driven else 0.0,
            frictionloss=joint.friction,
        )
        added.damping[0] = joint.damping
        limit = joint.limit
        if limit is not None and limit.lower is not None and limit.upper is not None:
            added.limited = mujoco.mjtLimited.mjLIMITED_TRUE
            added.range = [limit.lower, limit.upper]
            added.solref_limit[0] = self._hard
            # At rest the stop yields by (1 - d) / d * t^2 * effort / inertia, with the
            # impedance d and the time constant t (MuJoCo documentation, Computation).
            push = limit.effort / max(added.armature, _LEAST_INERTIA)
            if not slides and _IMPEDANCE_LEFT * self._hard**2 * push > _MOST_YIELD:
                added.solimp_limit[:2] = [_STIFF_IMPEDANCE, _STIFF_IMPEDANCE]

    def _add_motor_or_mimic(self, joint: Joint) -> None:
        if joint.type is JointType.FIXED:
            return
        if joint.mimic is not None:
            self._add_mimic(joint, joint.mimic)
            return
        if not _has_motor(joint):
            return
        motor = self._spec.add_actuator(
            name=joint.name,
            target=joint.name,
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            gaintype=mujoco.mjtGain.mjGAIN_FIXED,
            biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        )
        motor.gainprm[0] = 1.0
        if joint.limit is not None:
            motor.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
            motor.forcerange = [-joint.limit.effort, joint.limit.effort]

    def _add_mimic(self, joint: Joint, mimic: Mimic) -> None:
        equality = self._spec.add_equality(
            name=f"{joint.name}_mimic",
            type=mujoco.mjtEq.mjEQ_JOINT,
            name1=joint.name,
            name2=mimic.joint,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
        )
        equality.data[:2] = [mimic.offset, mimic.multiplier]
        equality.solref[0] = self._hard

    def _exclude_collisions(self) -> None:
        pairs = {(j.parent, j.child) for j in self._urdf.joints.values()}
        pairs.update(self._options.disabled_collisions)
        bodies = {self._body_pair(a, b) for a, b in pairs if self._has(a, b)}
        for first, second in sorted(bodies):
            if first != second:
                self._spec.add_exclude(bodyname1=first, bodyname2=second)
        if self._options.base_type == "planar":
            # The base neither falls nor slips, so the floor must not touch its wheels.
            for name in sorted(self._body_names_at_the_base()):
                self._spec.add_exclude(bodyname1="world", bodyname2=name)

    def _body_names_at_the_base(self) -> set[str]:
        """Return the bodies fixed to the base, and those one joint away from it."""
        root = self._urdf.root
        found = set()
        for link, body in self._body_of_link.items():
            above, _ = self._urdf.fixed_root(link)
            joint = self._urdf.joint_above(above)
            if joint is None or self._urdf.fixed_root(joint.parent)[0] == root:
                found.add(body)
        return found

    def _has(self, *links: str) -> bool:
        return all(link in self._body_of_link for link in links)

    def _body_pair(self, first: str, second: str) -> tuple[str, str]:
        a, b = sorted((self._body_of_link[first], self._body_of_link[second]))
        return a, b


def _has_motor(joint: Joint) -> bool:
    return joint.limit is None or joint.limit.effort != 0.0


def add_object(spec: mujoco.MjSpec, thing: SceneObject) -> None:
    """Add an object to the world; an object with a mass can be pushed.

    Args:
        spec: The world; changed.
        thing: The object.
    """
    if not thing.solid:
        return
    pose = thing.pose()
    body = spec.worldbody.add_body(
        name=thing.name, pos=[*pose.xyz], quat=pose.quaternion
    )
    geom = body.add_geom(name=thing.name)
    geom.friction[0] = thing.friction
    match thing.kind:
        case "sphere":
            geom.type = mujoco.mjtGeom.mjGEOM_SPHERE
            geom.size[0] = thing.size[0]
        case "cylinder":
            geom.type = mujoco.mjtGeom.mjGEOM_CYLINDER
            geom.size[:2] = [thing.size[0], thing.size[1] / 2.0]
        case "capsule":
            geom.type = mujoco.mjtGeom.mjGEOM_CAPSULE
            geom.size[:2] = [thing.size[0], thing.size[1] / 2.0]
        case "half_space":
            geom.type = mujoco.mjtGeom.mjGEOM_PLANE
            geom.size = [1.0, 1.0, 1.0]
        case "mesh":
            geom.type = mujoco.mjtGeom.mjGEOM_MESH
            geom.meshname = thing.name
            spec.add_mesh(name=thing.name, file=thing.file, info=thing.file)
        case _:
            geom.type = mujoco.mjtGeom.mjGEOM_BOX
            geom.size = [edge / 2.0 for edge in thing.size]
    if thing.mass > 0.0:
        geom.mass = thing.mass
        body.add_freejoint(name=thing.name)
