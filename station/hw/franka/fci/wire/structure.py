"""Packed little-endian structures, described by tables of their fields."""

import struct
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

Field: TypeAlias = tuple[str, str]
"""Name of a field and its format, e.g. `("q", "7d")`, as `struct` has it."""


def fields(*rows: str) -> list[Field]:
    """Return fields from rows such as `7d q dq`: a format, and the fields that have it.

    Args:
        rows: The rows, in the order of the fields.
    """
    words = [row.split() for row in rows]
    return [(name, form) for form, *names in words for name in names]


_SIZES = {"?": 1, "B": 1, "H": 2, "I": 4, "i": 4, "Q": 8, "f": 4, "d": 8}


class Structure:
    """A packed structure: fields one after the other, little-endian, without gaps.

    A field of one number is a number, a field of several numbers is a tuple.

    Args:
        fields: The fields in their order.

    Attributes:
        size: Size of the structure [bytes].
        offsets: Offset of each field [bytes].
        counts: How many numbers each field has.
    """

    def __init__(self, fields: Sequence[Field]) -> None:
        self.offsets: dict[str, int] = {}
        self.counts: dict[str, int] = {}
        self._is_scalar: dict[str, bool] = {}
        self._packers: dict[str, struct.Struct] = {}
        size = 0
        for name, form in fields:
            count, kind = int(form[:-1] or 1), form[-1]
            self.offsets[name], self.counts[name] = size, count
            self._is_scalar[name] = len(form) == 1
            self._packers[name] = struct.Struct("<" + form)
            size += count * _SIZES[kind]
        self._packer = struct.Struct("<" + "".join(form for _, form in fields))
        self.size = size

    def pack(self, values: Mapping[str, Any]) -> bytes:
        """Return the structure as bytes.

        Args:
            values: A value for every field; fields that are left out are zero.

        Raises:
            KeyError: There is no field of such a name.
            ValueError: A value does not have as many numbers as its field.
            struct.error: A number does not fit into its field.
        """
        for name in values:
            if name not in self.offsets:
                raise KeyError(name)
        flat: list[Any] = []
        for name, count in self.counts.items():
            value = values.get(name, 0 if self._is_scalar[name] else (0,) * count)
            numbers = [value] if self._is_scalar[name] else list(value)
            if len(numbers) != count:
                raise ValueError(
                    f"{name} has {len(numbers)} numbers instead of {count}"
                )
            flat += numbers
        return self._packer.pack(*flat)

    def unpack(self, data: bytes | bytearray | memoryview) -> dict[str, Any]:
        """Return the values of all fields.

        Args:
            data: Bytes of the structure and nothing else.

        Raises:
            struct.error: There are more or fewer bytes than the structure has.
        """
        flat = self._packer.unpack(data)
        values: dict[str, Any] = {}
        start = 0
        for name, count in self.counts.items():
            numbers = flat[start : start + count]
            values[name] = numbers[0] if self._is_scalar[name] else numbers
            start += count
        return values

    def write(self, message: bytearray, name: str, *numbers: float) -> None:
        """Write the numbers of one field into a message.

        Args:
            message: The message.
            name: Name of the field.
            numbers: As many numbers as the field has.
        """
        self._packers[name].pack_into(message, self.offsets[name], *numbers)

    def read(self, message: bytearray, name: str) -> tuple[Any, ...]:
        """Return the numbers of one field of a message.

        Args:
            message: The message; longer is allowed.
            name: Name of the field.
        """
        return self._packers[name].unpack_from(message, self.offsets[name])
