"""Impedance controllers of Franka arms for everyday use."""

from station.controllers.impedance_controllers.cartesian_impedance_controller import (
    CartesianImpedanceController as CartesianImpedanceController,
)
from station.controllers.impedance_controllers.joint_impedance_controller import (
    JointImpedanceController as JointImpedanceController,
)
