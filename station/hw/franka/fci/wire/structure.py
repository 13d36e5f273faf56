"""Packed little-endian structures, described by tables of their fields."""

import struct
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

Bytes: TypeAlias = bytes | bytearray | memoryview
Field: TypeAlias = tuple[str, str]
"""Name of a field and its format, e.g. `("q", "7d")`, as `struct` has it."""


def fields(*rows: str) -> list[Field]:
    """Return fields from rows such as `7d q dq`: a format, and the fields that have it.

    Args:
        rows: The rows, in the order of the fields.
    """
    words = [row.split() for row in rows]
    return [(name, form) for form, *names in words for name in names]


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
        self.size = 0
        self.offsets: dict[str, int] = {}
        self.counts: dict[str, int] = {}
        self._packers: dict[str, struct.Struct] = {}
        self._is_scalar: dict[str, bool] = {}
        for name, form in fields:
            self._packers[name] = packer = struct.Struct("<" + form)
            self._is_scalar[name] = len(form) == 1
            self.counts[name] = int(form[:-1] or 1)
            self.offsets[name] = self.size
            self.size += packer.size

    def pack(self, values: Mapping[str, Any]) -> bytes:
        """Return the structure as bytes.

        Args:
            values: A value for every field; fields that are left out are zero.

        Raises:
            KeyError: There is no field of such a name.
            ValueError: A value does not have as many numbers as its field.
            struct.error: A number does not fit into its field.
        """
        message = bytearray(self.size)
        for name, value in values.items():
            count = self.counts[name]
            numbers = [value] if self._is_scalar[name] else value
            if len(numbers) != count:
                raise ValueError(
                    f"{name} has {len(numbers)} numbers instead of {count}"
                )
            self.write(message, name, *numbers)
        return bytes(message)

    def unpack(self, data: Bytes) -> dict[str, Any]:
        """Return the values of all fields.

        Args:
            data: Bytes of the structure and nothing else.

        Raises:
            struct.error: There are more or fewer bytes than the structure has.
        """
        if len(data) != self.size:
            raise struct.error(f"{len(data)} bytes instead of {self.size}")
        values: dict[str, Any] = {}
        for name, packer in self._packers.items():
            numbers = packer.unpack_from(data, self.offsets[name])
            values[name] = numbers[0] if self._is_scalar[name] else numbers
        return values

    def write(self, message: bytearray, name: str, *numbers: float) -> None:
        """Write the numbers of one field into a message.

        Args:
            message: The message.
            name: Name of the field.
            numbers: As many numbers as the field has.
        """
        self._packers[name].pack_into(message, self.offsets[name], *numbers)

    def read(self, message: Bytes, name: str) -> tuple[Any, ...]:
        """Return the numbers of one field of a message.

        Args:
            message: The message; longer is allowed.
            name: Name of the field.
        """
        return self._packers[name].unpack_from(message, self.offsets[name])
