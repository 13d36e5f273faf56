"""The error that names everything that is wrong with a configuration, all at once."""

from collections.abc import Sequence

from station.core.errors import ParameterError


class ConfigError(ParameterError):
    """A configuration cannot be read, or holds something that is not allowed.

    Args:
        problems: One sentence each: where, which key, its value, what is allowed.
        remedy: Advice to the user.

    Attributes:
        problems: The sentences.
    """

    code = "invalid_configuration"

    def __init__(self, problems: Sequence[str], *, remedy: str) -> None:
        super().__init__(
            "\n".join(problems), remedy=remedy, details={"errors": list(problems)}
        )
        self.problems = tuple(problems)


def key_text(path: Sequence[str | int]) -> str:
    """Return the path of a key as a message names it, such as `robot.arms[0].base`.

    Args:
        path: Keys of mappings and indices of lists, from the root.
    """
    parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return "".join(parts).removeprefix(".")
