"""Control station: ros_control in Python, with a simulated robot and a web API.

`station.open` is a station inside a program; `station.client` talks to a running one;
`station.rerun` steps a recording again.
"""

import sys
from importlib import import_module
from typing import Any

from station.compiled_finder import CompiledFinder

__version__ = "0.1.0"
__all__ = ["__version__", "open"]


def __getattr__(name: str) -> Any:  # noqa: ANN401 - the stub beside this file has types
    """Return `open` or `rerun`, whose modules are imported at the first use.

    A program that only needs the client then imports no robot.

    Raises:
        AttributeError: There is no such name.
        MissingExtraError: The name needs an extra of this distribution that is missing.
    """
    try:
        if name == "open":
            return import_module("station.app.in_process").open_station
        if name == "rerun":
            return import_module("station.app.rerun").rerun
    except ModuleNotFoundError as error:
        from station.core.installation import missing_extra

        raise missing_extra(error) or error from error
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


sys.meta_path.insert(0, CompiledFinder())
