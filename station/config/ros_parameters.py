"""Parameter files written for ROS: namespaces, substitutions, lists of controllers.

In ROS a file like `panda: {arm_controller: {type: …}}` puts a controller into the
namespace of a controller manager. A station has a single manager, so the namespace is
dropped.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

from station.config.ros2_parameters import (
    KEY,
    NEARLY_KEY,
    NEARLY_TYPE,
    is_ros2,
    read_ros2,
    refuse_near,
)
from station.core.errors import ConfigError, show

_SUBSTITUTION = re.compile(r"\$\((\w+)\s*([^)]*)\)")
_ONE_MANAGER = (
    "A station has one controller manager: give each controller a name of its own."
)
T = TypeVar("T")
_TYPE = re.compile(r"[A-Za-z_][\w.]*[/:][A-Za-z_]\w*")
# Keys besides controllers that a station reads. Files written for ROS may have any
# other key, so only a name that resembles one of these is refused: a similarity of 0.8
# refuses `sceen`, and accepts MoveIt's `robot_description_planning`.
_ROOT_KEYS = ("joint_limits", "robot_description", "scene")
_NEARLY = 0.8


@dataclass(slots=True)
class RosParameters:
    """The content of a ROS parameter file.

    Attributes:
        controllers: Parameters of each controller, `type` among them, by name.
        others: All other parameters, by name.
        paths: Path of each controller in the file, with namespaces, by name.
    """

    controllers: dict[str, dict[str, object]] = field(default_factory=dict)
    others: dict[str, object] = field(default_factory=dict)
    paths: dict[str, str] = field(default_factory=dict)

    def add_file(self, other: "RosParameters", name: str) -> None:
        """Add the values of another file; they override, as with `rosparam load`.

        Args:
            other: The content of the other file.
            name: Name of the other file for messages.

        Raises:
            ConfigError: Both files have the same name in different namespaces.
        """
        for key, path in other.paths.items():
            before = self.paths.get(key, path)
            if before != path:
                raise ConfigError(
                    [f"{name}: {path} has the name of {before} in an earlier file."],
                    remedy=_ONE_MANAGER,
                )
        self.controllers = _merged(self.controllers, other.controllers)
        self.others = _merged(self.others, other.others)
        self.paths |= other.paths


def split_ros_parameters(
    values: dict[str, object], name: str, types: Mapping[str, str] | None = None
) -> RosParameters:
    """Separate the controllers in a ROS parameter file from other parameters.

    A controller is a mapping with a `type` of the form `package/Class`; a namespace is
    a mapping with a controller somewhere below it. MoveIt's `controller_list` defines
    the controllers that it names, unless the file defines them itself.

    Args:
        values: The content of the file.
        name: Name of the file for messages.
        types: Types of controllers that the file does not name, for files of ROS 2; see
            `read_ros2`.

    Raises:
        ConfigError: Two namespaces have the same name, a key that the station reads is
            misspelt, or parameters of ROS 2 do not fit; see `read_ros2`.
    """
    found = RosParameters()
    if is_ros2(values):
        return join_ros2([values], name, types)
    _collect(values, "", found, name)
    if LIST in found.others:
        # The file's own entry for a controller overrides the one in MoveIt's list.
        listed = controllers_of_list(found.others.pop(LIST), name)
        found.controllers = {**listed, **found.controllers}
    return found


def join_ros2(
    files: Sequence[Mapping[str, object]],
    name: str,
    types: Mapping[str, str] | None = None,
) -> RosParameters:
    """Join files of ROS 2: one may have the types, another the parameters.

    Args:
        files: The content of each file, in their order.
        name: Name of the files for messages.
        types: Types of controllers that the files do not name; see `read_ros2`.

    Raises:
        ConfigError: Parameters do not fit their controller; see `read_ros2`.
    """
    controllers, others = read_ros2(files, name, types)
    paths = {key: key for key in (*controllers, *others)}
    return RosParameters(controllers, others, paths)


def _collect(
    values: dict[str, object], namespace: str, found: RosParameters, name: str
) -> None:
    for key, value in values.items():
        path = f"{namespace}/{key.strip('/')}"
        refuse_near(key, [KEY], NEARLY_KEY, f"{name}: {path}")
        if isinstance(value, dict) and _is_controller(value):
            _add(found.controllers, path, value, name)
            found.paths[path.rpartition("/")[2]] = path
        elif isinstance(value, dict) and _has_controllers(value):
            _collect(value, path, found, name)
        else:
            _refuse_misspelling(path, value, name)
            _add(found.others, path, value, name)
            found.paths[path.rpartition("/")[2]] = path


def _refuse_misspelling(path: str, value: object, name: str) -> None:
    """Refuse a key that would have no effect because of its spelling."""
    refuse_near(path.rpartition("/")[2], _ROOT_KEYS, _NEARLY, f"{name}: {path}")
    # Without `type`, a controller would be taken for other parameters.
    for inner, kind in value.items() if isinstance(value, dict) else ():
        is_type = isinstance(kind, str) and _TYPE.fullmatch(kind) is not None
        if is_type:
            refuse_near(inner, ["type"], NEARLY_TYPE, f"{name}: {path}/{inner}")


def _add(found: dict[str, T], path: str, value: T, name: str) -> None:
    key = path.rpartition("/")[2]
    if key in found:
        raise ConfigError(
            [f"{name}: {path} has a name that another namespace has, too."],
            remedy=_ONE_MANAGER,
        )
    found[key] = value


def _merged(before: Mapping[str, T], after: Mapping[str, T]) -> dict[str, T]:
    """Merge two mappings and the mappings in them; values of `after` win."""
    result: dict[str, Any] = dict(before)
    for key, value in after.items():
        old = result.get(key)
        both = isinstance(old, dict) and isinstance(value, dict)
        result[key] = _merged(old, value) if both else value  # type: ignore[arg-type]  # both are mappings
    return result


def _is_controller(value: dict[str, object]) -> bool:
    kind = value.get("type")
    return isinstance(kind, str) and _TYPE.fullmatch(kind) is not None


def _has_controllers(value: dict[str, object]) -> bool:
    return any(
        isinstance(child, dict) and (_is_controller(child) or _has_controllers(child))
        for child in value.values()
    )


def substitute(value: object, arguments: dict[str, str], name: str) -> object:
    """Return `value` with every `$(arg NAME)` in its texts and keys replaced.

    Args:
        value: Plain data.
        arguments: The values that the names stand for.
        name: Name of the file for messages.

    Raises:
        ConfigError: An argument is unknown, or the substitution is not `arg` but
            `find`, `env` or another one.

    Source:
        ros_comm@1.17.0 tools/rosparam, `subst_value`; differs: `arg` is the only
        substitution of roslaunch that is carried out.
    """
    if isinstance(value, dict):
        return {
            str(substitute(key, arguments, name)): substitute(child, arguments, name)
            for key, child in value.items()
        }
    if isinstance(value, list):
        return [substitute(child, arguments, name) for child in value]
    if not isinstance(value, str):
        return value

    def replacement(match: re.Match[str]) -> str:
        # ROS 2 writes `var` for `arg`.
        if match[1] in {"arg", "var"} and match[2].strip() in arguments:
            return arguments[match[2].strip()]
        allowed = ", ".join(f"$(arg {argument})" for argument in arguments)
        raise ConfigError(
            [f"{name}: {show(match[0])} in {show(value)} cannot be replaced."],
            remedy=f"Write the value itself; what can be replaced is: "
            f"{allowed or 'nothing'}.",
        )

    return _SUBSTITUTION.sub(replacement, value)


LIST = "controller_list"
_TRAJECTORY = "position_controllers/JointTrajectoryController"
_GRIPPER = "position_controllers/GripperActionController"
_ACTIONS = {"FollowJointTrajectory": _TRAJECTORY, "GripperCommand": _GRIPPER}


def controllers_of_list(value: object, name: str) -> dict[str, dict[str, object]]:
    """Return the parameters of the controllers in a `controller_list`.

    Args:
        value: The list, as it is written.
        name: Name of the file for messages.

    Raises:
        ConfigError: An entry has no name or no joints, or an unknown type.

    Source:
        moveit@1.1 moveit_simple_controller_manager for `controller_list` with the types
        FollowJointTrajectory and GripperCommand; moveit_setup_assistant for the form of
        ros_control, in which a type names a controller.
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
    # Fake controllers have no type, and some lists have entries without joints.
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
