"""What the layers of the 3D view draw, as frozen data."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from station.core.description.urdf import Pose
from station.ui.joint_frames import is_drawn_moving, link_path, link_poses
from station.ui.operate_model import POSITION_UNITS, is_of_joints
from station.ui.robot_model import RobotModel
from station.ui.station_view import Limits, StationView
from station.wire import Contact

Vector = tuple[float, float, float]
_IDENTITY = (*(1.0, 0.0, 0.0, 0.0, 0.0) * 3, 1.0)


@dataclass(frozen=True, slots=True)
class PlacedRobot:
    """A robot in the scene.

    Attributes:
        model: The robot.
        root: Its scene node.
    """

    model: RobotModel
    root: str

    def node_of(self, link: str) -> str:
        """Return the scene node of a link."""
        return link_path(self.model.urdf, link, self.root)

    @property
    def base(self) -> str:
        """The link that carries the first joint, whose frame a Franka calls O."""
        urdf = self.model.urdf
        link = self.model.root
        while below := urdf.joints_below(link):
            if is_drawn_moving(below[0]):
                break
            link = below[0].child
        return link

    @property
    def flange(self) -> str:
        """The link that carries the tool: a Panda's flange, or a robot's last link."""
        links = self.model.urdf.links
        own = f"{self.model.arm_id}_link8"
        if own in links:
            return own
        return max(links, key=lambda link: self.node_of(link).count("/"))

    def poses(self, positions: Mapping[str, float]) -> dict[str, Pose]:
        """Return the pose of every link in the world."""
        return link_poses(self.model.urdf, positions)


@dataclass(frozen=True, slots=True)
class ArmFacts:
    """What a Franka arm says of its tool.

    Attributes:
        flange_to_tool: Pose of EE in the flange frame.
        tool_to_stiffness: Pose of K in EE.
        force: Force on the robot at K, in the axes of its base [N]; None where the
            arm cannot tell.
    """

    flange_to_tool: Pose
    tool_to_stiffness: Pose
    force: Vector | None


@dataclass(frozen=True, slots=True)
class SceneFacts:
    """The newest of everything that a layer may draw.

    Attributes:
        positions: Measured joint positions by name [rad] or [m].
        commanded: Positions that running controllers want their joints to have.
        limits: Lowest and highest position by joint.
        arms: What the Franka arms say, by arm_id.
        contacts: Where bodies of a simulated world touch.
        trails: Where the flange of each robot was, oldest first [m], world.
    """

    positions: Mapping[str, float] = field(default_factory=dict)
    commanded: Mapping[str, float] = field(default_factory=dict)
    limits: Limits = field(default_factory=dict)
    arms: Mapping[str, ArmFacts] = field(default_factory=dict)
    contacts: Sequence[Contact] = ()
    trails: Sequence[Sequence[Vector]] = ()


def commanded_positions(view: StationView) -> dict[str, float]:
    """Return the positions that running controllers want their joints to have.

    Args:
        view: What is known of the station; with the samples of those controllers.
    """
    wanted: dict[str, float] = {}
    for name in commanding(view):
        sample = view.samples.get(name)
        if sample is None or len(sample.desired) != len(sample.name):
            continue
        values = zip(sample.name, sample.desired, strict=True)
        wanted |= {joint: value for joint, value in values if value is not None}
    return wanted


def commanding(view: StationView) -> set[str]:
    """Return the running controllers that want positions of joints."""
    found = set()
    for controller in view.controllers:
        elements = view.elements.get(controller.name, ())
        if controller.state != "running":
            continue
        takes_positions = is_of_joints(elements) and all(
            element.unit in POSITION_UNITS for element in elements
        )
        if takes_positions or controller.type.endswith("JointTrajectoryController"):
            found.add(controller.name)
    return found


ARM_FIELDS = ("F_T_EE", "EE_T_K", "O_F_ext_hat_K")
"""What of an arm's state `arm_facts` reads."""


def arm_facts(state: Mapping[str, object]) -> ArmFacts:
    """Return what the scene shows of an arm's state.

    Args:
        state: The fields of `FrankaState` that `ARM_FIELDS` names.
    """
    wrench = _numbers(state, "O_F_ext_hat_K", 6)
    # The arm tells the wrench that it exerts; what acts on it is the opposite.
    force = None if wrench is None else (-wrench[0], -wrench[1], -wrench[2])
    return ArmFacts(
        pose_of(_numbers(state, "F_T_EE", 16) or _IDENTITY),
        pose_of(_numbers(state, "EE_T_K", 16) or _IDENTITY),
        force,
    )


def _numbers(
    state: Mapping[str, object], name: str, count: int
) -> tuple[float, ...] | None:
    """Return an array of a state; None where it is missing or not finite."""
    values = state.get(name)
    if not isinstance(values, Sequence) or len(values) != count:
        return None
    numbers = tuple(value for value in values if isinstance(value, (int, float)))
    return numbers if len(numbers) == count else None


def pose_of(matrix: Sequence[float]) -> Pose:
    """Return the pose of a homogeneous matrix in column-major order, shape (16,).

    The quaternion comes from the trace or, where that is small, from the largest
    element of the diagonal (Shepperd's method), so that no division loses digits.
    """
    m = matrix
    xx, yx, zx, xy, yy, zy, xz, yz, zz = (*m[0:3], *m[4:7], *m[8:11])
    squares = (1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz)
    largest = max(range(4), key=squares.__getitem__)
    four = 2.0 * math.sqrt(max(squares[largest], 1e-12))
    rows = (
        (four * four / 4, zy - yz, xz - zx, yx - xy),
        (zy - yz, four * four / 4, xy + yx, xz + zx),
        (xz - zx, xy + yx, four * four / 4, yz + zy),
        (yx - xy, xz + zx, yz + zy, four * four / 4),
    )
    w, x, y, z = (part / four for part in rows[largest])
    return Pose((m[12], m[13], m[14]), (w, x, y, z))
