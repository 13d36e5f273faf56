"""The tree of parameters as rosparam shows it: read, set and delete, from any thread.

Controllers read their parameters when they are loaded; a later change has no effect on
them.
"""

import threading
from collections.abc import Callable, Collection

from station.core.errors import (
    ControllerExistsError,
    ParameterError,
    ParameterNotFoundError,
    suggest,
)
from station.core.parameters import Parameters

_MISSING = object()


class ParameterServer:
    """Reads and changes the parameters of a station.

    Args:
        parameters: The root of the tree.
        change_lock: Lock that is held while a controller is loaded or unloaded.
        is_loading: Returns whether a controller of a name is being loaded.
        fixed: Names at the root that cannot be changed while the station runs.
    """

    def __init__(
        self,
        parameters: Parameters,
        change_lock: threading.Lock,
        is_loading: Callable[[str], bool],
        fixed: Collection[str] = (),
    ) -> None:
        self._tree = parameters.tree
        self._change_lock = change_lock
        self._is_loading = is_loading
        self._fixed = fixed

    def get(self, path: str = "") -> object:
        """Return the value at a path; the whole tree without a path.

        Args:
            path: Names separated by `/`.

        Raises:
            ParameterNotFoundError: There is no such parameter.
        """
        value = self._tree.get(path, _MISSING)
        if value is _MISSING:
            raise self._not_found(path)
        return value

    def set(self, path: str, value: object) -> None:
        """Set the value at a path; namespaces that are missing are made.

        Args:
            path: Names separated by `/`.
            value: Plain data; a mapping replaces the whole namespace.

        Raises:
            ParameterError: The path is empty or fixed, or leads through a value that is
                not a namespace.
            ControllerExistsError: The parameters belong to a controller that is being
                loaded.
        """
        with self._change_lock:
            parts = self._changeable(path)
            for count in range(1, len(parts)):
                above = "/".join(parts[:count])
                if not isinstance(self._tree.get(above, {}), dict):
                    raise ParameterError(
                        f"Parameter '{above}' has a value, so '{path}' cannot be "
                        "below it.",
                        remedy=f"Delete '{above}' first, or choose another path.",
                        details={"parameter": above},
                    )
            self._tree.set(path, value)

    def delete(self, path: str) -> object:
        """Remove the value at a path and return it.

        Raises:
            ParameterNotFoundError: There is no such parameter.
            ParameterError: The path is empty or fixed.
            ControllerExistsError: The parameters belong to a controller that is being
                loaded.
        """
        with self._change_lock:
            self._changeable(path)
            value = self.get(path)
            self._tree.delete(path)
            return value

    def _changeable(self, path: str) -> list[str]:
        """Return the parts of a path, if it may be changed.

        Raises:
            ParameterError: The path is empty or fixed.
            ControllerExistsError: A controller is being loaded with this parameter.
        """
        parts = [part for part in path.split("/") if part]
        if not parts or parts[0] in self._fixed:
            raise ParameterError(
                f"Parameter '{path}' cannot be changed while the station runs.",
                remedy="Change it in the configuration and start the station again.",
                details={"parameter": path},
            )
        if self._is_loading(parts[0]):
            raise ControllerExistsError(
                f"Controller '{parts[0]}' is being loaded with these parameters.",
                remedy="Wait until it is loaded, or unload it to cancel.",
                details={"controller": parts[0]},
            )
        return parts

    def _not_found(self, path: str) -> ParameterNotFoundError:
        above, _, name = path.strip("/").rpartition("/")
        beside = self._tree.get(above)
        names = list(beside) if isinstance(beside, dict) else []
        return ParameterNotFoundError(
            f"There is no parameter '{path}'.",
            remedy=suggest(name, names),
            details={"parameter": path},
        )
