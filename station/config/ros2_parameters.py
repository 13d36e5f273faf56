"""Parameter files written for ROS 2: nodes, wildcards, and names of ros2_controllers.

A file of ROS 2 has the parameters of nodes below `ros__parameters`. The node of a
controller manager names the types of controllers; each controller is a node, too. A key
of a node may be a pattern: `*` stands for one name, `**` for any number of names. If
several keys fit a node, values that come later in the file win.

Source: ros2 rcl_yaml_param_parser; ros2_controllers@4.x, the parameters of each.
"""

import difflib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import inf
from typing import Any

from station.core.errors import ConfigError, show

KEY = "ros__parameters"
"""Key below which a file of ROS 2 has the parameters of a node."""
NEARLY_KEY, NEARLY_TYPE = 0.9, 0.7
"""Similarities from which a key is taken for these two, `ros__parameters` and `type`.
`parameters` alone is no misspelling."""
_MANAGER = "controller_manager"
_TYPE = re.compile(r"[A-Za-z_][\w.]*[/:]+[A-Za-z_]\w*")
_CLASS = re.compile(r"[A-Za-z_]\w*[/:]+[A-Z]\w*")
_SEPARATORS = re.compile(r"[./]")
_FALLBACK = "fallback_controllers"
Values = dict[str, Any]


def is_ros2(values: object) -> bool:
    """Return whether a mapping has the parameters of a node of ROS 2 somewhere."""
    return isinstance(values, Mapping) and (
        KEY in values or any(is_ros2(child) for child in values.values())
    )


def read_ros2(
    files: Sequence[Mapping[str, object]],
    name: str,
    types: Mapping[str, str] | None = None,
) -> tuple[dict[str, Values], Values]:
    """Return the controllers and the other nodes in parameter files of ROS 2.

    Types and parameters of controllers are translated into those of the station. A
    controller keeps its name; if controllers in different namespaces have the same
    name, each name gets its namespace as a prefix, e.g. `left_arm`.

    Args:
        files: The content of each file; later values win, as in one file.
        name: Name of the files for messages.
        types: Types of controllers that the files do not name, by name of the
            controller: a launch file of ROS 2 may name them.

    Returns:
        The parameters of each controller, `type` among them, by name, and those of
        every other node, by its name.

    Raises:
        ConfigError: A node has no parameters, or parameters of a controller do not fit
            its type.
    """
    nodes = [node for values in files for node in _nodes(values, (), name)]
    found: dict[tuple[str, ...], Values] = {}
    fallbacks: list[tuple[tuple[str, ...], Values]] = []
    for path, params in nodes:
        known = params.get("type") or (types or {}).get(path[-1])
        own = {"": {"type": known}} if isinstance(known, str) else {}
        is_manager = path[-1] == _MANAGER
        # The wildcards of a pattern are no part of a namespace.
        space = tuple(part for part in path[:-1] if "*" not in part)
        for key, value in params.items() if is_manager else own.items():
            if is_manager:
                _refuse_half_a_type(value, f"{name}: /{'/'.join(path)}/{key}")
            if isinstance(value, dict) and _is_type(value.get("type")):
                place = (*space, key or path[-1])
                found[place] = {**found.get(place, {}), "type": value["type"]}
            # Managers have them, too, also of controllers that tell their types.
            if is_manager and isinstance(value, dict) and _FALLBACK in value:
                fallbacks.append(((*space, key), {_FALLBACK: value[_FALLBACK]}))
    for place, params in found.items():
        for path, more in (*nodes, *fallbacks):
            if _fits(path, place):
                _merge(params, more)
    last = [place[-1] for place in found]
    controllers = {
        place[-1] if last.count(place[-1]) == 1 else "_".join(place): translate(
            params, f"{name}: {'/'.join(place)}"
        )
        for place, params in found.items()
    }
    used = {path for path, _ in nodes for place in found if _fits(path, place)}
    others = {
        path[-1]: params
        for path, params in nodes
        if path not in used and "*" not in path[-1]
    }
    return controllers, others


def _nodes(
    values: Mapping[str, object], path: tuple[str, ...], name: str
) -> Iterator[tuple[tuple[str, ...], Values]]:
    for key, value in values.items():
        place = (*path, *(part for part in str(key).split("/") if part))
        if key == KEY:
            if not isinstance(value, dict):
                raise ConfigError(
                    [f"{name}: /{'/'.join(path)}/{KEY} is {show(value)}."],
                    remedy="Write the parameters of the node below it.",
                )
            yield path or ("**",), _nested(value)
        elif isinstance(value, Mapping):
            refuse_near(str(key), [KEY], NEARLY_KEY, f"{name}: /{'/'.join(place)}")
            yield from _nodes(value, place, name)


def refuse_near(key: str, known: Sequence[str], nearly: float, place: str) -> None:
    """Refuse a key that has no effect, because it is another one misspelt.

    Args:
        key: The key.
        known: The keys that it may be.
        nearly: Similarity from which it counts as misspelt.
        place: File and path of the key for the message.

    Raises:
        ConfigError: The key resembles one of the others.
    """
    meant = difflib.get_close_matches(key.lower(), known, 1, nearly)
    if key not in known and meant:
        raise ConfigError(
            [f"{place} has no effect. Did you mean '{meant[0]}'?"],
            remedy="Correct the name, or leave the key out.",
        )


def _refuse_half_a_type(value: object, place: str) -> None:
    """Refuse a parameter of a manager that says only half of a controller.

    Raises:
        ConfigError: It has no type of a controller, although it looks like one.
    """
    wrong, where = value, place
    if isinstance(value, dict):
        for key, kind in value.items():
            if _is_type(kind):
                refuse_near(key, ["type"], NEARLY_TYPE, f"{place}/{key}")
        if "type" not in value or _is_type(value["type"]):
            return
        wrong, where = value["type"], f"{place}/type"
    elif not (isinstance(value, str) and _CLASS.fullmatch(value)):
        return
    raise ConfigError(
        [f"{where} is {show(wrong)}."],
        remedy="Write the type of a controller as `NAME: {type: package/Class}`.",
    )


def _nested(values: Mapping[str, object]) -> Values:
    """Return the values with `a.b: 1` written as `a: {b: 1}`."""
    result: Values = {}
    for key, value in values.items():
        inner = _nested(value) if isinstance(value, dict) else value
        # A filter of a single input is named after the input, with the slash in its
        # name.
        for part in reversed(_SEPARATORS.split(str(key))):
            inner = {part: inner}
        _merge(result, inner)  # type: ignore[arg-type]  # a key has at least one part
    return result


def _merge(into: Values, more: Values) -> None:
    for key, value in more.items():
        before = into.get(key)
        if isinstance(before, dict) and isinstance(value, dict):
            into[key] = dict(before)
            _merge(into[key], value)
        else:
            into[key] = value


def _fits(pattern: tuple[str, ...], path: tuple[str, ...]) -> bool:
    if not pattern or not path:
        return pattern in {(), ("**",)} and not path
    if pattern[0] == "**":
        return _fits(pattern[1:], path) or _fits(pattern, path[1:])
    return pattern[0] in {"*", path[0]} and _fits(pattern[1:], path[1:])


def _is_type(value: object) -> bool:
    return isinstance(value, str) and _TYPE.fullmatch(value) is not None


def translate(params: Values, place: str) -> Values:
    """Translate a ROS 2 controller's parameters into those of the station's controller.

    A type without a translation stays as it is: either the station has the same type
    under the same name, or it does not know the type at all.

    Args:
        params: The parameters, `type` among them.
        place: Name of the file for messages.

    Raises:
        ConfigError: No controller type of the station commands these interfaces.
    """
    change = _TRANSLATIONS.get(str(params["type"]))
    params = dict(params)
    if _FALLBACK in params:
        params["fallback"] = params.pop(_FALLBACK)
    return params if change is None else change(params, place)


_KINDS = {
    ("position",): "position_controllers",
    ("velocity",): "velocity_controllers",
    ("effort",): "effort_controllers",
    ("position", "velocity"): "pos_vel_controllers",
    ("position", "velocity", "acceleration"): "pos_vel_acc_controllers",
}


_AS_LONG_AS_IT_TAKES = 86_400.0
"""Longest goal time tolerance that a trajectory controller takes [s]."""
_NO_BOUND = 1e6
"""Bound of the integral part that no controller reaches [N, Nm, m/s or rad/s]."""


def _group(params: Values, key: str, place: str) -> Values:
    """Return the parameters below a key, which are none if it is left empty.

    Raises:
        ConfigError: A value stands in their place.
    """
    value = params.get(key)
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise ConfigError(
            [f"{place}{key} is {show(value)}."],
            remedy="Write a mapping of parameters below it.",
        )
    return value


def _kind(interfaces: object, place: str) -> str:
    if isinstance(interfaces, list):
        kind = _KINDS.get(tuple(map(str, interfaces)))
        if kind is not None:
            return kind
    known = "; ".join(", ".join(each) for each in _KINDS)
    raise ConfigError(
        [f"{place}: the commanded interfaces are {show(interfaces)}."],
        remedy=f"Command one of these: {known}.",
    )


# Parameters of trajectory controllers whose values ask for what is done here anyway: a
# new trajectory begins at the desired state of the old one, whose other joints go on,
# and after its last point the joints hold. Other values are named in a warning.
_AS_HERE = {
    "interpolate_from_desired_state": True,
    "allow_trajectory_replacement": True,
    "interpolation_method": "splines",
    "allow_integration_in_goal_trajectories": False,
}
_GAINS_AS_HERE = {
    "u_clamp_max": inf,
    "u_clamp_min": -inf,
    "i_clamp_max": inf,
    "i_clamp_min": -inf,
    "antiwindup_strategy": "none",
    "tracking_time_constant": 0.0,
    "error_deadband": 0.0,
}


def _without(params: Values, inert: Mapping[str, object]) -> Values:
    return {
        key: value
        for key, value in params.items()
        if key not in inert or value != inert[key]
    }


def _trajectory(params: Values, place: str) -> Values:
    params = _without(params, _AS_HERE)
    params.pop("cmd_timeout", None)
    kind = _kind(params.pop("command_interfaces", None), place)
    params["type"] = f"{kind}/JointTrajectoryController"
    params.pop("state_interfaces", None)
    # In ROS 2 `speed_scaling` may name interfaces of a driver; here it is a factor.
    if isinstance(speed := params.get("speed_scaling"), dict):
        params["speed_scaling"] = speed.get("initial_scaling_factor", 1.0)
    # In ROS 2 a goal without a goal_time waits for the joints as long as it takes.
    constraints = _group(params, "constraints", f"{place}: ")
    params["constraints"] = {
        **constraints,
        "goal_time": constraints.get("goal_time") or _AS_LONG_AS_IT_TAKES,
    }
    params.setdefault("allow_nonzero_velocity_at_trajectory_end", False)
    joints = params.pop("command_joints", None) or params.get("joints")
    params["joints"] = joints
    # ROS 2 has the feed-forward gain of the velocity among the gains of a joint.
    given = _group(params, "gains", f"{place}: ")
    # Copies, because controllers may share a block of their wildcards.
    gains = {
        joint: _without(_group(given, joint, f"{place}: gains/"), _GAINS_AS_HERE)
        for joint in given
    }
    if gains:
        params["gains"] = gains
    for joint, own in gains.items():
        # The integral part of ROS 2 has no bound on a side for which none is given.
        if own.get("i"):
            own.setdefault("i_clamp", _NO_BOUND)
        scale = own.pop("ff_velocity_scale", None)
        if scale is not None:
            forward = _group(params, "velocity_ff", f"{place}: ")
            params["velocity_ff"] = {**forward, joint: scale}
    return params


def _forward(params: Values, place: str) -> Values:
    kind = _kind([params.pop("interface_name", None)], place)
    quantity = kind.partition("_")[0].title()
    params["type"] = f"{kind}/JointGroup{quantity}Controller"
    return params


def _joint_states(params: Values, place: str) -> Values:  # noqa: ARG001 - as the others
    params["type"] = "joint_state_controller/JointStateController"
    params.setdefault("publish_rate", 50.0)
    # In ROS 2 all joints are published unless joints and interfaces are both listed.
    if not (params.get("joints") and params.get("interfaces")):
        params.pop("joints", None)
    params.pop("interfaces", None)
    # Extra joints are names there, and their values are 0.
    extra = params.get("extra_joints")
    if isinstance(extra, list):
        params["extra_joints"] = [
            {"name": each} if isinstance(each, str) else each for each in extra
        ]
    return params


def _imu(params: Values, place: str) -> Values:  # noqa: ARG001 - as the others
    params["type"] = "imu_sensor_controller/ImuSensorController"
    params.setdefault("publish_rate", 50.0)
    return params


_TRANSLATIONS: Mapping[str, Callable[[Values, str], Values]] = {
    # In the station every trajectory controller scales its speed.
    "ur_controllers/ScaledJointTrajectoryController": _trajectory,
    "joint_trajectory_controller/JointTrajectoryController": _trajectory,
    "forward_command_controller/ForwardCommandController": _forward,
    "joint_state_broadcaster/JointStateBroadcaster": _joint_states,
    "imu_sensor_broadcaster/IMUSensorBroadcaster": _imu,
}
