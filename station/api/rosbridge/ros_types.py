"""Types of ROS: definitions of messages, and checks of values against them.

Inside of this package messages have the form of ROS 2: times are `{"sec", "nanosec"}`,
a header has a stamp and a frame. A client that names a type `sensor_msgs/JointState`
gets the form of ROS 1 (`secs`, `nsecs`, a `seq` in the header). A client that names it
`sensor_msgs/msg/JointState` gets the form of ROS 2.

Source: the interfaces are those of ros_control, franka_ros@c11f000, rosapi and common
messages of ROS Noetic, in `ros_interfaces.txt`.
"""

import base64
import binascii
import struct
import sys
from collections.abc import Callable, Iterable, Mapping, ValuesView
from dataclasses import fields, is_dataclass
from functools import cache, partial
from importlib.resources import files
from typing import Any, NoReturn, TypeGuard

from typing_extensions import override

from station.core.errors import StationError, counted, suggest
from station.records.cdr import Field, Values, Writer, read_fields
from station.records.messages import header

_SEPARATOR = "=" * 80 + "\n"
_TIMES = ("time", "duration")
_SIZES = (8, 16, 32, 64)
_INTEGERS = {f"uint{n}": (0, 2**n - 1) for n in _SIZES}
_INTEGERS |= {f"int{n}": (-(2 ** (n - 1)), 2 ** (n - 1) - 1) for n in _SIZES}
_FLOATS = {"float32": 3.4e38, "float64": sys.float_info.max}
_WORDS = {"string": (str, "a text"), "bool": (bool, "true or false")}
_MOST_DEPTH = 30
"""Most nested levels of a message whose type only clients know."""
_MIDDLES = {"msg", "srv", "action"}
_HEADER = "std_msgs/Header"
_NOW = "now"
"""What clients may write for a time; it is 0, which is now for the station."""
_ACTION_HEAD = "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n"


class RosTypeError(StationError, ValueError):
    """A type is unknown, or a value does not fit the type of its field."""

    code = "wrong_message"


class RosType:
    """A message type.

    Args:
        name: Name in the style of ROS 1, e.g. `sensor_msgs/JointState`.
        text: Its definition.

    Attributes:
        name: As given.
        fields: The fields in their order.
        constants: Values of the constants by name.
    """

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.fields = read_fields(text)
        lines = (line.split(maxsplit=1)[1] for line in text.splitlines() if "=" in line)
        self.constants = dict(line.split("=", 1) for line in lines)


def _read_all() -> tuple[dict[str, RosType], list[str]]:
    """Return the message types by name, and the names of all interfaces in ROS 2."""
    types: dict[str, RosType] = {}
    interfaces: list[str] = []
    text = files(__package__).joinpath("ros_interfaces.txt").read_text("utf-8")
    for section in text.split(_SEPARATOR)[1:]:
        title, _, body = section.partition("\n")
        kind, _, name = title.partition(": ")
        interfaces.append(name.replace("/", f"/{kind.lower()}/"))
        parts = dict(zip(_PARTS[kind], body.split("---\n"), strict=True))
        if kind == "ACTION":
            id_head = "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n"
            parts["ActionGoal"] = f"{id_head}{name}Goal goal\n"
            parts["ActionResult"] = f"{_ACTION_HEAD}{name}Result result\n"
            parts["ActionFeedback"] = f"{_ACTION_HEAD}{name}Feedback feedback\n"
        for suffix, part in parts.items():
            types[name + suffix] = RosType(name + suffix, part)
    return types, interfaces


_PARTS = {
    "MSG": ("",),
    "SRV": ("Request", "Response"),
    "ACTION": ("Goal", "Result", "Feedback"),
}
_TYPES, INTERFACES = _read_all()


# Names of packages that differ in ROS 2.
_RENAMED = (
    ("rosapi_msgs/", "rosapi/"),
    ("tf2_web_republisher_interfaces/", "tf2_web_republisher/"),
)


def split_style(name: str) -> tuple[str, bool]:
    """Return a type's name in ROS 1, and whether it was written in ROS 2's style."""
    for long, short in _RENAMED:
        name = name.replace(long, short)
    package, *middle = name.split("/")
    is_ros2 = len(middle) == 2 and middle[0] in _MIDDLES
    return f"{package}/{middle[1]}" if is_ros2 else name, is_ros2


def find_type(name: str) -> RosType:
    """Return a message type by its name in ROS 1 or ROS 2.

    Raises:
        RosTypeError: The type is unknown.
    """
    found = _TYPES.get(split_style(name)[0])
    if found is None:
        raise RosTypeError(
            f"There is no type '{name:.80}'.", remedy=suggest(name, _TYPES)
        )
    return found


def type_named(package: str, name: str) -> str:
    """Return the type with the name of a service, e.g. LoadController."""
    words = (word[0].upper() + word[1:] for word in name.split("_"))
    return f"{package}/{''.join(words)}"


def fields_of(type_name: str) -> dict[str, Field]:
    """Return a type's fields by name in their order; empty for types of clients."""
    known = _TYPES.get(type_name)
    return {} if known is None else {field.name: field for field in known.fields}


def checked(type_name: str, values: object, where: str = "msg") -> Values:
    """Return a client's message, with defaults for absent fields.

    Args:
        type_name: Type of the message in ROS 1's style. A message of a type that only
            clients know is returned as it is.
        values: The message of the client.
        where: Name of the message in refusals.

    Raises:
        RosTypeError: A field is unknown, or its value does not fit; the message names
            it.
    """
    if values is None:
        values = {}
    if not isinstance(values, Mapping):
        _refuse(where, values, f"a {type_name}")
    kind = _TYPES.get(type_name)
    if kind is None:
        _check_depth(values, where)
        return dict(values)
    names = [field.name for field in kind.fields]
    unknown = next((key for key in values if key not in names), None)
    if unknown is not None:
        raise RosTypeError(
            f"'{where}' has no field '{unknown!s:.60}'; it is a {kind.name}.",
            remedy=suggest(str(unknown), names),
        )
    return {
        field.name: _checked_field(field, values[field.name], f"{where}/{field.name}")
        if field.name in values
        else _default(field.kind, field.length)
        for field in kind.fields
        # Drop the `seq` of a header: ROS 2 has none, and for ROS 1 a new one is made.
        if kind.name != _HEADER or field.name != "seq"
    }


def with_time(type_name: str, given: object, values: Values, now: int) -> Values:
    """Return a checked message whose header has a time.

    Args:
        type_name: Its type.
        given: The message as the client sent it, perhaps without a time.
        values: The checked message.
        now: The present time [ns since 1970].
    """
    if fields_of(type_name).get("header") != Field("header", _HEADER, None):
        return values
    head = given.get("header") if isinstance(given, Mapping) else None
    if (head or {}).get("stamp", _NOW) != _NOW:
        return values
    return values | {"header": values["header"] | {"stamp": time_of(now)}}


def _check_depth(value: object, where: str, left: int = _MOST_DEPTH) -> None:
    """Refuse a value that is nested too deeply to be written.

    Raises:
        RosTypeError: The value is nested too deeply.
    """
    if left == 0:
        raise RosTypeError(f"'{where}' has more than {_MOST_DEPTH} levels.")
    found = value.values() if isinstance(value, Mapping) else value
    for one in found if isinstance(found, list | ValuesView) else ():
        _check_depth(one, where, left - 1)


def _checked_field(field: Field, value: object, where: str) -> object:
    if field.length is None:
        return _checked_one(field.kind, value, where)
    if field.kind == "uint8" and isinstance(value, str):
        try:
            # Base64 of e-mails has line ends.
            value = list(base64.b64decode("".join(value.split()), validate=True))
        except binascii.Error:
            _refuse(where, value, "base64")
    if not isinstance(value, list):
        _refuse(where, value, f"a list of {field.kind}")
    if field.length not in {-1, len(value)}:
        raise RosTypeError(
            f"'{where}' has {counted(len(value), 'value')}; it must have "
            f"{field.length}."
        )
    found = [
        _checked_one(field.kind, one, f"{where}/{index}")
        for index, one in enumerate(value)
    ]
    return _array(field.kind, found)


def _array(kind: str, values: list[Any]) -> object:
    """Return an array; that of uint8 as bytes, which JSON has as base64."""
    return bytes(values) if kind == "uint8" else values


def _checked_one(kind: str, value: object, where: str) -> object:
    """Return a checked single value.

    Raises:
        RosTypeError: The value does not fit its type.
    """
    if kind in _TIMES:
        return _checked_time(kind, value, where)
    if kind in _INTEGERS:
        return _checked_integer(kind, value, where)
    if kind in _FLOATS:
        # The comparison is false for NaN.
        if not (_is_number(value) and abs(value) <= _FLOATS[kind]):
            _refuse(where, value, f"a number ({kind})")
        return float(value)
    if kind in _WORDS:
        python, wanted = _WORDS[kind]
        if not isinstance(value, python):
            _refuse(where, value, wanted)
        return value
    return checked(kind, value, where)


def _is_number(value: object) -> TypeGuard[int | float]:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _checked_integer(kind: str, value: object, where: str) -> int:
    # Headers of roslibpy have the `seq` null.
    if value is None:
        return 0
    low, high = _INTEGERS[kind]
    # The remainder of what is not finite is not a number.
    if not _is_number(value) or value % 1 != 0:
        _refuse(where, value, f"a whole number ({kind})")
    if not low <= value <= high:
        _refuse(where, value, f"{low} to {high} ({kind})")
    return int(value)


def _checked_time(kind: str, value: object, where: str) -> Values:
    """Return a time or a duration from its form in ROS 1 or ROS 2.

    Raises:
        RosTypeError: The value is not a time.
    """
    given = {} if value is None or value == _NOW else value
    if not isinstance(given, Mapping) or given.keys() - {
        "secs", "nsecs", "sec", "nanosec",
    }:  # fmt: skip
        _refuse(where, value, f"a {kind}: secs and nsecs, sec and nanosec, or '{_NOW}'")
    seconds, rest = (
        _checked_integer("int32", given.get(ros1, given.get(ros2)), f"{where}/{ros1}")
        for ros1, ros2 in (("secs", "sec"), ("nsecs", "nanosec"))
    )
    found = time_of(seconds * 1_000_000_000 + rest)
    least, most = 0 if kind == "time" else _INTEGERS["int32"][0], _INTEGERS["int32"][1]
    if not least <= found["sec"] <= most:
        _refuse(f"{where}/secs", seconds, f"{least} to {most}")
    return found


def _refuse(where: str, value: object, wanted: str) -> NoReturn:
    """Raise the error of a value that does not fit.

    Raises:
        RosTypeError: Always.
    """
    raise RosTypeError(f"'{where}' is {_shown(value)}; it must be {wanted}.")


def _shown(value: object) -> str:
    # `repr` raises an error for deeply nested lists and for numbers of thousands of
    # digits.
    if isinstance(value, list | Mapping) or (
        isinstance(value, int) and abs(value) > 2**64
    ):
        return {list: "a list", int: "a huge number"}.get(type(value), "an object")
    return repr(value)[:60]


def _default(kind: str, length: int | None = None) -> object:
    if length is not None:
        return _array(kind, [_default(kind) for _ in range(max(length, 0))])
    if kind in _TIMES:
        return time_of(0)
    if kind in _TYPES:
        return checked(kind, {})
    return {"string": "", "bool": False, "float32": 0.0, "float64": 0.0}.get(kind, 0)


def filled(type_name: str, source: Mapping[str, Any], stamp: int = 0) -> Values:
    """Return a message filled with the values of a report of the same names.

    In the report, a vector or quaternion may be a list, and flags may be the list of
    the names that are true. A nested message without a value of its own in the report
    is filled from the whole report; a list of messages may be a list of dataclasses.

    Args:
        type_name: Type of the message.
        source: The report.
        stamp: Time for its header [ns since 1970].
    """
    message: Values = {}
    for field in _TYPES[type_name].fields:
        kind, value = field.kind, source.get(field.name)
        if kind == _HEADER:
            value = header(stamp, source.get("frame_id", ""))
        elif kind in _TYPES and field.length is None:
            value = filled(
                kind, _named(kind, source if value is None else value), stamp
            )
        elif value is None:
            value = _default(kind, field.length)
        elif kind in _TIMES and isinstance(value, float):
            value = time_of(round(value * 1e9))
        elif kind in _TYPES:
            value = [
                filled(kind, facts_of(one), stamp) if is_dataclass(one) else one
                for one in value
            ]
        message[field.name] = value
    return message


def _named(
    type_name: str, values: Mapping[str, Any] | list[Any] | tuple[Any, ...]
) -> Mapping[str, Any]:
    """Return the values of a message by name; in a report, they may be in a list."""
    if isinstance(values, Mapping):
        return values
    names = [field.name for field in _TYPES[type_name].fields]
    if all(isinstance(one, str) for one in values):
        return {name: name in values for name in names}
    return dict(zip(names, values, strict=False))


def facts_of(report: Any) -> dict[str, Any]:  # noqa: ANN401 - a dataclass
    """Return the fields of a report, which is a dataclass, by name."""
    return {one.name: getattr(report, one.name) for one in fields(report)}


def time_of(nanoseconds: int) -> dict[str, int]:
    """Return a time or a duration as a message of ROS 2."""
    seconds, rest = divmod(nanoseconds, 1_000_000_000)
    return {"sec": seconds, "nanosec": rest}


Convert = Callable[[Any], Any]
"""Function that returns the new value of a field."""
Change = Callable[[Field], Convert | None]
"""Function that returns how the values of a field change; None if they do not."""


def changed(type_name: str, change: Change, message: Values) -> Values:
    """Return a message with a change made to its fields, and to messages in it.

    Args:
        type_name: Its type; messages of types of clients do not change.
        change: The change.
        message: The message.
    """
    if type_name not in _TYPES:
        return message
    functions = _functions(type_name, change).items()
    return message | {name: convert(message.get(name)) for name, convert in functions}


@cache
def _functions(type_name: str, change: Change) -> dict[str, Convert]:
    """Return the functions that change the fields of a type, by name."""
    found: dict[str, Convert] = {}
    for field in _TYPES[type_name].fields:
        convert = change(field)
        if field.kind in _TYPES and _functions(field.kind, change):
            inner = partial(changed, field.kind, change)
            convert = inner if field.length is None else partial(_each, inner)
        if convert is not None:
            found[field.name] = convert
    return found


def _each(convert: Convert, values: Iterable[Any]) -> list[Any]:
    return [convert(one) for one in values]


def in_style(type_name: str, message: Values, *, ros2: bool) -> Values:
    """Return a message in the form of ROS 2 or of ROS 1."""
    return message if ros2 else changed(type_name, _as_ros1, message)


def _as_ros1(field: Field) -> Convert | None:
    if field.kind in _TIMES:
        return lambda time: {"secs": time["sec"], "nsecs": time["nanosec"]}
    # Only headers have a `seq`.
    return (lambda seq: seq or 0) if field.name == "seq" else None


def serialized(type_name: str, message: Values, *, ros2: bool) -> bytes:
    """Return a message as bytes: CDR for ROS 2, or in the encoding of ROS 1.

    Raises:
        struct.error: A value does not fit its field.
    """
    writer = Writer() if ros2 else _Ros1Writer()
    styled = in_style(type_name, message, ros2=ros2)
    fields_of_kind = partial(_fields_in_style, ros2=ros2)
    writer.put_fields(fields_of_kind(type_name), styled, fields_of_kind)
    return bytes(writer.data)


class _Ros1Writer(Writer):
    """Appends values in the encoding of ROS 1: without gaps, and texts without a zero.

    Source: roscpp_serialization, serialization.h.
    """

    text_end = b""

    def __init__(self) -> None:
        self.data = bytearray()

    @override
    def put(self, code: str, value: float) -> None:
        self.data += struct.pack(f"<{code}", value)


@cache
def _fields_in_style(kind: str, *, ros2: bool) -> tuple[Field, ...]:
    """Return the fields of a type, which differ between ROS 1 and ROS 2."""
    if kind in _TIMES:
        seconds, rest = ("sec", "nanosec") if ros2 else ("secs", "nsecs")
        return read_fields(f"int32 {seconds}\nuint32 {rest}")
    # Headers of ROS 2 have no `seq`.
    return tuple(f for f in _TYPES[kind].fields if not ros2 or f.name != "seq")


def _parts_of(type_name: str) -> list[str]:
    """Return the types that a type contains, each once."""
    found: dict[str, None] = {}
    for field in _TYPES[type_name].fields:
        if field.kind in _TYPES:
            found |= dict.fromkeys([field.kind, *_parts_of(field.kind)])
    return list(found)


def type_definitions(type_name: str) -> list[Values]:
    """Return a type and the types that it contains as `rosapi/TypeDef`.

    Raises:
        RosTypeError: The type is unknown.
    """
    first = find_type(type_name)
    kinds = [first, *(_TYPES[name] for name in _parts_of(first.name))]
    return [
        {
            "type": kind.name,
            "fieldnames": [field.name for field in kind.fields],
            "fieldtypes": [field.kind for field in kind.fields],
            # rosapi's numbers: -1 for one value, 0 for a list of any length.
            "fieldarraylen": [
                -1 if field.length is None else max(field.length, 0)
                for field in kind.fields
            ],
            "examples": [
                str([] if field.length is not None else _default(field.kind))
                if field.kind not in _TYPES
                else "{}"
                for field in kind.fields
            ],
            "constnames": list(kind.constants),
            "constvalues": list(kind.constants.values()),
        }
        for kind in kinds
    ]
