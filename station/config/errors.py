"""What is wrong with a configuration, all of it at once."""

from collections.abc import Sequence

from station.core.errors import ParameterError


class ConfigError(ParameterError):
    """A configuration cannot be read, or holds something that is not allowed.

    Args:
        problems: One sentence each: where, which key, its value, what is allowed.
        remedy: What to do.

    Attributes:
        problems: As given.
    """

    code = "invalid_configuration"

    def __init__(self, problems: Sequence[str], *, remedy: str) -> None:
        super().__init__(
            "\n".join(problems), remedy=remedy, details={"errors": list(problems)}
        )
        self.problems = tuple(problems)
