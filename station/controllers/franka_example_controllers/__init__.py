"""The example controllers of franka_ros: how each interface of an arm is used."""

from station.controllers.franka_example_controllers.cartesian_impedance_controller import (  # noqa: E501 - the module's name
    CartesianImpedanceExampleController,
)
from station.controllers.franka_example_controllers.cartesian_pose_controller import (
    CartesianPoseExampleController,
)
from station.controllers.franka_example_controllers.cartesian_velocity_controller import (  # noqa: E501 - the module's name
    CartesianVelocityExampleController,
)
from station.controllers.franka_example_controllers.dual_arm_cartesian_impedance_controller import (  # noqa: E501 - the module's name
    DualArmCartesianImpedanceExampleController,
)
from station.controllers.franka_example_controllers.elbow_controller import (
    ElbowExampleController,
)
from station.controllers.franka_example_controllers.force_controller import (
    ForceExampleController,
)
from station.controllers.franka_example_controllers.joint_impedance_controller import (
    JointImpedanceExampleController,
)
from station.controllers.franka_example_controllers.joint_position_controller import (
    JointPositionExampleController,
)
from station.controllers.franka_example_controllers.joint_velocity_controller import (
    JointVelocityExampleController,
)
from station.controllers.franka_example_controllers.model_controller import (
    ModelExampleController,
)
from station.controllers.franka_example_controllers.teleop_joint_pd_controller import (
    TeleopJointPDExampleController,
)

__all__ = [
    "CartesianImpedanceExampleController",
    "CartesianPoseExampleController",
    "CartesianVelocityExampleController",
    "DualArmCartesianImpedanceExampleController",
    "ElbowExampleController",
    "ForceExampleController",
    "JointImpedanceExampleController",
    "JointPositionExampleController",
    "JointVelocityExampleController",
    "ModelExampleController",
    "TeleopJointPDExampleController",
]
