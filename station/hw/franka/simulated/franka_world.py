"""Put Franka arms into one simulated world."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import mujoco

from station.core.description.robot_files import RobotFiles, replace_prefix
from station.core.description.srdf import disabled_collisions, group_states
from station.core.description.urdf import Pose, Urdf
from station.core.franka.franka_model import GRAVITY_EARTH
from station.core.geometry.scene import SceneObject, read_scene
from station.core.parameters import Parameters
from station.hw.franka.arm.arm_description import (
    find_prefix,
    joint_names,
    load_arm_description,
)
from station.hw.franka.arm.arm_limits import PANDA_LIMITS, ArmLimits, SupervisorLimits
from station.hw.franka.arm.service_limits import ServiceLimits
from station.hw.franka.franka_parameters import INITIAL_POSITIONS, FrankaParameters
from station.hw.franka.hand.hand_limits import OPEN_WIDTH
from station.hw.franka.simulated.arm_parts import ArmParts
from station.hw.franka.simulated.end_effector import (
    as_transform,
    end_effector_of,
    nominal_frame_of,
)
from station.hw.franka.simulated.realism import TYPICAL, Realism
from station.hw.franka.simulated.simulated_arm import SimulatedArm
from station.hw.franka.simulated.simulated_gripper import SimulatedGripper
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_object,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.mujoco.shared_world import SharedWorld
from station.hw.mujoco.world import World
from station.hw.urdf_loader import load_urdf

_HARD_CONSTRAINT_STEPS = 2.0
_HARD_IMPEDANCE = 0.99
_RIGID_IMPEDANCE = 0.999
"""Time constant, in time steps, and impedances of the fingers' contacts and of their
coupling. With MuJoCo's defaults, fingers that press with 20 N sink 3.5 mm into an
object and the object slips out; with 0.999 the contacts chatter."""
_FINGERS_WEIGHT = 1e6
"""Weight of the finger in a contact, so that only the finger decides how stiff the
contact is. The friction depends on both bodies."""

WORLD_LINK = "world"
"""The root link of the URDF of several arms."""
STOP_DISTANCE = 0.005
"""Distance of the mechanical stops from the position limits [rad]; not published."""


@dataclass(frozen=True, slots=True)
class ArmPlacement:
    """An arm to be put into the world.

    Attributes:
        arm_id: Name of the arm, which begins its names: `<arm_id>_joint1`, …
        description: The URDF of the arm.
        base: Pose of the base in the world.
        positions: Positions of joints 1 to 7 at the start [rad].
        limits: Limits of this kind of arm.
        thresholds: Thresholds that Franka does not publish.
        service_limits: The largest pushes.
        realism: Disturbances of the arm; None for an ideal arm.
    """

    arm_id: str
    description: RobotFiles
    base: Pose = field(default_factory=Pose)
    positions: tuple[float, ...] = INITIAL_POSITIONS
    limits: ArmLimits = PANDA_LIMITS
    thresholds: SupervisorLimits = field(default_factory=SupervisorLimits)
    service_limits: ServiceLimits = field(default_factory=ServiceLimits)
    realism: Realism | None = None


class FrankaWorld(SharedWorld):
    """A MuJoCo world and the Franka arms in it.

    Args:
        world: The MuJoCo world.
        arms: Arms by arm_id.
        grippers: Hands by arm_id, without entries for arms without a hand.
        keyframes: The named poses: joint name to position [rad or m].

    Attributes:
        arms: As given.
        grippers: As given.
    """

    def __init__(
        self,
        world: World,
        arms: Mapping[str, SimulatedArm],
        grippers: Mapping[str, SimulatedGripper],
        keyframes: Mapping[str, Mapping[str, float]] | None = None,
    ) -> None:
        super().__init__(world, keyframes)
        self.arms = arms
        self.grippers = grippers


def simulate(
    placements: Sequence[ArmPlacement],
    *,
    timestep: float = 0.001,
    gravity: tuple[float, float, float] = GRAVITY_EARTH,
    objects: Sequence[SceneObject] = (),
) -> FrankaWorld:
    """Build a world with a floor and some arms, each at its start pose and at rest.

    Args:
        placements: The arms.
        timestep: The control period [s], > 0.
        gravity: Acceleration of gravity in the axes of the world [m/s^2].
        objects: The other objects in the world.

    Raises:
        RobotDescriptionError: A URDF cannot be simulated, or describes no Franka arm.
    """
    spec = new_world(timestep)
    spec.option.gravity = gravity
    urdfs = {}
    limits: dict[str, float] = {}
    for placement in placements:
        old, new = find_prefix(placement.description), f"{placement.arm_id}_"
        urdf = _stopped_at(
            placement.limits,
            load_urdf(placement.description.with_prefix(old, new)),
            new,
        )
        pairs = [
            (replace_prefix(first, old, new), replace_prefix(second, old, new))
            for first, second in disabled_collisions(placement.description.srdf_path)
        ]
        add_robot(
            spec,
            urdf,
            RobotOptions(base=placement.base, disabled_collisions=tuple(pairs)),
        )
        urdfs[placement.arm_id] = urdf
        for name in joint_names(placement.arm_id):
            # The stops are beyond the limits, so that the arm finds the violation
            # before the impact.
            low, high = spec.joint(name).range
            spec.joint(name).range = [low - STOP_DISTANCE, high + STOP_DISTANCE]
        limits |= _velocity_limits(placement, urdf)
        _harden_fingers(spec, placement.arm_id)
    for one in objects:
        add_object(spec, one)
    world = World(compile_world(spec), objects)
    world.limit_velocities(limits)
    world.begin_at(_start_positions(placements, urdfs))
    arms = {p.arm_id: _make_arm(world, p, urdfs[p.arm_id], gravity) for p in placements}
    grippers = {
        arm_id: SimulatedGripper(world, f"{arm_id}_finger_joint1")
        for arm_id, urdf in urdfs.items()
        if f"{arm_id}_finger_joint1" in urdf.joints
    }
    return FrankaWorld(world, arms, grippers, _keyframes(placements, urdfs))


def placement_of(parameters: FrankaParameters) -> ArmPlacement:
    """Return the placement of the arm that the parameters describe.

    Raises:
        RobotDescriptionError: The URDF is missing or does not describe a Franka arm.
    """
    return ArmPlacement(
        parameters.arm_id,
        load_arm_description(parameters.robot_description, parameters.limits),
        parameters.base,
        parameters.initial_positions,
        parameters.limits,
        parameters.thresholds,
        parameters.service_limits,
        _realism_of(parameters),
    )


def _realism_of(parameters: FrankaParameters) -> Realism | None:
    if not parameters.is_realistic:
        return None
    arm = replace(TYPICAL, seed=parameters.realism_seed)
    for i, name in enumerate(parameters.joint_names):
        if name in parameters.identified:
            arm = arm.with_friction(i, *parameters.identified[name])
    return arm


def simulate_one(parameters: FrankaParameters, root_params: Parameters) -> FrankaWorld:
    """Return a world with the arm that the parameters describe, and with its scene.

    Args:
        parameters: Parameters of the arm.
        root_params: Parameters of the station's root namespace, with its `scene`.

    Raises:
        ParameterError: The scene is malformed.
        RobotDescriptionError: The URDF is missing or does not describe a Franka arm.
    """
    world = simulate(
        [placement_of(parameters)],
        gravity=parameters.gravity,
        objects=read_scene(root_params),
    )
    arm = world.arms[parameters.arm_id]
    arm.set_collision_behavior(parameters.collision_behavior)
    return world


def _make_arm(
    world: World,
    placement: ArmPlacement,
    urdf: Urdf,
    gravity: tuple[float, float, float],
) -> SimulatedArm:
    prefix = f"{placement.arm_id}_"
    # The axes of the base are the columns of its rotation.
    base = as_transform(placement.base)
    local = [
        sum(base[column + row] * gravity[row] for row in range(3))
        for column in (0, 4, 8)
    ]
    hand = f"{prefix}hand"
    parts = ArmParts(
        world,
        joint_names(placement.arm_id),
        limits=placement.limits,
        thresholds=placement.thresholds,
        hand=hand if hand in urdf.links else f"{prefix}link7",
        gravity=local,
        realism=placement.realism,
    )
    arm = SimulatedArm(world, parts, placement.description, placement.service_limits)
    arm.frames.set_end_effector(
        end_effector_of(urdf, prefix, OPEN_WIDTH), nominal_frame_of(urdf, prefix)
    )
    # After the frames, because the observer uses the Jacobian of the stiffness frame.
    arm.contact.renew()
    return arm


def _stopped_at(limits: ArmLimits, urdf: Urdf, prefix: str) -> Urdf:
    """Return the URDF with the arm's own position limits."""
    joints = dict(urdf.joints)
    for number, (lower, upper) in enumerate(
        zip(limits.lower, limits.upper, strict=True), start=1
    ):
        joint = joints[f"{prefix}joint{number}"]
        if joint.limit is not None:
            stops = replace(joint.limit, lower=lower, upper=upper)
            joints[joint.name] = replace(joint, limit=stops)
    return replace(urdf, joints=joints)


def _harden_fingers(spec: mujoco.MjSpec, arm_id: str) -> None:
    time_constant = _HARD_CONSTRAINT_STEPS * spec.option.timestep
    for finger in (f"{arm_id}_leftfinger", f"{arm_id}_rightfinger"):
        body = spec.body(finger)
        for geom in [] if body is None else body.geoms:
            geom.solref[0] = time_constant
            geom.solimp[:2] = _HARD_IMPEDANCE
            geom.solmix = _FINGERS_WEIGHT
    coupling = spec.equality(f"{arm_id}_finger_joint2_mimic")
    if coupling is not None:
        coupling.solimp[:2] = _RIGID_IMPEDANCE


def _velocity_limits(placement: ArmPlacement, urdf: Urdf) -> dict[str, float]:
    names = joint_names(placement.arm_id)
    limits = dict(zip(names, placement.limits.velocity, strict=True))
    for number in (1, 2):
        finger = urdf.joints.get(f"{placement.arm_id}_finger_joint{number}")
        if finger is not None and finger.limit is not None:
            limits[finger.name] = finger.limit.velocity
    return limits


def _keyframes(
    placements: Sequence[ArmPlacement], urdfs: Mapping[str, Urdf]
) -> dict[str, dict[str, float]]:
    """Return the named poses; a pose of one name has the positions of all arms."""
    found: dict[str, dict[str, float]] = {"ready": {}}
    for placement in placements:
        arm_id = placement.arm_id
        found["ready"].update(zip(joint_names(arm_id), INITIAL_POSITIONS, strict=True))
        old, joints = find_prefix(placement.description), urdfs[arm_id].joints
        for name, state in group_states(placement.description.srdf_path).items():
            pose = {replace_prefix(j, old, f"{arm_id}_"): p for j, p in state.items()}
            for joint in joints.values():  # the other finger
                if joint.mimic is not None and joint.mimic.joint in pose:
                    pose[joint.name] = pose[joint.mimic.joint]
            known = {joint: p for joint, p in pose.items() if joint in joints}
            found.setdefault(name, {}).update(known)
    return found


def _start_positions(
    placements: Sequence[ArmPlacement], urdfs: Mapping[str, Urdf]
) -> dict[str, float]:
    positions: dict[str, float] = {}
    for placement in placements:
        names = joint_names(placement.arm_id)
        positions.update(zip(names, placement.positions, strict=True))
        for finger in (1, 2):
            name = f"{placement.arm_id}_finger_joint{finger}"
            if name in urdfs[placement.arm_id].joints:
                positions[name] = OPEN_WIDTH / 2.0
    return positions


def combine_descriptions(placements: Sequence[ArmPlacement]) -> str:
    """Return one URDF with all arms at their places.

    Args:
        placements: The arms.

    Raises:
        RobotDescriptionError: A placement does not describe a Franka arm.
    """
    combined = ET.Element("robot", name="combined")
    ET.SubElement(combined, "link", name=WORLD_LINK)
    materials: set[str] = set()
    for placement in placements:
        prefix = f"{placement.arm_id}_"
        original = placement.description
        description = original.with_prefix(find_prefix(original), prefix)
        for element in ET.fromstring(description.xml):
            name = element.get("name", "")
            if element.tag == "material":
                # Arms of the same kind have the same materials, and a URDF may define
                # each name only once.
                if name in materials:
                    continue
                materials.add(name)
            combined.append(element)
        _stand(combined, placement, load_urdf(description).root)
    return ET.tostring(combined, encoding="unicode")


def _stand(combined: ET.Element, placement: ArmPlacement, root: str) -> None:
    name = f"{placement.arm_id}_{WORLD_LINK}_joint"
    joint = ET.SubElement(combined, "joint", name=name, type="fixed")
    ET.SubElement(joint, "parent", link=WORLD_LINK)
    ET.SubElement(joint, "child", link=root)
    roll, pitch, yaw = placement.base.rpy()
    ET.SubElement(
        joint,
        "origin",
        xyz=" ".join(repr(value) for value in placement.base.xyz),
        rpy=f"{roll!r} {pitch!r} {yaw!r}",
    )
