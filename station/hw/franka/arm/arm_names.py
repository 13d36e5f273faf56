"""Names of an arm's joints, and how to find them in a URDF."""

from station.core.description.robot_files import RobotFiles
from station.core.errors import RobotDescriptionError
from station.hw.urdf_loader import load_urdf


def joint_names(arm_id: str) -> list[str]:
    """Return the names of an arm's 7 joints, from base to flange."""
    return [f"{arm_id}_joint{number}" for number in range(1, 8)]


def find_prefix(description: RobotFiles) -> str:
    """Return what the names in the URDF of a Franka arm begin with, e.g. `panda_`.

    Raises:
        RobotDescriptionError: The URDF has no 7 joints that are named like an arm's.
    """
    joints = load_urdf(description).joints
    for name in joints:
        prefix = name.removesuffix("joint1")
        names = [f"{prefix}joint{number}" for number in range(1, 8)]
        if all(joint in joints for joint in names):
            return prefix
    raise RobotDescriptionError(
        f"{description.urdf_path} is no Franka arm: it has no joints "
        f"<prefix>_joint1 to <prefix>_joint7.",
        remedy="Use example-robot-data:panda, or a URDF with such joints.",
    )
