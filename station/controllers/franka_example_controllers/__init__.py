"""The example controllers of franka_ros: how each interface of an arm is used."""

from station.controllers.franka_example_controllers.cartesian_impedance_controllers import (  # noqa: E501 - the module's name
    CartesianImpedanceExampleController as CartesianImpedanceExampleController,
    DualArmCartesianImpedanceExampleController as DualArmCartesianImpedanceExampleController,  # noqa: E501
)
from station.controllers.franka_example_controllers.example_motions import (
    CartesianPoseExampleController as CartesianPoseExampleController,
    CartesianVelocityExampleController as CartesianVelocityExampleController,
    ElbowExampleController as ElbowExampleController,
    JointPositionExampleController as JointPositionExampleController,
    JointVelocityExampleController as JointVelocityExampleController,
)
from station.controllers.franka_example_controllers.example_torques import (
    ForceExampleController as ForceExampleController,
    JointImpedanceExampleController as JointImpedanceExampleController,
    ModelExampleController as ModelExampleController,
)
from station.controllers.franka_example_controllers.teleop_joint_pd_controller import (
    TeleopJointPDExampleController as TeleopJointPDExampleController,
)
