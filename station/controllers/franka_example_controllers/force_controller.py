"""Press on a table with the weight of a mass, by torques.

    tau_d = J^T (0, 0, -9.81 m, 0, 0, 0)
    tau = tau_d + k_p (tau_d - tau_ext) + k_i integral(tau_d - tau_ext)

where tau_ext is the measured torque without gravity, minus its value at the start.

Source: franka_ros@c11f000 franka_example_controllers, src/force_example_controller.cpp;
differs: the mass and the gains are run-time parameters, and every start begins without
force.
"""

import numpy as np
from typing_extensions import override

from station.controllers.franka_arm import (
    ArmTorqueController,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
    saturate_torque_rate,
)
from station.core.control.controller import ControllerSample
from station.core.control.tunables import Tunable, Tunables
from station.core.franka import Frame
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters

FILTER = 0.001
"""Share of the distance to a new mass or gain that is covered per cycle."""
GRAVITY = 9.81
"""Acceleration of gravity [m/s^2]."""
_SCHEMA = {
    "desired_mass": Tunable("kg", 0.0, 2.0, "mass whose weight is pressed with"),
    "k_p": Tunable("", 0.0, 2.0),
    "k_i": Tunable("1/s", 0.0, 2.0),
}


class ForceExampleController(ArmTorqueController):
    """Presses down; the end effector must touch a horizontal surface at the start.

    Parameters: `arm_id`; `joint_names`, 7 names.
    """

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, self.joint_names = read_arm_id(params), read_arm_joints(params)
        self._joints = claim_torques(hw, self.joint_names)
        self._state = find_state(hw, arm_id)
        self._model = find_model(hw, arm_id)
        self._present = dict.fromkeys(_SCHEMA, 0.0)
        self.tunables = Tunables(_SCHEMA, self._present)
        self._bias = self._integral = np.zeros(7)

    @override
    def starting(self, time: float) -> None:
        """Make the present external torques the zero, and start without force."""
        measured = self._state.get_robot_state().tau_J
        self._bias = np.subtract(measured, self._model.get_gravity())
        self._integral = np.zeros(7)
        self._present = dict.fromkeys(_SCHEMA, 0.0)

    @override
    def update(self, time: float, period: float) -> None:
        state, present = self._state.get_robot_state(), self._present
        columns = self._model.get_zero_jacobian(Frame.END_EFFECTOR)
        jacobian = np.reshape(columns, (7, 6)).T
        tau_ext = np.subtract(state.tau_J, self._model.get_gravity()) - self._bias
        tau_d = jacobian[2] * -GRAVITY * present["desired_mass"]
        error = tau_d - tau_ext
        self._integral = self._integral + period * error
        tau = tau_d + present["k_p"] * error + present["k_i"] * self._integral
        command = saturate_torque_rate(tau, state.tau_J_d)
        self._joints.set_commands(command)
        for name, value in self.tunables.values.items():
            present[name] += FILTER * (value - present[name])
        self.sample = ControllerSample(
            time, tau_d.tolist(), tau_ext.tolist(), error.tolist(), command
        )
