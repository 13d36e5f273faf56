"""Read the pose of one arm's base in the frame of another arm's base.

Both bases are links of one robot description, and fixed joints connect them.
"""

import numpy as np
from numpy.typing import NDArray

from station.core.description.urdf import Pose, Urdf
from station.core.description.urdf_parser import parse_urdf
from station.core.errors import RobotDescriptionError
from station.core.numerics.poses import pose_of


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
    result: NDArray[np.float64] = np.linalg.inv(_matrix(first)) @ _matrix(second)
    return result


def _fixed_root(urdf: Urdf, link: str) -> tuple[str, Pose]:
    if link not in urdf.links:
        raise RobotDescriptionError(
            f"The robot description has no link '{link}'.",
            remedy="Name links of the description, or describe all arms in it.",
            details={"link": link},
        )
    return urdf.fixed_root(link)


def _matrix(pose: Pose) -> NDArray[np.float64]:
    w, x, y, z = pose.quaternion
    return np.array(pose_of(pose.xyz, (x, y, z, w))).reshape(4, 4).T
