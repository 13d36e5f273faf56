"""Make the configuration of a station for a robot from its URDF only."""

import logging
from collections.abc import Sequence

from station.core.description.robot_files import load_robot_files
from station.core.description.urdf import JointType, Urdf
from station.core.description.urdf_repair import Repair
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.bases import BaseType
from station.hw.mujoco.description_repair import log_repairs, repair_robot
from station.hw.mujoco.robot_transmissions import driven_joints
from station.hw.mujoco.ros2_control_tags import read_tagged_robot
from station.hw.robot_loader import create_robot

TYPE = "mujoco_hw/MujocoRobotHW"
TRAJECTORIES = "joint_trajectory_controller"
POSITIONS = "position_group_controller"
WHEELS = "wheel_velocity_controller"
DRIVE = "mobile_base_controller"


def configure_robot(reference: str, base: BaseType = "fixed") -> dict[str, object]:
    """Return the content of a configuration file for a robot.

    If the URDF has `<ros2_control>` elements, only the interfaces named there are
    commanded. The controllers are: a joint state controller; for all joints with a
    motor except wheels a joint trajectory controller and a position controller; a
    velocity controller for wheels; and for a planar base a controller that drives the
    base. A wheel is a joint without a range that has `wheel` in its name.

    Args:
        reference: `example-robot-data:<robot>` or the path of a URDF file.
        base: How the root link is held.

    Raises:
        RobotDescriptionError: The robot is unknown or cannot be simulated.
    """
    tagged = read_tagged_robot(load_robot_files(reference))
    urdf = repair_robot(tagged.description, base=base).urdf
    driven = driven_joints(urdf)

    def takes(name: str, quantity: str) -> bool:
        # Without <ros2_control> elements a joint accepts all commands.
        return not tagged.hardware or quantity in tagged.commands.get(name, ())

    # A wheel turns without end, so positions make no sense for it.
    wheels = [name for name in driven if is_wheel(urdf, name)]
    limbs = [n for n in driven if n not in wheels and takes(n, "position")]
    wheels = [name for name in wheels if takes(name, "velocity")]
    controllers: dict[str, dict[str, object]] = {
        "joint_state_controller": {
            "type": "joint_state_controller/JointStateController",
            "publish_rate": 50,
        }
    }
    if limbs:
        controllers[TRAJECTORIES] = {
            "type": "position_controllers/JointTrajectoryController",
            "joints": limbs,
        }
        controllers[POSITIONS] = {
            "type": "position_controllers/JointGroupPositionController",
            "joints": limbs,
        }
    sides = _sides(wheels)
    if sides is not None and base == "planar":
        controllers[DRIVE] = {
            "type": "diff_drive_controller/DiffDriveController",
            "left_wheel": sides[0],
            "right_wheel": sides[1],
        }
    if wheels:
        controllers[WHEELS] = {
            "type": "velocity_controllers/JointGroupVelocityController",
            "joints": wheels,
        }
    # Joints of <ros2_control> elements that accept no positions.
    others = [name for name in driven if name not in (*limbs, *wheels)]
    for quantity in ("velocity", "effort"):
        joints = [name for name in others if takes(name, quantity)]
        others = [name for name in others if name not in joints]
        if joints:
            kind = f"JointGroup{quantity.title()}Controller"
            controllers[f"{quantity}_group_controller"] = {
                "type": f"{quantity}_controllers/{kind}",
                "joints": joints,
            }
    return {
        "robot": {"type": TYPE, "robot_description": reference, "base": base},
        "controllers": controllers,
        "start": ["joint_state_controller", *([TRAJECTORIES] if limbs else [])],
    }


def examine_robot(reference: str, base: BaseType = "fixed") -> Sequence[Repair]:
    """Return the differences of the simulated robot from its description.

    Args:
        reference: As for `configure_robot`.
        base: How the root link is held.

    Raises:
        RobotDescriptionError: The robot is unknown or cannot be simulated.
    """
    tree = ParameterTree({"robot": {"robot_description": reference, "base": base}})
    robot = create_robot(TYPE)
    # `init` logs the repairs and this function returns them, so silence the log.
    logger = logging.getLogger(log_repairs.__module__)
    before = logger.disabled
    logger.disabled = True
    try:
        robot.init(Parameters(tree), Parameters(tree, "robot"))
    finally:
        logger.disabled = before
    return robot.repairs()


def _sides(wheels: list[str]) -> tuple[list[str], list[str]] | None:
    """Return the left and the right wheels, by name; None unless they form pairs."""
    left = [name for name in wheels if "left" in name]
    right = [name for name in wheels if "right" in name]
    # Without pairs of left and right wheels it is unknown which wheels drive.
    return (left, right) if left and len(left) == len(right) else None


def is_wheel(urdf: Urdf, name: str) -> bool:
    """Return whether a joint turns a wheel, judged by its name and type."""
    return urdf.joints[name].type is JointType.CONTINUOUS and "wheel" in name.lower()
