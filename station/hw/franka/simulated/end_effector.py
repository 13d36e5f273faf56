"""Mass properties and nominal frame of the end effector in a URDF."""

from station.core.description.urdf import Inertial, JointType, Pose, Urdf
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.mujoco.inertia import combine

_FLANGE = "link8"
_TIP = "hand_tcp"


def end_effector_of(urdf: Urdf, prefix: str, width: float) -> RigidBody:
    """Return the mass properties of all links behind the flange as one body.

    Args:
        urdf: An arm.
        prefix: Prefix of the names of the arm, e.g. `panda_`.
        width: Distance between the fingers [m]; not used without a hand.
    """
    parts: list[tuple[Pose, Inertial]] = []
    for name, pose in _links_behind(urdf, f"{prefix}{_FLANGE}", width).items():
        inertial = urdf.links[name].inertial
        if inertial is not None and inertial.mass > 0.0:
            parts.append((pose, inertial))
    if not parts:
        return RigidBody()
    whole = combine(parts)
    ixx, iyy, izz, ixy, ixz, iyz = whole.inertia
    tensor = (ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz)
    return RigidBody(whole.mass, tuple(whole.origin.xyz), tensor)


def nominal_frame_of(urdf: Urdf, prefix: str) -> tuple[float, ...]:
    """Return F_T_NE, 16 numbers: the tip of the hand, or the flange without a hand.

    Args:
        urdf: An arm.
        prefix: Prefix of the names of the arm, e.g. `panda_`.
    """
    found = _links_behind(urdf, f"{prefix}{_FLANGE}", 0.0).get(f"{prefix}{_TIP}")
    return IDENTITY if found is None else as_transform(found)


def as_transform(pose: Pose) -> tuple[float, ...]:
    """Return a pose as 16 numbers, column-major."""
    w, x, y, z = pose.quaternion
    return (
        1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y), 0.0,
        2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x), 0.0,
        2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y), 0.0,
        *pose.xyz, 1.0,
    )  # fmt: skip


def _links_behind(urdf: Urdf, link: str, width: float) -> dict[str, Pose]:
    """Return the poses, in a link's frame, of all links behind it, joints at 0."""
    found: dict[str, Pose] = {}
    frontier = [(link, Pose())] if link in urdf.links else []
    while frontier:
        name, pose = frontier.pop()
        for joint in urdf.joints_below(name):
            child = pose.compose(joint.origin)
            if joint.type is JointType.PRISMATIC:
                x, y, z = (width / 2.0 * value for value in joint.axis)
                child = child.compose(Pose((x, y, z)))
            found[joint.child] = child
            frontier.append((joint.child, child))
    return found
