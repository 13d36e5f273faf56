"""Hold the end effector like a spring, by torques.

Source: franka_ros@c11f000 franka_example_controllers,
src/cartesian_impedance_example_controller.cpp; differs: the equilibrium pose arrives as
a set-point of 7 numbers that may expire, and the stiffnesses are run-time parameters.
"""

from collections.abc import Mapping

from typing_extensions import override

from station.controllers.franka_arm import (
    ArmTorqueController,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
)
from station.controllers.franka_arm.cartesian_spring import (
    CartesianSpring,
)
from station.controllers.franka_arm.pose_target import PoseTarget
from station.core.control.tunables import Tunable, Tunables
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import timeout_parameters

_DEFAULTS = {
    "translational_stiffness": 200.0,
    "rotational_stiffness": 10.0,
    "nullspace_stiffness": 0.5,
}
_SCHEMA = {
    "translational_stiffness": Tunable("N/m", 0.0, 400.0),
    "rotational_stiffness": Tunable("Nm/rad", 0.0, 30.0),
    "nullspace_stiffness": Tunable("Nm/rad", 0.0, 100.0),
}


class CartesianImpedanceExampleController(ArmTorqueController):
    """A spring between the end effector and an equilibrium pose.

    Parameters: `arm_id`; `joint_names`, 7 names; `command_timeout` and
    `command_timeout_action`, see `TimeoutAction`. Set-point, topic `equilibrium_pose`
    of the original: position [m], then quaternion w x y z, of the end effector in the
    base frame. When the set-point expires, the equilibrium stays where it is then.
    """

    own_parameters = timeout_parameters()

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, names = read_arm_id(params), read_arm_joints(params)
        self._spring = CartesianSpring(
            claim_torques(hw, names),
            find_state(hw, arm_id),
            find_model(hw, arm_id),
            is_angle=False,
        )
        self.joint_names = names
        self._target = PoseTarget(params, arm_id, self._spring.equilibrium)
        self.set_points = self._target.port
        self.tunables = Tunables(_SCHEMA, _DEFAULTS, apply=self._set_stiffness)
        self._update = self._target.follow(self._spring)

    @override
    def starting(self, time: float) -> None:
        """Make the present pose the equilibrium, at which the spring has no force."""
        gains = self.tunables.values
        self._spring.start_at_rest(gains["nullspace_stiffness"])
        self._set_stiffness(gains)
        self._target.start_at_rest()

    @override
    def update(self, time: float, period: float) -> None:
        self._update.command_springs(time)

    def _set_stiffness(self, gains: Mapping[str, float]) -> None:
        self._spring.set_stiffness(
            gains["translational_stiffness"],
            gains["rotational_stiffness"],
            gains["nullspace_stiffness"],
        )
