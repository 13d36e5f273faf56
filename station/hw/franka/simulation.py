"""Put Franka arms into one simulated world."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import pi

from station.core.errors import RobotDescriptionError
from station.hw.franka.simulated_arm import SimulatedArm
from station.hw.franka.simulated_gripper import OPEN_WIDTH, SimulatedGripper
from station.hw.mujoco.model_builder import (
    RobotOptions,
    add_robot,
    compile_world,
    new_world,
)
from station.hw.mujoco.world import World
from station.hw.robot_description import RobotDescription, replace_prefix
from station.hw.srdf import disabled_collisions
from station.hw.urdf import Pose, Urdf
from station.hw.urdf_parser import parse_urdf

INITIAL_POSITIONS = (0.0, -pi / 4, 0.0, -3 * pi / 4, 0.0, pi / 2, pi / 4)
"""Pose in which an arm starts [rad], joints 1 to 7. Source: libfranka@0.9.2
examples/generate_joint_velocity_motion.cpp, q_goal."""


@dataclass(frozen=True, slots=True)
class ArmPlacement:
    """An arm to be put into the world.

    Attributes:
        arm_id: Prefix of its names: `<arm_id>_joint1`, `<arm_id>_link0`, …
        description: Its URDF.
        base: Pose of its base in the world.
        positions: Where it starts [rad], joints 1 to 7.
    """

    arm_id: str
    description: RobotDescription
    base: Pose = field(default_factory=Pose)
    positions: tuple[float, ...] = INITIAL_POSITIONS


@dataclass(frozen=True, slots=True)
class Simulation:
    """A world and the arms in it.

    Attributes:
        world: The world.
        arms: By arm_id.
        grippers: By arm_id; arms without a hand are not in it.
    """

    world: World
    arms: Mapping[str, SimulatedArm]
    grippers: Mapping[str, SimulatedGripper]


def simulate(
    placements: Sequence[ArmPlacement], *, timestep: float = 0.001
) -> Simulation:
    """Build a world with a floor and some arms, each at its start pose and at rest.

    Args:
        placements: The arms.
        timestep: The control period [s], > 0.

    Raises:
        RobotDescriptionError: A URDF cannot be simulated or is no Franka arm.
    """
    spec = new_world(timestep)
    urdfs = {}
    for placement in placements:
        old, new = find_prefix(placement.description), f"{placement.arm_id}_"
        urdf = parse_urdf(placement.description.with_prefix(old, new))
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
    world = World(compile_world(spec))
    world.reset(_start_positions(placements, urdfs))
    arms = {p.arm_id: SimulatedArm(world, joint_names(p.arm_id)) for p in placements}
    grippers = {
        arm_id: SimulatedGripper(world, f"{arm_id}_finger_joint1")
        for arm_id, urdf in urdfs.items()
        if f"{arm_id}_finger_joint1" in urdf.joints
    }
    return Simulation(world, arms, grippers)


def joint_names(arm_id: str) -> list[str]:
    """Return the names of an arm's 7 joints, from base to flange."""
    return [f"{arm_id}_joint{number}" for number in range(1, 8)]


def find_prefix(description: RobotDescription) -> str:
    """Return what the names in the URDF of a Franka arm begin with, e.g. `panda_`.

    Raises:
        RobotDescriptionError: The URDF has no 7 joints that are named like an arm's.
    """
    joints = parse_urdf(description).joints
    for name in joints:
        prefix = name.removesuffix("joint1")
        names = [f"{prefix}joint{number}" for number in range(1, 8)]
        if all(joint in joints for joint in names):
            return prefix
    raise RobotDescriptionError(
        f"{description.urdf_path} is no Franka arm: it has no joints "
        f"<prefix>_joint1 to <prefix>_joint7",
        remedy="use example-robot-data:panda, or a URDF with such joints",
    )


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
