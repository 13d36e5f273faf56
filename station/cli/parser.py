"""The parser of the command line, which says what an unknown word may have meant."""

import argparse
from typing import Any

from typing_extensions import override

from station.core.errors import suggest


class Parser(argparse.ArgumentParser):
    """An `ArgumentParser` that answers an unknown verb or choice with the nearest."""

    @override
    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            known = [str(each) for each in action.choices]
            message = f"there is no {value!r}. {suggest(str(value), known)}"
            raise argparse.ArgumentError(action, message)
