"""From the parameters of FrankaHW to an arm in the simulated world."""

from station.hw.franka.arm_description import load_arm_description
from station.hw.franka.franka_parameters import FrankaParameters
from station.hw.franka.simulation import ArmPlacement


def placement_of(parameters: FrankaParameters) -> ArmPlacement:
    """Return the arm that parameters describe.

    Raises:
        RobotDescriptionError: Its URDF cannot be found, or is no Franka arm's.
    """
    return ArmPlacement(
        parameters.arm_id,
        load_arm_description(parameters.robot_description, parameters.limits),
        parameters.base,
        parameters.initial_positions,
        parameters.limits,
        parameters.thresholds,
    )
