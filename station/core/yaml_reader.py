"""The one reader of YAML: plain data that knows where each value was written.

YAML 1.1, as ROS reads it, has traps. Here `1e-3` is a number and a date is text.
Scalars that YAML 1.1 and 1.2 read differently (`010`, `1:30`, `1_000`) are refused, and
so are duplicate keys and keys that are not text.

Reading is slow (2 to 10 us a character) and aliases of aliases make a few lines into
more values than there is memory. So the length of a text, its depth and its values,
with every alias written out, are bounded before they cost anything.
"""

import ast
import math
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from typing_extensions import override
from yaml.composer import Composer, ComposerError

try:
    from yaml import CSafeLoader as _Parser
except ImportError:  # PyYAML was built without libyaml, and takes five times as long.
    from yaml import SafeLoader as _Parser  # type: ignore[assignment]

from station.core.errors import ConfigError, key_text, show

_OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
_MAX_LENGTH = 100


def parse_angle(text: str) -> float:
    """Return the angle [rad] of the text `rad(…)`, `deg(…)` or a bare expression.

    Args:
        text: Numbers, `pi`, `+ - * /` and parentheses; degrees inside `deg(…)`.

    Raises:
        ValueError: The text is anything else, is longer than 100 characters, or is not
            finite.

    Source:
        ros_comm@1.17.0 tools/rosparam/src/rosparam/__init__.py,
        construct_angle_radians, construct_angle_degrees; differs: only arithmetic is
        understood, in degrees too, while the original evaluates any Python.
    """
    text = text.strip()
    # Python's parser takes long for an expression of many nested parentheses.
    if len(text) > _MAX_LENGTH:
        raise ValueError(
            f"it has {len(text)} characters, and an angle may have {_MAX_LENGTH}"
        )
    degrees = text.startswith("deg(")
    if degrees or text.startswith("rad("):
        text = text[4:].removesuffix(")")
    try:
        value = _evaluate(ast.parse(text, mode="eval").body)
    except (SyntaxError, ZeroDivisionError, OverflowError) as error:
        raise ValueError(f"'{text}' is not arithmetic with numbers and pi") from error
    if not math.isfinite(value):
        raise ValueError(f"'{text}' is not finite")
    return math.radians(value) if degrees else value


def _evaluate(node: ast.expr) -> float:
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name(id="pi"):
            return math.pi
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_evaluate(operand)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
            return _OPERATIONS[type(op)](_evaluate(left), _evaluate(right))
    raise ValueError(f"'{ast.unparse(node)}' is neither a number nor pi")


KeyPath = tuple[str | int, ...]

_TAG = "tag:yaml.org,2002:"
_CONTAINERS = frozenset({f"{_TAG}map", f"{_TAG}seq"})
_AMBIGUOUS = "!ambiguous"
_MAX_DEPTH = 64
_MAX_NUMBER_LENGTH = 100
# The tags of scalars without quotes; the first pattern that matches decides.
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


class _Loader(Composer, _Parser):
    """PyYAML's parser with the scalars of this module."""

    def __init__(self, text: str) -> None:
        _Parser.__init__(self, text)
        Composer.__init__(self)

    yaml_implicit_resolvers = {  # noqa: RUF012 - the name and type are PyYAML's
        None: [
            (_AMBIGUOUS, _TWO_MEANINGS),
            *((tag, re.compile(pattern)) for tag, pattern in _PLAIN_SCALARS),
        ]
    }

    _depth = 0

    @override
    def compose_node(self, parent: yaml.Node | None, index: object) -> yaml.Node | None:
        """Return the next node; refuse it where it is nested too deep.

        The depth is checked here, before the whole text is parsed, because
        PyYAML needs seconds for some thousand open brackets.

        Raises:
            ComposerError: The text is nested too deep.
        """
        if self._depth > _MAX_DEPTH:
            problem = f"it is nested deeper than {_MAX_DEPTH} levels"
            mark: Any = getattr(self.peek_event(), "start_mark", None)
            raise ComposerError(None, None, problem, mark)
        self._depth += 1
        try:
            return super().compose_node(parent, index)  # type: ignore[arg-type]  # likewise
        finally:
            self._depth -= 1

    @override
    def resolve(
        self, kind: type[yaml.Node], value: str | None, implicit: object
    ) -> str:
        """Return the tag of a node; a pattern must match the whole plain scalar."""
        if kind is yaml.ScalarNode and isinstance(implicit, tuple) and implicit[0]:
            for tag, pattern in self.yaml_implicit_resolvers[None]:
                if pattern.fullmatch(value or ""):
                    return str(tag)
            return f"{_TAG}str"
        resolve = super().resolve
        return str(resolve(kind, value, implicit))  # type: ignore[no-untyped-call]  # PyYAML's stubs


@dataclass(frozen=True, slots=True)
class TextKind:
    """The origin of a text, which decides how much of it is read.

    Attributes:
        characters: Longest text.
        values: Most values, with every alias written out.
        remedy: Advice for a text that is refused.
    """

    characters: int
    values: int
    remedy: str


FILE = TextKind(1_000_000, 100_000, "Correct the file and start again.")
"""A file of the user who runs the program."""
FORM = TextKind(32_768, 5_000, "Correct the text.")
"""Text that somebody has typed or pasted elsewhere: a controller's parameters."""


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
        """Return `file:line:column` of the value at `path`, or of its container."""
        while path and path not in self.positions:
            path = path[:-1]
        line, column = self.positions.get(path, (1, 1))
        return f"{self.name}:{line}:{column}"


def read_yaml(path: Path) -> YamlDocument:
    """Read the YAML file at `path`.

    Raises:
        ConfigError: The file cannot be read, is not YAML, or holds something that is
            refused; the message says file, line, column and key.
    """
    try:
        with path.open(encoding="utf-8") as file:
            text = file.read(FILE.characters + 1)
    except OSError as error:
        raise ConfigError(
            [f"{path}: The file cannot be read: {error.strerror}."],
            remedy="Check the path and its permissions.",
        ) from error
    except UnicodeDecodeError as error:
        raise ConfigError(
            [f"{path}: The file is not UTF-8 from byte {error.start} on."],
            remedy="Save the file as UTF-8.",
        ) from error
    return parse_yaml(text, str(path))


def parse_yaml(text: str, name: str, kind: TextKind = FILE) -> YamlDocument:
    """Parse YAML text.

    Args:
        text: The YAML text.
        name: Name of the text in messages, in place of a file.
        kind: Kind of the text's source.

    Raises:
        ConfigError: The text is not YAML, or holds something that is refused; the
            message says file, line, column and key.
    """
    root = _compose(text, name, kind)
    if root is None:
        return YamlDocument(name, {}, {})
    builder = _Builder(name, kind)
    values = builder.build(root, ())
    if not isinstance(values, dict):
        raise ConfigError(
            [f"{name}:1:1: The file holds {show(values)}; it must hold a mapping."],
            remedy="Write `key: value` lines.",
        )
    return YamlDocument(name, values, builder.positions)


def parse_value(text: str, name: str) -> object:
    """Return the value of YAML text: a mapping, a list or a single scalar.

    Args:
        text: The YAML text.
        name: Name of the text in messages, in place of a file.

    Raises:
        ConfigError: The text is not YAML, or holds something that is refused.
    """
    root = _compose(text, name, FILE)
    return None if root is None else _Builder(name, FILE).build(root, ())


def _compose(text: str, name: str, kind: TextKind) -> yaml.Node | None:
    if len(text) > kind.characters:
        raise ConfigError(
            [
                f"{name}: The text is longer than the {kind.characters} characters "
                "allowed."
            ],
            remedy="Shorten it.",
        )
    try:
        root: yaml.Node | None = yaml.compose(text, Loader=_Loader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = f":{mark.line + 1}:{mark.column + 1}" if mark else ""
        problem = error.problem or error.context
        message = f"{name}{place}: The text is not valid YAML: {problem}."
        raise ConfigError([message], remedy=kind.remedy) from error
    except yaml.YAMLError as error:
        raise ConfigError(
            [f"{name}: The text is not valid YAML: {error}."], remedy=kind.remedy
        ) from error
    return root


class _Builder:
    """Turn PyYAML's nodes into plain data and note their positions."""

    def __init__(self, name: str, kind: TextKind) -> None:
        self.positions: dict[KeyPath, tuple[int, int]] = {}
        self._name = name
        self._kind = kind
        self._open: list[yaml.Node] = []
        self._count = 0

    def build(self, node: yaml.Node, path: KeyPath) -> object:
        """Return the data of `node`, which stands at `path`.

        Raises:
            ConfigError: Something in the node is refused.
        """
        mark = node.start_mark
        self.positions[path] = (mark.line + 1, mark.column + 1)
        if any(node is parent for parent in self._open):
            raise self._refuse(node, path, "is an alias that contains itself")
        if len(self._open) >= _MAX_DEPTH:
            raise self._refuse(node, path, f"is nested deeper than {_MAX_DEPTH} levels")
        self._count += 1
        if self._count > self._kind.values:
            raise self._refuse(
                node,
                path,
                f"makes more than {self._kind.values} values, with every alias written "
                "out",
            )
        if not _is_scalar(node) and node.tag not in _CONTAINERS:
            raise self._refuse(node, path, f"has the tag {node.tag}, which is unknown")
        self._open.append(node)
        try:
            if isinstance(node, yaml.MappingNode):
                return self._mapping(node, path)
            if isinstance(node, yaml.SequenceNode):
                return [self.build(v, (*path, i)) for i, v in enumerate(node.value)]
            return self._scalar(node, path)
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
                    key_node,
                    path,
                    f"has the key {_text(key_node)}, which is not text; put it in "
                    "quotes",
                )
            value = self.build(value_node, (*path, key))
            if key in own:
                before = own[key]
                # Files of ROS 2 begin one block of a namespace for every node.
                is_namespace = not path and key.startswith("/")
                if not (
                    is_namespace
                    and isinstance(before, dict)
                    and isinstance(value, dict)
                    and not set(before) & set(value)
                ):
                    raise self._refuse(key_node, path, f"has the key {show(key)} twice")
                value = {**before, **value}
            own[key] = value
        mark = node.start_mark
        self.positions[path] = (mark.line + 1, mark.column + 1)
        return {**merged, **own}

    def _merge(self, node: yaml.Node, path: KeyPath) -> dict[str, object]:
        nodes = node.value if isinstance(node, yaml.SequenceNode) else [node]
        merged: dict[str, object] = {}
        for part in nodes:
            value = self.build(part, path)
            if not isinstance(value, dict):
                raise self._refuse(
                    part,
                    path,
                    f"merges {show(value)} with `<<`, which takes a mapping or a list "
                    "of mappings",
                )
            merged = {**value, **merged}
        return merged

    def _scalar(self, node: yaml.Node, path: KeyPath) -> object:
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
                return self._number(kind, text, node, path)
            case "!ambiguous":
                raise self._refuse(
                    node,
                    path,
                    f"is {show(text)}, which means different things in YAML 1.1 and "
                    "1.2; write a plain decimal number, or put it in quotes if it is "
                    "text",
                )
        raise self._refuse(
            node, path, f"is {show(text)} with the tag {node.tag}, which is unknown"
        )

    def _number(
        self, kind: str, text: str, node: yaml.Node, path: KeyPath
    ) -> int | float:
        # Python refuses to read or write integers of more than 4300 digits.
        if len(text) > _MAX_NUMBER_LENGTH:
            raise self._refuse(
                node,
                path,
                f"is {show(text)}, a number of {len(text)} characters; allowed are "
                f"{_MAX_NUMBER_LENGTH}",
            )
        try:
            number = _parse_number(kind, text)
        except ValueError as error:
            raise self._refuse(
                node, path, f"is {show(text)}, which is not a number: {error}"
            ) from error
        if kind == "float" and math.isinf(number) and "inf" not in text.lower():
            raise self._refuse(
                node,
                path,
                f"is {text}, which is too large; allowed are numbers up to 1.7e308, or "
                ".inf",
            )
        return number

    def _refuse(self, node: yaml.Node, path: KeyPath, problem: str) -> ConfigError:
        mark = node.start_mark
        place = f"{self._name}:{mark.line + 1}:{mark.column + 1}"
        subject = key_text(path) or "The text"
        return ConfigError([f"{place}: {subject} {problem}."], remedy=self._kind.remedy)


def _parse_number(kind: str, text: str) -> int | float:
    match kind:
        case "int":
            return int(text, 0)
        case "float":
            return float(_INF_OR_NAN.sub(r"\1", text))
        case "!degrees":
            return parse_angle(f"deg({text})")
    return parse_angle(text)


def _is_scalar(node: yaml.Node) -> bool:
    return isinstance(node, yaml.ScalarNode)


def _text(node: yaml.Node) -> str:
    return show(node.value) if _is_scalar(node) else "(a list or mapping)"
