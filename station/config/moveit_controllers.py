"""Read MoveIt's list of controllers as the controllers that it expects to be there.

Source: moveit@1.1 moveit_simple_controller_manager for `controller_list` with the types
FollowJointTrajectory and GripperCommand; moveit_setup_assistant for the form of
ros_control, in which a type is that of a controller.
"""

from station.core.config_error import ConfigError
from station.core.errors import show

LIST = "controller_list"
_TRAJECTORY = "position_controllers/JointTrajectoryController"
_GRIPPER = "position_controllers/GripperActionController"
_ACTIONS = {"FollowJointTrajectory": _TRAJECTORY, "GripperCommand": _GRIPPER}


def controllers_of_list(value: object, name: str) -> dict[str, dict[str, object]]:
    """Return the parameters of the controllers in a `controller_list`.

    Args:
        value: The list, as it is written.
        name: The file, for messages.

    Raises:
        ConfigError: An entry has no name or no joints, or an unknown type.
    """
    if not isinstance(value, list):
        raise ConfigError(
            [f"{name}: {LIST} is {show(value)}."], remedy="Write a list of mappings."
        )
    found: dict[str, dict[str, object]] = {}
    for number, entry in enumerate(value):
        place = f"{name}: {LIST}[{number}]"
        if not isinstance(entry, dict) or not isinstance(entry.get("name"), str):
            raise ConfigError(
                [f"{place} has no name."], remedy="Give it a name, type and joints."
            )
        key = entry["name"].strip("/").rpartition("/")[2]
        parameters = _parameters(entry, place)
        if key and parameters is not None:
            found[key] = parameters
    return found


def _parameters(entry: dict[str, object], place: str) -> dict[str, object] | None:
    kind, joints = entry.get("type"), entry.get("joints")
    # Fake controllers have no type, and some lists have joints of nobody.
    if kind is None or joints == []:
        return None
    if not isinstance(joints, list) or not all(isinstance(j, str) for j in joints):
        raise ConfigError(
            [f"{place} has the joints {show(joints)}."], remedy="List their names."
        )
    if not isinstance(kind, str) or not (kind in _ACTIONS or "/" in kind):
        raise ConfigError(
            [
                f"{place} has the type {show(kind)}; known are {', '.join(_ACTIONS)} "
                "and types of controllers."
            ],
            remedy="Correct the type.",
        )
    controller = _ACTIONS.get(kind, kind)
    if controller == _GRIPPER:
        # One motor moves the fingers; the others mimic it.
        return {"type": controller, "joint": joints[0]}
    return {"type": controller, "joints": joints}
