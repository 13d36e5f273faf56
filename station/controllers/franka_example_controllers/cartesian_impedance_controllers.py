"""Hold an end effector like a spring, or an object between two arms by two springs.

Source: franka_ros@c11f000 franka_example_controllers,
src/cartesian_impedance_example_controller.cpp and
src/dual_arm_cartesian_impedance_example_controller.cpp; differs: the equilibrium pose,
or the target of the centering frame in the base frame of the left arm, arrives as a
set-point of 7 numbers that may expire; the stiffnesses are run-time parameters; and the
poses of the two arms' bases are read from the robot description.
"""

from collections.abc import Mapping
from math import sqrt
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from station.controllers.franka_arm import (
    ARM_ID,
    JOINT_NAMES,
    ArmTorqueController,
    claim_torques,
    find_model,
    find_state,
    read_arm_id,
    read_arm_joints,
)
from station.controllers.franka_arm.cartesian_spring import (
    CartesianSpring,
    SpringUpdate,
)
from station.controllers.franka_arm.pose_target import PoseTarget
from station.core.control.controller import MultiInterfaceController
from station.core.control.tunables import Tunable, Tunables
from station.core.description.robot_description import ROBOT_DESCRIPTION
from station.core.description.urdf import Pose, Urdf
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError
from station.core.franka import FrankaModelInterface, FrankaStateInterface
from station.core.hardware.interfaces import EffortJointInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.numerics.poses import pose_of
from station.core.parameters import Parameters
from station.core.ports.set_point import timeout_parameters
from station.core.toolbox.publish_timer import PublishTimer

_ONE_ARM_DEFAULTS = {
    "translational_stiffness": 200.0,
    "rotational_stiffness": 10.0,
    "nullspace_stiffness": 0.5,
}
_ONE_ARM_SCHEMA = {
    "translational_stiffness": Tunable("N/m", 0.0, 400.0),
    "rotational_stiffness": Tunable("Nm/rad", 0.0, 30.0),
    "nullspace_stiffness": Tunable("Nm/rad", 0.0, 100.0),
}
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
        self.tunables = Tunables(
            _ONE_ARM_SCHEMA, _ONE_ARM_DEFAULTS, apply=self._set_stiffness
        )
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
    own_parameters = (
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
        self.tunables = Tunables(_SCHEMA, _DEFAULTS, apply=self._set_stiffness)
        self._timer = PublishTimer(RATE_HZ)
        self._update = SpringUpdate(
            self._target.port, self._retarget, [*self._springs.values()], self._timer
        )
        self._right_to_left = self._left_to_center = np.eye(4)

    @override
    def starting(self, time: float) -> None:
        """Make the present poses the equilibria, at which the springs have no force."""
        for arm, spring in self._springs.items():
            spring.start_at_rest(self.tunables.values[f"{arm}_nullspace_stiffness"])
        left, right = (_matrix(self._springs[arm].pose()) for arm in ARMS)
        self._right_to_left = np.linalg.inv(self._left_T_right @ right) @ left
        back = self._right_to_left[:3, :3].T @ self._right_to_left[:3, 3]
        self._left_to_center = np.eye(4)
        self._left_to_center[:3, 3] = -0.5 * back
        self._target.start_at_rest()
        self._set_stiffness(self.tunables.values)
        self._timer.start(time, at_once=True)

    @override
    def update(self, time: float, period: float) -> None:
        self._update.command_springs(time)

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `centering_frame`, in the form of a set-point."""
        published = self._update.published
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

    def _set_stiffness(self, gains: Mapping[str, float]) -> None:
        for arm, spring in self._springs.items():
            spring.set_stiffness(
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

    def _retarget(self) -> None:
        target = self._target.newest()
        if target is None:
            return
        position, rotation = target
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


def base_transform(xml: str, link: str, other: str) -> NDArray[np.float64]:
    """Return the pose of the link `other` in the frame of `link`, shape (4, 4).

    Args:
        xml: The URDF.
        link: Name of the link in whose frame the pose is expressed.
        other: Name of the link whose pose is returned.

    Raises:
        RobotDescriptionError: The URDF is wrong, a link is missing, or one link moves
            relative to the other.
    """
    urdf = parse_urdf(xml)
    root_of_first, first = _fixed_root(urdf, link)
    root_of_second, second = _fixed_root(urdf, other)
    if root_of_first != root_of_second:
        raise RobotDescriptionError(
            f"Links '{link}' and '{other}' are not fixed to the same link: the first "
            f"is fixed to '{root_of_first}', the second to '{root_of_second}'.",
            remedy="Connect them by fixed joints in the robot description.",
            details={"links": [link, other]},
        )
    result: NDArray[np.float64] = np.linalg.inv(
        _matrix_of_origin(first)
    ) @ _matrix_of_origin(second)
    return result


def _fixed_root(urdf: Urdf, link: str) -> tuple[str, Pose]:
    if link not in urdf.links:
        raise RobotDescriptionError(
            f"The robot description has no link '{link}'.",
            remedy="Name links of the description, or describe all arms in it.",
            details={"link": link},
        )
    return urdf.fixed_root(link)


def _matrix_of_origin(pose: Pose) -> NDArray[np.float64]:
    w, x, y, z = pose.quaternion
    return np.array(pose_of(pose.xyz, (x, y, z, w))).reshape(4, 4).T


def quaternion_of(R: NDArray[np.float64]) -> NDArray[np.float64]:  # noqa: N803
    """Return the quaternion of a rotation matrix, shape (3, 3)."""
    # The largest of the four parts is at least 0.5, so that dividing by it is safe.
    squares = np.array([
        1.0 + R[0, 0] + R[1, 1] + R[2, 2],
        1.0 + R[0, 0] - R[1, 1] - R[2, 2],
        1.0 - R[0, 0] + R[1, 1] - R[2, 2],
        1.0 - R[0, 0] - R[1, 1] + R[2, 2],
    ])
    largest = int(np.argmax(squares))
    products = np.array([
        [squares[0], R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]],
        [R[2, 1] - R[1, 2], squares[1], R[1, 0] + R[0, 1], R[0, 2] + R[2, 0]],
        [R[0, 2] - R[2, 0], R[1, 0] + R[0, 1], squares[2], R[2, 1] + R[1, 2]],
        [R[1, 0] - R[0, 1], R[0, 2] + R[2, 0], R[2, 1] + R[1, 2], squares[3]],
    ])
    result: NDArray[np.float64] = products[largest] / (2.0 * sqrt(squares[largest]))
    return result


def matrix_of(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation matrix of a unit quaternion, shape (3, 3)."""
    w, v = q[0], q[1:]
    skew = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    result: NDArray[np.float64] = np.eye(3) + 2.0 * w * skew + 2.0 * skew @ skew
    return result
