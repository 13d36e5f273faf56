"""From the parameters of FrankaHW to an arm in the simulated world."""

from station.hw.franka.franka_parameters import FrankaParameters
from station.hw.franka.simulation import ArmPlacement
from station.hw.robot_description import load_robot_description


def placement_of(parameters: FrankaParameters) -> ArmPlacement:
    """Return the arm that parameters describe.

    Raises:
        RobotDescriptionError: Its URDF cannot be found.
    """
    return ArmPlacement(
        parameters.arm_id,
        load_robot_description(parameters.robot_description),
        parameters.base,
        parameters.initial_positions,
        parameters.limits,
        parameters.thresholds,
    )
