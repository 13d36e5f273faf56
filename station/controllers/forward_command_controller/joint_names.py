"""The parameters `joint` and `joints`: which joints a controller commands."""

from station.core.declared_parameter import (
    DeclaredParameter,
    NameKind,
    ParameterType,
)
from station.core.parameters import Parameters

JOINT = DeclaredParameter(
    name="joint",
    type=ParameterType.STRING,
    names=NameKind.JOINT,
    description="the joint",
)
JOINTS = DeclaredParameter(
    name="joints",
    type=ParameterType.STRINGS,
    names=NameKind.JOINT,
    description="the joints, in the order of the set-points",
)


def read_joint_names(params: Parameters) -> list[str]:
    """Return the joints of a group controller.

    Args:
        params: The controller's namespace; `joints` is a list of names.

    Raises:
        ParameterError: `joints` is missing, empty, or names a joint twice.
    """
    names = JOINTS.read_str_list(params)
    # Of two commands for a joint that is named twice, the second would win silently.
    if not names or len(set(names)) != len(names):
        JOINTS.refuse(
            params, names, "a list of at least one joint, and each joint once"
        )
    return names
