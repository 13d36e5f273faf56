"""Build a simulated world with one robot that has a URDF."""

from collections.abc import Mapping, Sequence

from station.core.description.robot_files import RobotFiles
from station.core.description.srdf import disabled_collisions
from station.core.description.urdf import Joint, JointType, Urdf
from station.core.errors import ParameterError, RobotDescriptionError
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.mujoco.mujoco_robot_parameters import MujocoRobotParameters
from station.hw.mujoco.scene import SceneObject, add_object
from station.hw.mujoco.sensors import add_sensors
from station.hw.mujoco.world import World


def simulate_robot(
    description: RobotFiles,
    urdf: Urdf,
    parameters: MujocoRobotParameters,
    objects: Sequence[SceneObject] = (),
) -> World:
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
    spec = new_world(parameters.timestep, floor=parameters.has_floor)
    options = RobotOptions(
        base=parameters.base,
        armature=parameters.armature,
        slide_armature=parameters.armature,
        gravity_compensation=parameters.gravity_compensation,
        disabled_collisions=disabled_collisions(description.srdf_path),
    )
    try:
        add_robot(spec, urdf, options)
        add_sensors(spec, parameters.sensors)
        for one in objects:
            add_object(spec, one)
        model = compile_world(spec)
    except RobotDescriptionError as exc:
        raise RobotDescriptionError(
            f"{description.urdf_path}: {exc.message}", remedy=exc.remedy
        ) from exc
    world = World(model, objects)
    world.begin_at(_start_positions(urdf, parameters.initial_positions))
    return world


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
        ParameterError: The configured position is outside of the joint's range.
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
