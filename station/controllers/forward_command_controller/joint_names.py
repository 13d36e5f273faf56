"""The parameter `joints`: which joints a controller commands."""

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
    # Of two commands for a joint that is named twice, the second would win silently.
    if not names or len(set(names)) != len(names):
        raise ParameterError(
            f"Parameter '{params.resolve('joints')}' is {names}; it must name at least "
            "one joint, and each joint once.",
            remedy="List the joints the controller commands.",
            details={"parameter": params.resolve("joints")},
        )
    return names
