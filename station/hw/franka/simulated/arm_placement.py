"""Build a simulated arm and its world from the parameters of FrankaHW."""

from dataclasses import replace

from station.core.parameters import Parameters
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.franka_parameters import FrankaParameters
from station.hw.franka.simulated.franka_world import ArmPlacement, FrankaWorld, simulate
from station.hw.franka.simulated.realism import TYPICAL, Realism
from station.hw.mujoco.scene import read_scene


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
    return replace(TYPICAL, seed=parameters.realism_seed)


def simulate_one(parameters: FrankaParameters, root_params: Parameters) -> FrankaWorld:
    """Return a world with the arm that the parameters describe, and with its scene.

    Args:
        parameters: The arm.
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
