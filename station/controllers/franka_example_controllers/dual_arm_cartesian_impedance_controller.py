"""Hold an object between two arms by two springs that follow one frame.

Source: franka_ros@c11f000 franka_example_controllers,
src/dual_arm_cartesian_impedance_example_controller.cpp; differs: the target of the
centering frame arrives as a set-point of 7 numbers in the base frame of the left arm,
the stiffnesses are run-time parameters, and the poses of the arms' bases are read from
the robot description.
"""

from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.franka_arm import (
    ARM_ID,
    JOINT_NAMES,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
)
from station.controllers.franka_example_controllers.base_transform import (
    base_transform,
)
from station.controllers.franka_example_controllers.cartesian_spring import (
    CartesianSpring,
)
from station.controllers.franka_example_controllers.pose_target import PoseTarget
from station.controllers.franka_example_controllers.quaternion import (
    matrix_of,
    quaternion_of,
)
from station.controllers.franka_example_controllers.spring_update import SpringUpdate
from station.core.control.controller import MultiInterfaceController
from station.core.control.tunables import Tunable, Tunables
from station.core.control.usual_update import UsualUpdate
from station.core.declared_parameter import DeclaredParameter
from station.core.description.robot_description import ROBOT_DESCRIPTION
from station.core.franka import FrankaModelInterface, FrankaStateInterface
from station.core.hardware.interfaces import EffortJointInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import timeout_parameters
from station.core.toolbox.publish_timer import PublishTimer

RATE_HZ = 30.0
"""How often the centering frame is published."""
ARMS = ("left", "right")
_STIFFNESSES = (
    ("translational", 200.0, Tunable("N/m", 0.0, 400.0)),
    ("rotational", 10.0, Tunable("Nm/rad", 0.0, 30.0)),
    ("nullspace", 0.0, Tunable("Nm/rad", 0.0, 100.0)),
)
_DEFAULTS = {
    f"{arm}_{kind}_stiffness": value for arm in ARMS for kind, value, _ in _STIFFNESSES
}
_SCHEMA = {
    f"{arm}_{kind}_stiffness": each for arm in ARMS for kind, _, each in _STIFFNESSES
}


class DualArmCartesianImpedanceExampleController(MultiInterfaceController):
    """Two springs; the right end effector keeps its pose relative to the left one.

    The centering frame is in the middle between the end effectors as they are at the
    start, with the axes of the left one.

    Parameters: `left/arm_id`, `right/arm_id`; `left/joint_names`, `right/joint_names`,
    7 names each; `command_timeout` and `command_timeout_action`, see `TimeoutAction`.
    Set-point, topic `centering_frame_target_pose` of the original:
    position [m], then quaternion w x y z, of the centering frame in
    `<left/arm_id>_link0`. When the set-point expires, the frame stays where it is then.
    """

    required_interfaces: ClassVar[tuple[type, ...]] = (
        EffortJointInterface,
        FrankaModelInterface,
        FrankaStateInterface,
    )

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (
            *super().declared_parameters(),
            *(each.inside(arm) for arm in ARMS for each in (ARM_ID, JOINT_NAMES)),
            *timeout_parameters(),
        )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        self._springs: dict[str, CartesianSpring] = {}
        self.joint_names = []
        for arm in ARMS:
            own = params.namespace(arm)
            arm_id, names = read_arm_id(own), read_arm_joints(own)
            self._springs[arm] = CartesianSpring(
                claim_torques(hw, names),
                find_state(hw, arm_id),
                find_model(hw, arm_id),
                is_angle=True,
            )
            self.joint_names += names
        left, right = (f"{ARM_ID.inside(arm).read_str(params)}_link0" for arm in ARMS)
        xml = Parameters(params.tree).get_str(ROBOT_DESCRIPTION)
        self._left_T_right = base_transform(xml, left, right)
        self._frame_id = left
        self._target = PoseTarget(params, "the centering frame", self._center)
        self.set_points = self._target.port
        self.tunables = Tunables(_SCHEMA, _DEFAULTS, apply=self._want)
        springs = [spring.driven for spring in self._springs.values()]
        self._timer = PublishTimer(RATE_HZ)
        self._usual = SpringUpdate(self._target.port, springs, self._timer)
        self._right_to_left = self._left_to_center = np.eye(4)

    @override
    def usual_update(self) -> UsualUpdate | None:
        is_copy = any(spring.is_copy for spring in self._springs.values())
        return None if is_copy else self._usual

    @override
    def starting(self, time: float) -> None:
        """Make the present poses the equilibria, at which the springs have no force."""
        for arm, spring in self._springs.items():
            spring.begin(self.tunables.values[f"{arm}_nullspace_stiffness"])
        left, right = (_matrix(self._springs[arm].pose()) for arm in ARMS)
        self._right_to_left = np.linalg.inv(self._left_T_right @ right) @ left
        back = self._right_to_left[:3, :3].T @ self._right_to_left[:3, 3]
        self._left_to_center = np.eye(4)
        self._left_to_center[:3, 3] = -0.5 * back
        self._target.begin()
        self._want(self.tunables.values)
        self._timer.start(time, at_once=True)

    @override
    def update(self, time: float, period: float) -> None:
        target = self._target.newest()
        if target is not None:
            self._set_target(*target)
        self._usual.follow(time)
        for spring in self._springs.values():
            spring.write()

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `centering_frame`, in the form of a set-point."""
        published = self._usual.published
        if published is None:
            return {}
        time, left = published
        center = _matrix(left) @ self._left_to_center
        return {
            "centering_frame": {
                "stamp": time,
                "frame_id": self._frame_id,
                "position": center[:3, 3].tolist(),
                "orientation": quaternion_of(center[:3, :3]).tolist(),
            }
        }

    def _want(self, gains: Mapping[str, float]) -> None:
        for arm, spring in self._springs.items():
            spring.want(
                gains[f"{arm}_translational_stiffness"],
                gains[f"{arm}_rotational_stiffness"],
                gains[f"{arm}_nullspace_stiffness"],
            )

    def _center(self) -> list[float]:
        """Return the equilibrium of the centering frame in the form of a set-point."""
        pose = self._springs["left"].equilibrium()
        left = np.eye(4)
        left[:3, :3], left[:3, 3] = matrix_of(np.array(pose[3:])), pose[:3]
        center = left @ self._left_to_center
        return [*center[:3, 3].tolist(), *quaternion_of(center[:3, :3]).tolist()]

    def _set_target(
        self, position: NDArray[np.float64], rotation: NDArray[np.float64]
    ) -> None:
        center = np.eye(4)
        center[:3, :3], center[:3, 3] = matrix_of(rotation), position
        left = center @ np.linalg.inv(self._left_to_center)
        right = np.linalg.inv(self._left_T_right) @ left
        right = right @ np.linalg.inv(self._right_to_left)
        for arm, pose in zip(ARMS, (left, right), strict=True):
            self._springs[arm].set_target(pose[:3, 3], quaternion_of(pose[:3, :3]))


def _matrix(pose: list[float]) -> NDArray[np.float64]:
    """Return a pose of 16 numbers, column-major, as a matrix, shape (4, 4)."""
    return np.reshape(pose, (4, 4)).T
