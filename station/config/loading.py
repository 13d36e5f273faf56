"""Put a configuration together: defaults, files, environment, command line."""

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from os import environ
from pathlib import Path

import yaml
from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict, SettingsError

from station.config.models import StationConfig
from station.config.ros2_parameters import is_ros2
from station.config.ros_parameters import (
    RosParameters,
    join_ros2,
    split_ros_parameters,
    substitute,
)
from station.config.validation import validate
from station.core.errors import ConfigError
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
        """Replace `$(arg arm)` in `arm_id`, and `$(arg arm_id)` in controllers."""
        robot = self.values.get("robot")
        arm_id = robot.get("arm_id") if isinstance(robot, dict) else None
        if isinstance(robot, dict) and isinstance(arm_id, str):
            arm = {"arm": str(robot.get("arm", _ARM))}
            arm_id = str(substitute(arm_id, arm, "robot"))
            self.values["robot"] = {**robot, "arm_id": arm_id}
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
