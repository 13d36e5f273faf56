"""Read the URDF of a robot that is to be simulated."""

from functools import lru_cache

from station.core.description.robot_files import RobotFiles
from station.core.description.urdf import Joint, JointType, Urdf
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError
from station.core.hardware.limits import JointLimitsError, soft_joint_limits_from_urdf

_SIMULATED = (
    JointType.REVOLUTE,
    JointType.CONTINUOUS,
    JointType.PRISMATIC,
    JointType.FIXED,
)


# Cached, because an arm asks for its description nine times while it is built.
@lru_cache(maxsize=8)
def load_urdf(files: RobotFiles) -> Urdf:
    """Read a robot description and check that the robot can be simulated.

    Args:
        files: The files of the robot, found by `load_robot_files`.

    Returns:
        The robot; every collision mesh exists, and every joint is revolute, continuous,
        prismatic or fixed and has limits that it can move within.

    Raises:
        RobotDescriptionError: A part is missing, wrong or cannot be simulated; the
            message names the file, the element and the reason.
    """
    urdf = parse_urdf(
        files.xml, source=str(files.urdf_path), find_mesh=files.resolve_mesh
    )
    for joint in urdf.joints.values():
        problem = _find_problem(joint)
        if problem is not None:
            raise RobotDescriptionError(
                f"{files.urdf_path}: {problem}",
                remedy=_find_remedy(urdf, joint),
            )
    return urdf


def _find_remedy(urdf: Urdf, joint: Joint) -> str:
    """Return the remedy for a joint that cannot be simulated."""
    kind = joint.type
    if kind in _SIMULATED:
        return f"Correct the joint '{joint.name}' of the URDF."
    is_only = urdf.joints_below(urdf.root) == [joint]
    if is_only and urdf.links[urdf.root].is_frame_only:
        return (
            f"Set robot.base to {kind.value} (on the command line: --base "
            f"{kind.value}); it takes the place of the joint '{joint.name}'."
        )
    return (
        f"Give the joint '{joint.name}' another type. Only a root link without mass "
        f"and shapes may carry a robot by a {kind.value} joint, and nothing else."
    )


def _find_problem(joint: Joint) -> str | None:
    """Return the reason why a joint cannot be simulated, or None if it can."""
    if joint.type not in _SIMULATED:
        allowed = ", ".join(kind.value for kind in _SIMULATED)
        return (
            f"Joint '{joint.name}' has the type '{joint.type.value}', which cannot be "
            f"simulated; allowed are {allowed}."
        )
    limit = joint.limit
    if joint.type is not JointType.FIXED and limit is not None:
        lower, upper = limit.lower, limit.upper
        if lower is not None and upper is not None and lower >= upper:
            return (
                f"Joint '{joint.name}' has a <limit> whose lower {lower} is not below "
                f"its upper {upper}; a joint that cannot move must be fixed."
            )
        if limit.effort < 0.0 or limit.velocity < 0.0:
            return (
                f"Joint '{joint.name}' has a <limit> with effort {limit.effort} and "
                f"velocity {limit.velocity}; they must not be negative."
            )
    soft = soft_joint_limits_from_urdf(joint)
    try:
        if soft is not None:
            soft.validate(joint.name)
    except JointLimitsError as error:
        return f"<safety_controller>: {error.message}"
    return None
