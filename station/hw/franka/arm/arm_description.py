"""The URDF of an arm: the names of its joints, and the values of its kind of arm.

example-robot-data has a Panda but no FR3. Both have the same kinematics, so the URDF of
an FR3 is made from the Panda's: the shapes and the hand stay, the limits of the joints
and the masses of the links change.

Source: franka_ros@c11f000 franka_description/robots, fr3/joint_limits.yaml,
common/utils.xacro; franka_description@1.0.1 robots/fr3.
"""

from dataclasses import replace
from xml.etree import ElementTree

from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.errors import RobotDescriptionError
from station.hw.franka.arm.arm_limits import ArmLimits, UrdfValues
from station.hw.urdf_loader import load_urdf

_PANDA = "panda_"
_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def joint_names(arm_id: str) -> list[str]:
    """Return the names of an arm's 7 joints, from base to flange."""
    return [f"{arm_id}_joint{number}" for number in range(1, 8)]


def find_prefix(description: RobotFiles) -> str:
    """Return the prefix of the names in a Franka arm's URDF, e.g. `panda_`.

    Raises:
        RobotDescriptionError: The URDF does not have 7 joints with the names of an arm.
    """
    joints = load_urdf(description).joints
    for name in joints:
        prefix = name.removesuffix("joint1")
        names = [f"{prefix}joint{number}" for number in range(1, 8)]
        if all(joint in joints for joint in names):
            return prefix
    raise RobotDescriptionError(
        f"{description.urdf_path} is no Franka arm: it has no joints "
        f"<prefix>_joint1 to <prefix>_joint7.",
        remedy="Use example-robot-data:panda, or a URDF with such joints.",
    )


def load_arm_description(reference: str, limits: ArmLimits) -> RobotFiles:
    """Find and read the URDF of an arm.

    If the URDF has the names of a Panda, its limits and masses are replaced by those of
    the wanted kind of arm. A URDF with other names stays as it is.

    Args:
        reference: `example-robot-data:<robot>` or the path of a URDF file.
        limits: Limits of this kind of arm.

    Raises:
        RobotDescriptionError: The URDF cannot be found or read, or is not that of a
            Franka arm.
    """
    description = load_robot_files(reference)
    prefix = find_prefix(description)
    # Other URDFs than the Panda's state the values of their own arm.
    if limits.urdf is None or prefix != _PANDA:
        return description
    return _with_values(description, limits.urdf)


def _with_values(description: RobotFiles, values: UrdfValues) -> RobotFiles:
    root = ElementTree.fromstring(description.xml)
    for i, name in enumerate(joint_names("panda")):
        lower, upper = repr(values.lower[i]), repr(values.upper[i])
        velocity = repr(values.velocity[i])
        for limit in root.iterfind(f"joint[@name='{name}']/limit"):
            limit.attrib.update(lower=lower, upper=upper, velocity=velocity)
        for soft in root.iterfind(f"joint[@name='{name}']/safety_controller"):
            soft.attrib.update(soft_lower_limit=lower, soft_upper_limit=upper)
    for number, (mass, *rest) in enumerate(values.inertials):
        inertia = dict(zip(_MOMENTS, map(repr, rest[3:]), strict=True))
        new = {
            "origin": {"xyz": " ".join(map(repr, rest[:3])), "rpy": "0 0 0"},
            "mass": {"value": repr(mass)},
            "inertia": inertia,
        }
        for inertial in root.iterfind(f"link[@name='{_PANDA}link{number}']/inertial"):
            inertial[:] = [ElementTree.Element(tag, new[tag]) for tag in new]
    return replace(description, xml=ElementTree.tostring(root, encoding="unicode"))
