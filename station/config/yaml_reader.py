"""Read one YAML file into plain data that knows where each value was written.

YAML 1.1, as ROS reads it, has traps. Here `1e-3` is a number, a date is text, and
what 1.1 and 1.2 read differently (`010`, `1:30`, `1_000`) is refused, as are duplicate
keys and keys that are not text.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import yaml
from typing_extensions import override

from station.config.angles import parse_angle
from station.config.errors import ConfigError

KeyPath = tuple[str | int, ...]

_TAG = "tag:yaml.org,2002:"
_AMBIGUOUS = "!ambiguous"
_FIX_FILE = "Correct the file and start again."
_MAX_DEPTH = 64
_MAX_VALUES = 100_000
"""Aliases of aliases make a few lines into more values than there is memory."""
# What a scalar without quotes is; the first pattern that matches decides.
_PLAIN_SCALARS = (
    (f"{_TAG}null", r"~|null|Null|NULL|"),
    (f"{_TAG}bool", r"(?i:true|false|yes|no|on|off)"),
    (f"{_TAG}int", r"[-+]?(?:0|[1-9][0-9]*|0x[0-9a-fA-F]+|0o[0-7]+)"),
    (f"{_TAG}float", r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"),
    (f"{_TAG}float", r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"),
    ("!radians", r"(?:rad|deg)\([^)]*\)"),
    (f"{_TAG}merge", r"<<"),
)
_TWO_MEANINGS = re.compile(
    r"[-+]?(?:0[0-9]+|[0-9][0-9_]*_[0-9_]*(?:\.[0-9_]*)?|[0-9]+(?::[0-5]?[0-9])+)"
)
# What YAML writes `.inf`, Python reads as `inf`.
_INF_OR_NAN = re.compile(r"\.(inf|nan)", re.IGNORECASE)


class _Loader(yaml.SafeLoader):
    """PyYAML's parser with the scalars of this module."""

    yaml_implicit_resolvers = {  # noqa: RUF012 - the name and type are PyYAML's
        None: [
            (_AMBIGUOUS, _TWO_MEANINGS),
            *((tag, re.compile(pattern)) for tag, pattern in _PLAIN_SCALARS),
        ]
    }

    @override
    def resolve(
        self, kind: type[yaml.Node], value: str | None, implicit: object
    ) -> str:
        """Return the tag of a node; plain scalars by whole match."""
        if kind is yaml.ScalarNode and isinstance(implicit, tuple) and implicit[0]:
            for tag, pattern in self.yaml_implicit_resolvers[None]:
                if pattern.fullmatch(value or ""):
                    return str(tag)
            return f"{_TAG}str"
        resolve = super().resolve
        return str(resolve(kind, value, implicit))  # type: ignore[no-untyped-call]  # PyYAML's stubs


@dataclass(frozen=True, slots=True)
class YamlDocument:
    """The content of a YAML file.

    Attributes:
        name: The file, as the user named it.
        values: The mapping at its root; dicts, lists, str, int, float, bool and None.
        positions: Line and column, from 1, of each value by its path.
    """

    name: str
    values: dict[str, object]
    positions: dict[KeyPath, tuple[int, int]]

    def where(self, path: KeyPath) -> str:
        """Return `file:line:column` of the value at `path`, or of what holds it."""
        while path and path not in self.positions:
            path = path[:-1]
        line, column = self.positions.get(path, (1, 1))
        return f"{self.name}:{line}:{column}"


def read_yaml(path: Path) -> YamlDocument:
    """Read the YAML file at `path`.

    Raises:
        ConfigError: It cannot be read, is not YAML, or holds something that is
            refused; the message says file, line and column.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ConfigError(
            [f"{path}: cannot be read: {error.strerror}."],
            remedy="Check the path and its permissions.",
        ) from error
    except UnicodeDecodeError as error:
        raise ConfigError(
            [f"{path}: byte {error.start} is not UTF-8."],
            remedy="Save the file as UTF-8.",
        ) from error
    return parse_yaml(text, str(path))


def parse_yaml(text: str, name: str) -> YamlDocument:
    """Parse YAML text; `name` stands for the file in messages.

    Raises:
        ConfigError: As `read_yaml`.
    """
    root = _compose(text, name)
    if root is None:
        return YamlDocument(name, {}, {})
    builder = _Builder(name)
    values = builder.build(root, ())
    if not isinstance(values, dict):
        raise ConfigError(
            [f"{name}:1:1: the file holds {values!r:.80}; it must hold a mapping."],
            remedy="Write `key: value` lines.",
        )
    return YamlDocument(name, values, builder.positions)


def parse_value(text: str, name: str) -> object:
    """Return what YAML text says, be it a mapping or a single number.

    Raises:
        ConfigError: As `read_yaml`.
    """
    root = _compose(text, name)
    return None if root is None else _Builder(name).build(root, ())


def _compose(text: str, name: str) -> yaml.Node | None:
    try:
        root: yaml.Node | None = yaml.compose(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f":{mark.line + 1}:{mark.column + 1}" if mark else ""
        message = f"{name}{place}: not valid YAML: {error.problem or error.context}."
        raise ConfigError([message], remedy=_FIX_FILE) from error
    except RecursionError as error:
        raise ConfigError(
            [f"{name}: nested deeper than {_MAX_DEPTH} levels."], remedy=_FIX_FILE
        ) from error
    except yaml.YAMLError as error:
        raise ConfigError(
            [f"{name}: not valid YAML: {error}."], remedy=_FIX_FILE
        ) from error
    return root


class _Builder:
    """Turns PyYAML's nodes into plain data and notes positions."""

    def __init__(self, name: str) -> None:
        self.positions: dict[KeyPath, tuple[int, int]] = {}
        self._name = name
        self._open: list[yaml.Node] = []
        self._count = 0

    def build(self, node: yaml.Node, path: KeyPath) -> object:
        """Return the data of `node`.

        Raises:
            ConfigError: Something in it is refused.
        """
        mark = node.start_mark
        self.positions[path] = (mark.line + 1, mark.column + 1)
        if any(node is parent for parent in self._open):
            raise self._refuse(node, "an alias may not contain itself")
        if len(self._open) >= _MAX_DEPTH:
            raise self._refuse(node, f"nested deeper than {_MAX_DEPTH} levels")
        self._count += 1
        if self._count > _MAX_VALUES:
            raise self._refuse(
                node, f"more than {_MAX_VALUES} values, aliases written out"
            )
        self._open.append(node)
        try:
            if isinstance(node, yaml.MappingNode):
                return self._mapping(node, path)
            if isinstance(node, yaml.SequenceNode):
                return [self.build(v, (*path, i)) for i, v in enumerate(node.value)]
            return self._scalar(node)
        finally:
            self._open.pop()

    def _mapping(self, node: yaml.MappingNode, path: KeyPath) -> dict[str, object]:
        merged: dict[str, object] = {}
        own: dict[str, object] = {}
        for key_node, value_node in node.value:
            if key_node.tag == f"{_TAG}merge":
                merged = {**self._merge(value_node, path), **merged}
                continue
            key = self.build(key_node, path) if _is_scalar(key_node) else None
            if not isinstance(key, str):
                raise self._refuse(
                    key_node, f"the key {_text(key_node)} is not text; put it in quotes"
                )
            if key in own:
                raise self._refuse(key_node, f"the key '{key}' is there twice")
            own[key] = self.build(value_node, (*path, key))
        mark = node.start_mark
        self.positions[path] = (mark.line + 1, mark.column + 1)
        return {**merged, **own}

    def _merge(self, node: yaml.Node, path: KeyPath) -> dict[str, object]:
        nodes = node.value if isinstance(node, yaml.SequenceNode) else [node]
        merged: dict[str, object] = {}
        for part in nodes:
            value = self.build(part, path)
            if not isinstance(value, dict):
                raise self._refuse(part, "`<<` takes a mapping or a list of them")
            merged = {**value, **merged}
        return merged

    def _scalar(self, node: yaml.Node) -> object:
        text = str(node.value)
        match node.tag.removeprefix(_TAG):
            case "str":
                return text
            case "null":
                return None
            case "bool" if text.lower() in {"true", "yes", "on"}:
                return True
            case "bool" if text.lower() in {"false", "no", "off"}:
                return False
            case "int" | "float" | "!radians" | "!degrees" as kind:
                return self._number(kind, text, node)
            case "!ambiguous":
                raise self._refuse(
                    node,
                    f"{text} means different things in YAML 1.1 and 1.2; write a "
                    f'plain decimal number, or "{text}" if it is text',
                )
        raise self._refuse(node, f"{text!r} has the tag {node.tag}, which is unknown")

    def _number(self, kind: str, text: str, node: yaml.Node) -> int | float:
        try:
            match kind:
                case "int":
                    return int(text, 0)
                case "float":
                    return float(_INF_OR_NAN.sub(r"\1", text))
                case "!degrees":
                    return parse_angle(f"deg({text})")
            return parse_angle(text)
        except ValueError as error:
            raise self._refuse(node, f"{text!r} is no number: {error}") from error

    def _refuse(self, node: yaml.Node, problem: str) -> ConfigError:
        mark = node.start_mark
        place = f"{self._name}:{mark.line + 1}:{mark.column + 1}"
        return ConfigError([f"{place}: {problem}."], remedy=_FIX_FILE)


def _is_scalar(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode)


def _text(node: yaml.Node) -> str:
    return repr(node.value) if _is_scalar(node) else "(a list or mapping)"
