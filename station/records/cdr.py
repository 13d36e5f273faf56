"""CDR, the encoding of ROS 2 messages, for the message types of a recording.

A `MessageType` is read from the text of a ROS 2 message definition. It encodes and
decodes any message of the type, field by field. A `Layout` encodes messages whose texts
and lengths do not change in one call of `struct`, which is quick enough for every
cycle.

Source: OMG CORBA 3.0, chapter 15.3 (CDR), little-endian as in ROS 2's DDS: four bytes
of encapsulation, then every primitive aligned to its own size.
"""

import re
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

Values = dict[str, Any]
"""A message: values by field; a message inside of it has the same form."""

# Version 1 of CDR, little-endian; alignment counts from the byte after these four.
_ENCAPSULATION = b"\x00\x01\x00\x00"
PRIMITIVES = {
    "bool": "?",
    "int8": "b",
    "uint8": "B",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
_FIELD = re.compile(r"([\w/]+)(\[\d*\])? +(\w+)(?: *#.*)?")
_SEPARATOR = "=" * 80
_DOUBLE = 8


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message.

    Attributes:
        name: Its name.
        kind: A primitive, `string`, or the name of a message type.
        length: Number of elements of an array; None for a single value, and -1 for
            an array of any length.
    """

    name: str
    kind: str
    length: int | None


class MessageType:
    """A message type, read from its definition.

    Args:
        name: Name with package, e.g. `sensor_msgs/msg/JointState`.
        text: The definition in MCAP's encoding `ros2msg`: the fields of the type, then
            the fields of every type that it contains, each after a line of 80 `=` and a
            line `MSG: name`.

    Attributes:
        name: As given.
        text: As given.
        fields: The fields in their order.

    Raises:
        ValueError: A line of the definition does not define a field.
    """

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.text = text
        own, *others = text.split(f"{_SEPARATOR}\nMSG: ")
        self.fields = read_fields(own)
        self._types = {}
        for other in others:
            title, _, body = other.partition("\n")
            self._types[title.strip()] = read_fields(body)

    def encode(self, message: Values) -> bytes:
        """Return a message as CDR.

        Args:
            message: A value for every field.

        Raises:
            KeyError: A field has no value.
            struct.error: A value does not fit its field.
        """
        writer = Writer()
        writer.put_fields(self.fields, message, self._types.__getitem__)
        return bytes(writer.data)

    def decode(self, data: bytes) -> Values:
        """Return the message in CDR data; arrays of doubles are lists of floats.

        Raises:
            struct.error: The data end too early.
        """
        return self._read(_Reader(data), self.fields)

    def of(self, kind: str) -> tuple[Field, ...] | None:
        """Return the fields of a message type inside of this type; None for others."""
        return self._types.get(kind)

    def _read(self, reader: "_Reader", fields: Sequence[Field]) -> Values:
        message: Values = {}
        for field in fields:
            if field.length is None:
                message[field.name] = self._read_one(reader, field.kind)
                continue
            size = reader.take("I") if field.length < 0 else field.length
            if field.kind == "float64":
                message[field.name] = reader.take_doubles(size)
            else:
                message[field.name] = [
                    self._read_one(reader, field.kind) for _ in range(size)
                ]
        return message

    def _read_one(self, reader: "_Reader", kind: str) -> Any:  # noqa: ANN401 - as its field
        if kind in PRIMITIVES:
            return reader.take(PRIMITIVES[kind])
        if kind == "string":
            return reader.take_text()
        return self._read(reader, self._types[kind])


class Layout:
    """Encodes messages of one type whose texts and array lengths are constant.

    `pack` takes the other values in the order of the fields: a number for every single
    primitive, and for every array of doubles its memory as bytes. Their byte order is
    the machine's, which is little-endian wherever a station runs.

    Args:
        kind: The message type.
        constants: Values of fields with a text or a list of texts, by name; `frame_id`
            of a header is such a field.
        lengths: Number of elements of every array of doubles without a fixed length.
    """

    def __init__(
        self,
        kind: MessageType,
        constants: Mapping[str, str | Sequence[str]],
        lengths: Mapping[str, int],
    ) -> None:
        self._pieces: list[bytes | str] = []
        self._at = 0
        self._kind = kind
        self._constants = constants
        self._lengths = lengths
        self._add_fields(kind.fields)
        self._compile()

    def _add_fields(self, fields: Sequence[Field]) -> None:
        for field in fields:
            constant = self._constants.get(field.name)
            if constant is not None:
                self._add_constant(field, constant)
            elif field.length is not None:
                self._add_array(field)
            elif field.kind in PRIMITIVES:
                code = PRIMITIVES[field.kind]
                self._align(struct.calcsize(code))
                self._add(code)
            else:
                inner = self._kind.of(field.kind)
                if inner is None:
                    raise ValueError(f"The text '{field.name}' is not settled.")
                self._add_fields(inner)

    def _add_constant(self, field: Field, constant: str | Sequence[str]) -> None:
        texts = [constant] if isinstance(constant, str) else constant
        if field.length is not None:
            self._align(4)
            self._add(struct.pack("<I", len(texts)))
        for text in texts:
            data = text.encode() + b"\0"
            self._align(4)
            self._add(struct.pack("<I", len(data)) + data)

    def _add_array(self, field: Field) -> None:
        size = field.length if field.length is not None else -1
        if size < 0:
            size = self._lengths[field.name]
            self._align(4)
            self._add(struct.pack("<I", size))
        if field.kind == "float64":
            if size:
                self._align(_DOUBLE)
            self._add(f"{_DOUBLE * size}s")
            return
        code = PRIMITIVES[field.kind]
        for _ in range(size):
            self._align(struct.calcsize(code))
            self._add(code)

    def _align(self, size: int) -> None:
        gap = -self._at % size
        if gap:
            self._add(b"\0" * gap)

    def _add(self, piece: bytes | str) -> None:
        self._at += len(piece) if isinstance(piece, bytes) else struct.calcsize(piece)
        self._pieces.append(piece)

    def _compile(self) -> None:
        """Join neighbouring constants, so that `pack` needs one call of `struct`."""
        codes, constants = "<", {0: _ENCAPSULATION}
        index, was_constant = 1, True
        for piece in self._pieces:
            if isinstance(piece, str):
                if was_constant:
                    codes += f"{len(constants[index - 1])}s"
                codes += piece
                index += 1
                was_constant = False
            elif was_constant:
                constants[index - 1] += piece
            else:
                constants[index] = piece
                index += 1
                was_constant = True
        if was_constant:
            codes += f"{len(constants[index - 1])}s"
        self._pack = struct.Struct(codes).pack
        self._fixed = tuple(constants.items())

    def pack(self, *values: float | bytes) -> bytes:
        """Return a message as CDR.

        Args:
            values: Values that are not constant, in the order of the fields.

        Raises:
            struct.error: There are too many or too few values.
        """
        row: list[float | bytes] = [*values]
        for index, constant in self._fixed:
            row.insert(index, constant)
        return self._pack(*row)


class Form:
    """The places of the numbers in messages that have the texts and lengths of `data`.

    Reading with a form is one call of `struct`, and skips unwanted fields.

    Args:
        kind: The message type.
        data: A message as CDR; it defines the form.

    Attributes:
        names: Field and element of each number, in their order. The name of an element
            is the text with the same index in the field `name`, or else the index. Of
            the messages inside, only `header` is read.

    Raises:
        struct.error: The data end too early.
    """

    def __init__(self, kind: MessageType, data: bytes) -> None:
        self.names: list[tuple[str, str | None]] = []
        self._size = len(data)
        self._codes: list[tuple[int, str]] = []
        self._texts: list[tuple[int, int, bytes]] = []
        self._kind = kind
        self._elements: list[str] = []
        reader = _Reader(data)
        self._add_fields(reader, kind.fields, "")

    def fits(self, data: bytes) -> bool:
        """Return whether a message has this form."""
        # Compare the length first, which is cheap: messages of another form mostly
        # differ in it.
        if len(data) != self._size:
            return False
        return all(data[begin:end] == text for begin, end, text in self._texts)

    def reader(self, wanted: Sequence[int]) -> Callable[[bytes], tuple[float, ...]]:
        """Return a function that reads some of the numbers in messages of this form.

        Args:
            wanted: Indices into `names`, increasing.
        """
        format_, at = "<", 0
        for place in wanted:
            begin, code = self._codes[place]
            format_ += f"{begin - at}x{code}"
            at = begin + struct.calcsize(f"<{code}")
        return struct.Struct(f"{format_}{self._size - at}x").unpack

    def _add_fields(
        self, reader: "_Reader", fields: Sequence[Field], prefix: str
    ) -> None:
        for field in fields:
            name = prefix + field.name
            begin = reader.at
            size = field.length
            if size is not None and size < 0:
                size = int(reader.take("I"))
            self._add_text(begin, reader)
            if field.kind in PRIMITIVES:
                self._add_numbers(reader, field, name, size)
                continue
            begin, count = reader.at, 1 if size is None else size
            if field.kind == "string":
                texts = [reader.take_text() for _ in range(count)]
                if name == "name":
                    self._elements = texts
                self._add_text(begin, reader)
            elif name == "header" or prefix.startswith("header/"):
                inner = self._kind.of(field.kind) or ()
                self._add_fields(reader, inner, f"{name}/")
            else:
                for _ in range(count):
                    reader.skip(self._kind, self._kind.of(field.kind) or ())

    def _add_numbers(
        self, reader: "_Reader", field: Field, name: str, size: int | None
    ) -> None:
        code = PRIMITIVES[field.kind]
        elements: Sequence[str | None] = [None]
        if size is not None:
            is_named = len(self._elements) == size
            elements = self._elements if is_named else [*map(str, range(size))]
        for element in elements:
            end = reader.pass_over(code)
            self._codes.append((end - struct.calcsize(f"<{code}"), code))
            self.names.append((name, element))

    def _add_text(self, begin: int, reader: "_Reader") -> None:
        """Note that these bytes are the same in all messages of the form."""
        end = reader.at
        if begin == end:
            return
        # Adjacent texts are compared as one.
        if self._texts and self._texts[-1][1] == begin:
            begin = self._texts.pop()[0]
        self._texts.append((begin, end, bytes(reader.data[begin:end])))


class Writer:
    """Appends the values of a message as CDR; a subclass may have another encoding.

    Attributes:
        data: The message so far.
        text_end: Byte behind a text, which its length counts.
    """

    text_end: ClassVar[bytes] = b"\0"

    def __init__(self) -> None:
        self.data = bytearray(_ENCAPSULATION)

    def put(self, code: str, value: float) -> None:
        """Append a number, given its code for `struct`."""
        size = struct.calcsize(code)
        self.data += b"\0" * (-(len(self.data) - 4) % size)
        self.data += struct.pack(f"<{code}", value)

    def put_text(self, text: str) -> None:
        """Append a text."""
        data = text.encode() + self.text_end
        self.put("I", len(data))
        self.data += data

    def put_fields(
        self,
        fields: Sequence[Field],
        message: Values,
        fields_of: Callable[[str], Sequence[Field]],
    ) -> None:
        """Append the fields of a message.

        Args:
            fields: The fields.
            message: A value for every field.
            fields_of: Returns the fields of a message type inside of the message.

        Raises:
            KeyError: A field has no value.
            ValueError: An array has another number of elements than its field.
            struct.error: A value does not fit its field.
        """
        for field in fields:
            value = message[field.name]
            if field.length is None:
                self._put_one(field.kind, value, fields_of)
                continue
            if field.length < 0:
                self.put("I", len(value))
            elif len(value) != field.length:
                raise ValueError(f"'{field.name}' has {len(value)} elements.")
            if isinstance(value, bytes):
                self.data += value
                continue
            for one in value:
                self._put_one(field.kind, one, fields_of)

    def _put_one(
        self,
        kind: str,
        value: Any,  # noqa: ANN401 - as its field
        fields_of: Callable[[str], Sequence[Field]],
    ) -> None:
        if kind in PRIMITIVES:
            self.put(PRIMITIVES[kind], value)
        elif kind == "string":
            self.put_text(value)
        else:
            self.put_fields(fields_of(kind), value, fields_of)


class _Reader:
    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 4

    def take(self, code: str) -> Any:  # noqa: ANN401 - what the code says
        size = struct.calcsize(code)
        self.at += -(self.at - 4) % size
        (value,) = struct.unpack_from(f"<{code}", self.data, self.at)
        self.at += size
        return value

    def take_doubles(self, size: int) -> list[float]:
        # An empty array has no elements to align.
        if not size:
            return []
        self.at += -(self.at - 4) % _DOUBLE
        values = struct.unpack_from(f"<{size}d", self.data, self.at)
        self.at += _DOUBLE * size
        return [*values]

    def take_text(self) -> str:
        size = self.take("I")
        # The length counts the zero at the end, which is no part of the text.
        text = self.data[self.at : self.at + size - 1]
        self.at += size
        return bytes(text).decode()

    def pass_over(self, code: str) -> int:
        """Skip a number; return the offset of its end.

        Raises:
            struct.error: The data end too early.
        """
        size = struct.calcsize(code)
        self.at += -(self.at - 4) % size + size
        # A damaged length must not read beyond the message.
        if self.at > len(self.data):
            raise struct.error("the message ends too early")
        return self.at

    def skip(self, kind: MessageType, fields: Sequence[Field]) -> None:
        """Skip a message that lies inside of another one."""
        for field in fields:
            count = 1 if field.length is None else field.length
            if count < 0:
                count = int(self.take("I"))
            for _ in range(count):
                if field.kind in PRIMITIVES:
                    self.pass_over(PRIMITIVES[field.kind])
                elif field.kind == "string":
                    self.take_text()
                else:
                    self.skip(kind, kind.of(field.kind) or ())


def read_fields(text: str) -> tuple[Field, ...]:
    """Return the fields in a definition; constants and comments are left out.

    Raises:
        ValueError: A line is not a field, a constant or a comment.
    """
    fields = []
    for line in map(str.strip, text.splitlines()):
        # A line with `=` is a constant, which no message carries.
        if not line or line.startswith("#") or "=" in line:
            continue
        found = _FIELD.fullmatch(line)
        if found is None:
            raise ValueError(f"{line!r} is no field of a message.")
        kind, array, name = found.groups()
        # -1 stands for an array whose length the message tells.
        length = None if array is None else int(array[1:-1] or -1)
        fields.append(Field(name, kind, length))
    return tuple(fields)
