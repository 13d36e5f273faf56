"""Which joints a controller commands: the parameters `joints` and `joint`."""

from station.core.errors import ParameterError
from station.core.parameters import Parameters


def read_joint_names(params: Parameters) -> list[str]:
    """Return the joints of a group controller.

    Args:
        params: The controller's namespace; `joints` is a list of names.

    Raises:
        ParameterError: `joints` is missing, empty, or names a joint twice.
    """
    names = params.get_str_list("joints")
    if not names or len(set(names)) != len(names):
        raise ParameterError(
            f"Parameter '{params.resolve('joints')}' is {names}; it must name at least "
            "one joint, and each joint once.",
            remedy="List the joints the controller commands.",
            details={"parameter": params.resolve("joints")},
        )
    return names


def read_joint_name(params: Parameters) -> list[str]:
    """Return the joint of a single-joint controller as a list of one name.

    Args:
        params: The controller's namespace; `joint` is the name.

    Raises:
        ParameterError: `joint` is missing or not a string.
    """
    return [params.get_str("joint")]
