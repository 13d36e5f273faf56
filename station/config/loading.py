"""Put a configuration together, from defaults to command line, and validate it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from os import environ
from pathlib import Path
from typing import Any, get_args, get_origin

import yaml
from pydantic import Field, ValidationError
from pydantic_core import ErrorDetails
from pydantic_settings import BaseSettings, SettingsConfigDict, SettingsError

from station.config.models import (
    MODULE_PATTERN,
    NAME_PATTERN,
    ORIGIN_PATTERN,
    PLUGIN_PATTERN,
    StationConfig,
)
from station.config.ros2_parameters import is_ros2
from station.config.ros_parameters import (
    RosParameters,
    join_ros2,
    split_ros_parameters,
    substitute,
)
from station.core.errors import ConfigError, key_text, show
from station.core.yaml_reader import (
    KeyPath,
    YamlDocument,
    parse_value,
    parse_yaml,
    read_yaml,
)

_PREFIX = "STATION_"
_BETWEEN = "__"
# Value of `$(arg arm)` for a robot without the parameter `arm`, as in franka_ros.
_ARM = "panda"
_Section = dict[str, object]
# Names that controllers cannot have, because the parameter tree uses them.
RESERVED_NAMES = frozenset({"robot", "robot_description", "scene"})
_REMEDY = "Correct the configuration and start again."
_WANTED = {
    "string_type": "text; put it in quotes",
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "list_type": "a list",
    "tuple_type": "two numbers, the lower one first",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "finite_number": "a finite number",
}
_PATTERNS = {
    ORIGIN_PATTERN: "scheme, host and port of a page, e.g. https://lab.example:8443",
    MODULE_PATTERN: "the name of a Python module, e.g. my_package.my_controllers",
    NAME_PATTERN: "a name of letters, digits and underscores",
    PLUGIN_PATTERN: "package/Class, e.g. franka_hw/FrankaHW, or module:Class",
}


class _Environment(BaseSettings):
    """The sections of a configuration, filled from environment variables."""

    model_config = SettingsConfigDict(
        env_prefix=_PREFIX, env_nested_delimiter=_BETWEEN, extra="ignore"
    )

    station: _Section = Field(default_factory=dict)
    robot: _Section = Field(default_factory=dict)
    scene: _Section = Field(default_factory=dict)
    controllers: _Section = Field(default_factory=dict)
    start: list[str] | None = None
    api: _Section = Field(default_factory=dict)
    ui: _Section = Field(default_factory=dict)
    watchdog: _Section = Field(default_factory=dict)
    records: _Section = Field(default_factory=dict)
    foxglove: _Section = Field(default_factory=dict)
    rosbridge: _Section = Field(default_factory=dict)
    agents: _Section = Field(default_factory=dict)
    fci: _Section = Field(default_factory=dict)
    rehearsal: _Section = Field(default_factory=dict)
    cameras: _Section = Field(default_factory=dict)
    arguments: _Section = Field(default_factory=dict)


def read_environment() -> Iterator[tuple[KeyPath, object, str]]:
    """Yield each setting of the environment: its path, its value, its variable.

    Raises:
        ConfigError: A variable for a list or mapping is not JSON, or the section that
            a variable names does not exist.
    """
    unknown = list(_unknown_sections())
    if unknown:
        raise ConfigError(unknown, remedy="Correct the names of the variables.")
    try:
        settings = _Environment().model_dump(exclude_unset=True)
    except (SettingsError, ValueError) as error:
        raise ConfigError(
            [f"Environment variables {_PREFIX}…: {error}."],
            remedy=f"Write lists and mappings as JSON: {_PREFIX}START='[\"arm\"]'.",
        ) from error
    yield from _leaves(settings, ())


def _unknown_sections() -> Iterator[str]:
    known = _Environment.model_fields
    for variable in environ:
        section, between, _ = variable.removeprefix(_PREFIX).lower().partition(_BETWEEN)
        # Variables without `__`, such as STATION_TOKEN, belong to other programs.
        if variable.startswith(_PREFIX) and between and section not in known:
            yield (
                f"environment variable {variable}: {section} is unknown; allowed are "
                f"{', '.join(known)}."
            )


def _leaves(
    node: dict[str, object], path: KeyPath
) -> Iterator[tuple[KeyPath, object, str]]:
    for key, value in node.items():
        here = (*path, key)
        if isinstance(value, dict):
            yield from _leaves(value, here)
        else:
            variable = _PREFIX + _BETWEEN.join(map(str, here)).upper()
            if isinstance(value, str):
                value = parse_value(value, f"environment variable {variable}")
            yield here, value, variable


DEFAULT_FILE = Path(__file__).with_name("default.yaml")
_MERGED_SECTIONS = (
    "station", "robot", "scene", "api", "ui", "watchdog", "records", "foxglove",
    "rosbridge", "agents", "fci", "rehearsal", "arguments",
)  # fmt: skip
_INNER_SECTIONS = {n for n, f in StationConfig.model_fields.items() if f.exclude}
_SECTIONS = [n for n, f in StationConfig.model_fields.items() if not f.exclude]


def load_config(
    path: Path | Mapping[str, object] | None = None,
    *,
    controller_files: Sequence[Path] = (),
    flags: Mapping[str, object] | None = None,
) -> StationConfig:
    """Return the configuration of a station.

    Later sources override earlier ones, in this order: the defaults, the file,
    environment variables, flags, controller files.

    Args:
        path: The station's YAML file, or the content of such a file; None takes the
            defaults only.
        controller_files: Parameter files written for ROS, added to `controllers`.
        flags: Values of the command line, by dotted key such as `api.port`.

    Raises:
        ConfigError: A file cannot be read, or a value is not allowed.
    """
    merge = _Merge()
    merge.add_file(parse_yaml(DEFAULT_FILE.read_text(encoding="utf-8"), "default.yaml"))
    if isinstance(path, Mapping):
        merge.add_file(parse_yaml(yaml.safe_dump(dict(path)), "configuration"))
    elif path is not None:
        merge.add_file(read_yaml(path))
    merge.add_environment()
    merge.add_flags(flags or {})
    merge.add_controllers([read_yaml(file) for file in controller_files])
    merge.substitute_arguments()
    return validate(merge.values, merge.where)


class _Merge:
    """Mappings merged over each other, and the source of each value."""

    def __init__(self) -> None:
        self.values: dict[str, object] = {}
        self._sources: list[tuple[KeyPath, str | YamlDocument]] = []
        self._parameters: dict[str, object] = {}

    def where(self, path: KeyPath) -> str:
        """Return the last source that has set the value at `path`."""
        for prefix, source in reversed(self._sources):
            if path[: len(prefix)] == prefix:
                return source if isinstance(source, str) else source.where(path)
        return "configuration"

    def add_file(self, document: YamlDocument) -> None:
        """Merge a file over the values so far.

        Raises:
            ConfigError: The file has a section that is not allowed, such as
                `parameters`.
        """
        values = document.values
        for section in _INNER_SECTIONS & values.keys():
            raise ConfigError(
                [
                    f"{document.where((section,))}: {section} is unknown; "
                    f"allowed are {', '.join(_SECTIONS)}."
                ],
                remedy="Put the parameters of controllers under 'controllers'.",
            )
        if self._is_another_robot(values):
            self._put("controllers", {}, document)
        if "controllers" in values or self._is_another_robot(values):
            self._put("start", [], document)
        for section, value in values.items():
            if section == "robot":
                value = _relative_to(Path(document.name).parent, value)
            self._add_section(section, value, document)

    def add_controllers(self, documents: Sequence[YamlDocument]) -> None:
        """Add the controllers and other parameters of files written for ROS.

        Raises:
            ConfigError: Two namespaces have the same name, a key is misspelt, or
                parameters of ROS 2 do not fit their controller.
        """
        found, sources = RosParameters(), list[tuple[KeyPath, str | YamlDocument]]()
        before = self.values.get("controllers")
        known = before if isinstance(before, dict) else {}
        types = {
            key: value["type"]
            for key, value in known.items()
            if isinstance(value, dict) and isinstance(value.get("type"), str)
        }
        together = [each for each in documents if is_ros2(each.values)]
        parts = [
            (each.name, split_ros_parameters(each.values, each.name))
            for each in documents
            if each not in together
        ]
        if together:
            names = ", ".join(each.name for each in together)
            values = [each.values for each in together]
            parts.append((names, join_ros2(values, names, types)))
        for source, more in parts:
            found.add_file(more, source)
            sources += [(("controllers", name), source) for name in more.controllers]
        if documents:
            self.values["controllers"] = {**known, **found.controllers}
        self._sources += sources
        self._parameters |= found.others
        self.values["ros_controllers"] = frozenset(found.controllers)

    def add_environment(self) -> None:
        """Merge environment variables over the values so far."""
        for path, value, variable in read_environment():
            self._set(path, value, f"environment variable {variable}")

    def add_flags(self, flags: Mapping[str, object]) -> None:
        """Merge the values of the command line over the values so far."""
        for dotted, value in flags.items():
            self._set(tuple(dotted.split(".")), value, "command line")

    def substitute_arguments(self) -> None:
        """Replace `$(arg arm)` in `arm_id`, and `$(arg arm_id)` in controllers.

        Raises:
            ConfigError: `arm_id` is no text.
        """
        robot = self.values.get("robot")
        arm_id = robot.get("arm_id") if isinstance(robot, dict) else None
        if isinstance(robot, dict) and isinstance(arm_id, str):
            arm = {"arm": str(robot.get("arm", _ARM))}
            arm_id = str(substitute(arm_id, arm, "robot"))
            self.values["robot"] = {**robot, "arm_id": arm_id}
        elif isinstance(robot, dict) and "arm_id" in robot:
            where = self.where(("robot", "arm_id"))
            raise ConfigError(
                [f"{where}: robot.arm_id is {show(arm_id)}; it must be text."],
                remedy="Write a name, such as panda, or leave it out.",
            )
        given = self.values.get("arguments")
        arguments = {
            key: str(value)
            for key, value in (given.items() if isinstance(given, dict) else ())
        }
        if isinstance(arm_id, str):
            arguments["arm_id"] = arm_id
            self._name_arm(arm_id)
        for section, values in (
            ("controllers", self.values.get("controllers")),
            ("parameters", self._parameters),
        ):
            self.values[section] = substitute(values, arguments, section)

    def _name_arm(self, arm_id: str) -> None:
        """Give the example controllers of franka_ros2 the arm that their files omit."""
        controllers = self.values.get("controllers")
        names = self.values.get("ros_controllers")
        if not isinstance(controllers, dict) or not isinstance(names, frozenset):
            return
        for name in names:
            params = controllers[name]
            package, _, kind = str(params.get("type")).partition("/")
            if package != "franka_example_controllers":
                continue
            named: dict[str, object] = {}
            if kind != "JointPositionExampleController":
                named["arm_id"] = arm_id
            if "Joint" in kind:
                joints = [f"{arm_id}_joint{number}" for number in range(1, 8)]
                named["joint_names"] = joints
            controllers[name] = {**named, **params}

    def _is_another_robot(self, values: Mapping[str, object]) -> bool:
        before, now = self.values.get("robot"), values.get("robot")
        return (
            isinstance(before, dict)
            and isinstance(now, dict)
            and now.get("type", before.get("type")) != before.get("type")
        )

    def _add_section(self, section: str, value: object, document: YamlDocument) -> None:
        before = self.values.get(section)
        merged = section in _MERGED_SECTIONS and not self._is_another_robot({
            section: value
        })
        if merged and isinstance(before, dict) and isinstance(value, dict):
            self._sources += [((section, key), document) for key in value]
            self.values[section] = {**before, **value}
        elif section == "controllers" and isinstance(value, dict):
            found = split_ros_parameters(value, document.name)
            # A mapping without a type stays among the controllers, so that the
            # missing type is refused; namespaces may hold other parameters.
            untyped = {k: v for k, v in found.others.items() if k in value}
            self._parameters |= {
                k: v for k, v in found.others.items() if k not in value
            }
            self._put(section, {**found.controllers, **untyped}, document)
        else:
            self._put(section, value, document)

    def _put(self, section: str, value: object, source: str | YamlDocument) -> None:
        self._sources.append(((section,), source))
        self.values[section] = deepcopy(value)

    def _set(self, path: KeyPath, value: object, source: str) -> None:
        self._sources.append((path, source))
        node: dict[str, object] = self.values
        for part in path[:-1]:
            child = node.get(str(part))
            child = dict(child) if isinstance(child, dict) else {}
            node[str(part)] = child
            node = child
        node[str(path[-1])] = value


def _relative_to(directory: Path, robot: object) -> object:
    """Return a robot's parameters, with relative URDF paths joined to `directory`."""
    if not isinstance(robot, dict):
        return robot
    found: dict[str, object] = {}
    for key, value in robot.items():
        if key != "robot_description":
            found[key] = _relative_to(directory, value)
        elif isinstance(value, str) and value.endswith(".urdf"):
            found[key] = str(directory / Path(value).expanduser())
        else:
            found[key] = value
    return found


def validate(
    values: dict[str, object], where: Callable[[KeyPath], str]
) -> StationConfig:
    """Return the validated configuration that `values` describe.

    Args:
        values: The merged mappings.
        where: Function that returns the source of the value at a path.

    Raises:
        ConfigError: Values are not allowed; the message names each of them.
    """
    try:
        config = StationConfig.model_validate(values)
    except ValidationError as error:
        problems = [_problem(details, where) for details in error.errors()]
        raise ConfigError(problems, remedy=_REMEDY) from error
    _check_names(config, where)
    return config


def _check_names(config: StationConfig, where: Callable[[KeyPath], str]) -> None:
    known = ", ".join(config.controllers) or "none"
    problems = [
        f"{where(('start', i))}: start[{i}] is {show(name)}; allowed are the names in "
        f"'controllers': {known}."
        for i, name in enumerate(config.start)
        if name not in config.controllers
    ]
    problems += [
        f"{where(('controllers', name))}: controllers.{name} has a name that is taken: "
        f"the station keeps its own parameters under '{name}'."
        for name in RESERVED_NAMES & (config.controllers.keys() | config.parameters)
    ]
    if problems:
        raise ConfigError(problems, remedy=_REMEDY)


def _problem(details: ErrorDetails, where: Callable[[KeyPath], str]) -> str:
    path = details["loc"]
    if path[-1:] == ("[key]",):
        path = path[:-1]
    return f"{where(path)}: {key_text(path)} {_complaint(details)}."


def _complaint(details: ErrorDetails) -> str:
    kind, value = details["type"], details["input"]
    if kind == "extra_forbidden":
        return f"is unknown; allowed are {', '.join(_siblings(details['loc']))}"
    if kind == "missing":
        return "is missing"
    limits = details.get("ctx", {})
    wanted = _WANTED.get(kind)
    if kind == "string_too_short":
        least = limits["min_length"]
        wanted = f"text of {least} characters or more" if least > 1 else "some text"
    if kind == "string_pattern_mismatch":
        pattern = str(limits["pattern"])
        wanted = _PATTERNS.get(pattern, f"text that matches {pattern}")
    if wanted is None:
        message = details["msg"].removeprefix("Input should ").removeprefix("be ")
        wanted = message[0].lower() + message[1:]
    # The message may end up in a log, where a token must not be.
    is_secret = "token" in str(details["loc"][-1])
    shown = f"a text of {len(str(value))} characters" if is_secret else show(value)
    return f"is {shown}; it must be {wanted}"


def _siblings(path: tuple[str | int, ...]) -> list[str]:
    """Return the keys that are allowed in the place of an unknown key."""
    model: Any = StationConfig
    for part in path[:-1]:
        if get_origin(model) is dict:
            model = get_args(model)[1]
        else:
            model = model.model_fields[str(part)].annotation
    return [n for n, f in model.model_fields.items() if not f.exclude]
