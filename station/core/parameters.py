"""A tree of parameters with namespaces, as rosparam has it, typed at the reading end.

The tree holds what a YAML file holds: numbers, strings, booleans, lists and mappings.
Paths are separated by `/`. A `Parameters` object is a view on one namespace; whoever
reads says which type it expects and gets an error that names the full path otherwise.
"""

import threading
from collections.abc import Callable, Mapping
from copy import deepcopy

from station.core.errors import ParameterError

ParameterListener = Callable[[str, object], None]
_MISSING = object()


def _split(path: str) -> list[str]:
    return [part for part in path.split("/") if part]


class ParameterTree:
    """The store behind all namespaces. Safe to use from any thread.

    Args:
        values: Initial content; copied.
    """

    def __init__(self, values: Mapping[str, object] | None = None) -> None:
        self._lock = threading.Lock()
        self._root: dict[str, object] = {}
        self._listeners: list[ParameterListener] = []
        for key, value in (values or {}).items():
            self._store(_split(key), deepcopy(value))

    def get(self, path: str, default: object = None) -> object:
        """Return a copy of the value at `path`, or `default` when there is none."""
        with self._lock:
            node: object = self._root
            for part in _split(path):
                if not isinstance(node, dict) or part not in node:
                    return default
                node = node[part]
            return deepcopy(node)

    def set(self, path: str, value: object) -> None:
        """Store a copy of `value` at `path` and tell the listeners.

        Namespaces on the way are made; a plain value on the way is replaced.

        Raises:
            ParameterError: `path` is empty and `value` is not a mapping.
        """
        parts = _split(path)
        if not parts and not isinstance(value, Mapping):
            raise ParameterError(
                f"The root of the parameters must be a mapping, not {value!r}.",
                remedy="Give a path such as 'controller/p'.",
            )
        with self._lock:
            if parts:
                self._store(parts, deepcopy(value))
            else:
                self._root = {str(k): deepcopy(v) for k, v in dict(value).items()}  # type: ignore[call-overload]  # checked above
        self._notify("/".join(parts), value)

    def delete(self, path: str) -> bool:
        """Remove what is at `path`; return whether there was anything."""
        parts = _split(path)
        with self._lock:
            node: object = self._root
            for part in parts[:-1]:
                node = node.get(part) if isinstance(node, dict) else None
            removed = bool(parts) and isinstance(node, dict) and parts[-1] in node
            if removed and isinstance(node, dict):
                del node[parts[-1]]
        if removed:
            self._notify("/".join(parts), None)
        return removed

    def subscribe(self, listener: ParameterListener) -> Callable[[], None]:
        """Call `listener(path, value)` after every change; return the way to stop it.

        A deleted parameter is told as None. Called in the thread of the change.
        """
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener)

    def _notify(self, path: str, value: object) -> None:
        for listener in list(self._listeners):
            listener(path, value)

    def _store(self, parts: list[str], value: object) -> None:
        node = self._root
        for part in parts[:-1]:
            child = node.get(part)
            if not isinstance(child, dict):
                child = node[part] = {}
            node = child
        node[parts[-1]] = value


class Parameters:
    """A view on one namespace of a `ParameterTree`.

    Args:
        tree: The tree; an empty one of its own when left out.
        path: The namespace.
    """

    def __init__(self, tree: ParameterTree | None = None, path: str = "") -> None:
        self.tree = ParameterTree() if tree is None else tree
        self.path = "/".join(_split(path))

    def resolve(self, key: str) -> str:
        """Return the full path of `key` in this namespace."""
        return "/".join(_split(f"{self.path}/{key}"))

    def namespace(self, key: str) -> "Parameters":
        """Return the view on the namespace `key` below this one."""
        return Parameters(self.tree, self.resolve(key))

    def get(self, key: str = "", default: object = None) -> object:
        """Return the value of `key` whatever its type, or `default`."""
        return self.tree.get(self.resolve(key), default)

    def has(self, key: str) -> bool:
        """Say whether `key` has a value."""
        return self.get(key, _MISSING) is not _MISSING

    def set(self, key: str, value: object) -> None:
        """Set `key` in this namespace."""
        self.tree.set(self.resolve(key), value)

    def keys(self) -> list[str]:
        """Return the keys of this namespace; empty when it is none."""
        value = self.get()
        return [str(key) for key in value] if isinstance(value, dict) else []

    def get_float(self, key: str, default: float | None = None) -> float:
        """Return the number at `key`; required when there is no default.

        Raises:
            ParameterError: It is missing, or not a finite number.
        """
        value = self._value(key, default)
        number = not isinstance(value, bool) and isinstance(value, (int, float))
        if not number or value - value != 0:  # type: ignore[operator]  # a number
            raise self._wrong(key, value, "a finite number")
        return float(value)  # type: ignore[arg-type]  # a number

    def get_int(self, key: str, default: int | None = None) -> int:
        """Return the integer at `key`; required when there is no default.

        Raises:
            ParameterError: It is missing, or not an integer.
        """
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self._wrong(key, value, "an integer")
        return value

    def get_bool(self, key: str, default: bool | None = None) -> bool:  # noqa: FBT001 - a default
        """Return the boolean at `key`; required when there is no default.

        Raises:
            ParameterError: It is missing, or neither true nor false.
        """
        value = self._value(key, default)
        if not isinstance(value, bool):
            raise self._wrong(key, value, "true or false")
        return value

    def get_str(self, key: str, default: str | None = None) -> str:
        """Return the string at `key`; required when there is no default.

        Raises:
            ParameterError: It is missing, or not a string.
        """
        value = self._value(key, default)
        if not isinstance(value, str):
            raise self._wrong(key, value, "a string")
        return value

    def get_str_list(self, key: str, default: list[str] | None = None) -> list[str]:
        """Return the list of strings at `key`; required when there is no default.

        Raises:
            ParameterError: It is missing, or not a list of strings.
        """
        value = self._value(key, default)
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise self._wrong(key, value, "a list of strings")
        return value

    def get_float_list(
        self, key: str, size: int | None = None, default: list[float] | None = None
    ) -> list[float]:
        """Return the list of numbers at `key`; required when there is no default.

        Args:
            key: The key.
            size: Length the list must have; any when None.
            default: Value when the key is absent.

        Raises:
            ParameterError: It is missing, not a list of finite numbers, or has
                another length.
        """
        value = self._value(key, default)
        wanted = "a list of finite numbers" if size is None else f"{size} numbers"
        if not isinstance(value, list) or (size is not None and len(value) != size):
            raise self._wrong(key, value, wanted)
        for item in value:
            number = not isinstance(item, bool) and isinstance(item, (int, float))
            if not number or item - item != 0:
                raise self._wrong(key, value, wanted)
        return [float(item) for item in value]

    def _value(self, key: str, default: object) -> object:
        value = self.get(key, default)
        if value is None:
            raise ParameterError(
                f"Parameter '{self.resolve(key)}' is missing.",
                remedy="Set it in the configuration or in the load request's params.",
                details={"parameter": self.resolve(key)},
            )
        return value

    def _wrong(self, key: str, value: object, wanted: str) -> ParameterError:
        return ParameterError(
            f"Parameter '{self.resolve(key)}' is {value!r}; it must be {wanted}.",
            remedy="Correct the value and try again.",
            details={"parameter": self.resolve(key)},
        )
