"""The interfaces through which controllers see an arm as a whole.

Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp, setupFrankaStateInterface,
setupFrankaModelInterface; differs: the model is `<arm_id>_robot` as well, as the public
documentation says.
"""

from station.core.franka import (
    FrankaModel,
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaStateHandle,
    FrankaStateInterface,
)
from station.hw.franka.arm.robot_arm import RobotArm


def state_interface(
    arm: RobotArm, arm_id: str, model: FrankaModel
) -> FrankaStateInterface:
    """Return the interface with the arm's whole state, `<arm_id>_robot`.

    Args:
        arm: The arm.
        arm_id: Prefix of its names.
        model: The arm's model, which may have what the state needs.
    """
    states = FrankaStateInterface()
    name = f"{arm_id}_robot"
    pose = arm.pose_source(model)
    states.register_handle(FrankaStateHandle(name, arm.state, arm.refresh_state, pose))
    return states


def model_interface(
    arm: RobotArm, arm_id: str, model: FrankaModel
) -> FrankaModelInterface:
    """Return the interface with the arm's model, `<arm_id>_model`.

    Args:
        arm: The arm.
        arm_id: Prefix of its names.
        model: The arm's model.
    """
    models = FrankaModelInterface()
    for name in (f"{arm_id}_model", f"{arm_id}_robot"):
        models.register_handle(FrankaModelHandle(name, model, arm.state))
    return models
