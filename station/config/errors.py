"""The error that names everything that is wrong with a configuration, all at once."""

from collections.abc import Sequence

from station.core.errors import ParameterError

_MAX_SHOWN = 80


class ConfigError(ParameterError):
    """A configuration cannot be read, or holds something that is not allowed.

    Args:
        problems: One sentence each: where, which key, its value, what is allowed.
        remedy: What to do about them.

    Attributes:
        problems: The sentences.
    """

    code = "invalid_configuration"

    def __init__(self, problems: Sequence[str], *, remedy: str) -> None:
        super().__init__(
            "\n".join(problems), remedy=remedy, details={"errors": list(problems)}
        )
        self.problems = tuple(problems)


def show(value: object) -> str:
    """Return a value as a message shows it, shortened to 80 characters.

    Args:
        value: Any plain data.
    """
    # An integer of thousands of digits has no text: Python refuses to write it.
    if isinstance(value, int) and value.bit_length() > 4 * _MAX_SHOWN:
        return f"an integer of {value.bit_length()} bits"
    text = repr(value)
    return text if len(text) <= _MAX_SHOWN else f"{text[: _MAX_SHOWN - 1]}…"


def key_text(path: Sequence[str | int]) -> str:
    """Return the path of a key as a message names it, such as `robot.arms[0].base`.

    Args:
        path: Keys of mappings and indices of lists, from the root.
    """
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return "".join(parts).removeprefix(".")
