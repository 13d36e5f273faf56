"""A tree of parameters with namespaces, like that of rosparam.

The tree holds the data of a YAML file: numbers, strings, booleans, lists and mappings.
The parts of a path are separated by `/`. A key that has a `/` itself, such as the name
of a joint, is found by that path, too. A `Parameters` object is a view on one
namespace. Its methods read a value of a given type, and raise an error with the full
path if the value has another type.
"""

import threading
from collections.abc import Callable, Collection, Mapping
from copy import deepcopy

from station.core.errors import ParameterError, show, suggest

ParameterListener = Callable[[str, object], None]
_MISSING = object()


def _split(path: str) -> list[str]:
    return [part for part in path.split("/") if part]


def _locate(node: object, parts: list[str]) -> tuple[dict[str, object], str] | None:
    """Return the mapping and the key of the value at a path; None without a value.

    Where keys overlap the shortest one wins, e.g. `arm` before `arm/joint`.
    """
    if not isinstance(node, dict):
        return None
    for count in range(1, len(parts) + 1):
        key, rest = "/".join(parts[:count]), parts[count:]
        if key in node:
            found = (node, key) if not rest else _locate(node[key], rest)
            if found is not None:
                return found
    return None


class ParameterTree:
    """The store behind all namespaces. Safe to use from any thread.

    Args:
        values: Initial content, which is copied.
    """

    def __init__(self, values: Mapping[str, object] | None = None) -> None:
        self._lock = threading.Lock()
        self._root: dict[str, object] = {}
        self._listeners: list[ParameterListener] = []
        for key, value in (values or {}).items():
            self._store(_split(key), deepcopy(value))

    def get(self, path: str, default: object = None) -> object:
        """Return a copy of the value at `path`, or `default` if there is none."""
        with self._lock:
            parts = _split(path)
            if not parts:
                return deepcopy(self._root)
            place = _locate(self._root, parts)
            return default if place is None else deepcopy(place[0][place[1]])

    def set(self, path: str, value: object) -> None:
        """Store a copy of `value` at `path` and notify the listeners.

        Missing namespaces along the path are made; a plain value along it is replaced
        by a namespace.

        Raises:
            ParameterError: `path` is empty and `value` is not a mapping.
        """
        parts = _split(path)
        if not parts and not isinstance(value, Mapping):
            raise ParameterError(
                f"The root of the parameters must be a mapping, not {show(value)}.",
                remedy="Give a path such as 'controller/p'.",
            )
        with self._lock:
            if parts:
                self._store(parts, deepcopy(value))
            else:
                self._root = {str(k): deepcopy(v) for k, v in dict(value).items()}  # type: ignore[call-overload]  # checked above
        self._notify("/".join(parts), value)

    def delete(self, path: str) -> bool:
        """Remove the value at `path`, and return whether there was one."""
        parts = _split(path)
        with self._lock:
            place = _locate(self._root, parts)
            removed = place is not None
            if place is not None:
                del place[0][place[1]]
        if removed:
            self._notify("/".join(parts), None)
        return removed

    def subscribe(self, listener: ParameterListener) -> Callable[[], None]:
        """Call `listener(path, value)` after every change, in the changing thread.

        Args:
            listener: Receives the path and the new value, which is None for a parameter
                that was deleted.

        Returns:
            A function that ends the subscription.
        """
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener)

    def _notify(self, path: str, value: object) -> None:
        for listener in list(self._listeners):
            listener(path, value)

    def _store(self, parts: list[str], value: object) -> None:
        node = self._root
        # An existing key that contains a `/` is kept; missing parts of the path are
        # made below the longest part of it that exists.
        for count in range(len(parts), 0, -1):
            place = _locate(self._root, parts[:count])
            if place is None:
                continue
            holder, key = place
            parts = parts[count:]
            if not parts:
                holder[key] = value
                return
            child = holder[key]
            node = child if isinstance(child, dict) else {}
            holder[key] = node
            break
        for part in parts[:-1]:
            child = node[part] = {}
            node = child
        node[parts[-1]] = value


class Parameters:
    """A view on one namespace of a `ParameterTree`.

    Args:
        tree: The tree; None makes an empty one.
        path: The namespace.
        reads: Receives the full path of each parameter that is read through this view
            and its namespaces; None to note nothing.
    """

    def __init__(
        self,
        tree: ParameterTree | None = None,
        path: str = "",
        reads: set[str] | None = None,
    ) -> None:
        self.tree = ParameterTree() if tree is None else tree
        self.path = "/".join(_split(path))
        self._reads = reads

    def resolve(self, key: str) -> str:
        """Return the full path of `key` in this namespace."""
        return "/".join(_split(f"{self.path}/{key}"))

    def namespace(self, key: str) -> "Parameters":
        """Return the view on the namespace `key` below this one."""
        return Parameters(self.tree, self.resolve(key), self._reads)

    def get(self, key: str = "", default: object = None) -> object:
        """Return the value of `key`, of any type, or `default` if there is none."""
        if self._reads is not None:
            self._reads.add(self.resolve(key))
        return self.tree.get(self.resolve(key), default)

    def has(self, key: str) -> bool:
        """Return whether `key` has a value. This does not count as a read."""
        return self.tree.get(self.resolve(key), _MISSING) is not _MISSING

    def set(self, key: str, value: object) -> None:
        """Set `key` in this namespace."""
        self.tree.set(self.resolve(key), value)

    def keys(self) -> list[str]:
        """Return the keys of this namespace; none if it is not a mapping."""
        value = self.get()
        return [str(key) for key in value] if isinstance(value, dict) else []

    def get_float(self, key: str, default: float | None = None) -> float:
        """Return the number at `key`; it is required if there is no default.

        Raises:
            ParameterError: The value is missing, or not a finite number.
        """
        value = self._value(key, default)
        number = not isinstance(value, bool) and isinstance(value, (int, float))
        if not number or value - value != 0:  # type: ignore[operator]  # a number
            raise self._wrong(key, value, "a finite number")
        return float(value)  # type: ignore[arg-type]  # a number

    def get_int(self, key: str, default: int | None = None) -> int:
        """Return the integer at `key`; it is required if there is no default.

        Raises:
            ParameterError: The value is missing, or not an integer.
        """
        value = self._value(key, default)
        if isinstance(value, bool) or not isinstance(value, int):
            raise self._wrong(key, value, "an integer")
        return value

    def get_bool(self, key: str, default: bool | None = None) -> bool:  # noqa: FBT001 - a default
        """Return the boolean at `key`; it is required if there is no default.

        Raises:
            ParameterError: The value is missing, or neither true nor false.
        """
        value = self._value(key, default)
        if not isinstance(value, bool):
            raise self._wrong(key, value, "true or false")
        return value

    def get_str(self, key: str, default: str | None = None) -> str:
        """Return the string at `key`; it is required if there is no default.

        Raises:
            ParameterError: The value is missing, or not a string.
        """
        value = self._value(key, default)
        if not isinstance(value, str):
            raise self._wrong(key, value, "a string")
        return value

    def get_str_list(self, key: str, default: list[str] | None = None) -> list[str]:
        """Return the list of strings at `key`; it is required if there is no default.

        Raises:
            ParameterError: The value is missing, or not a list of strings.
        """
        value = self._value(key, default)
        if not isinstance(value, list) or not all(isinstance(v, str) for v in value):
            raise self._wrong(key, value, "a list of strings")
        return value

    def get_float_list(
        self, key: str, size: int | None = None, default: list[float] | None = None
    ) -> list[float]:
        """Return the list of numbers at `key`; it is required if there is no default.

        Args:
            key: The key.
            size: Length that the list must have; None allows any.
            default: Value if the key is absent.

        Raises:
            ParameterError: The value is missing, not a list of finite numbers, or has
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
                remedy="Set it before the controller or robot is initialised.",
                details={"parameter": self.resolve(key)},
            )
        return value

    def _wrong(self, key: str, value: object, wanted: str) -> ParameterError:
        return ParameterError(
            f"Parameter '{self.resolve(key)}' is {show(value)}; it must be {wanted}.",
            remedy="Correct the value and try again.",
            details={"parameter": self.resolve(key)},
        )


def unknown_parameters(
    params: Parameters, known: Collection[str]
) -> list[tuple[str, str]]:
    """Return the parameters of a namespace that no reader knows.

    Args:
        params: The namespace.
        known: Full paths of the known parameters; every path below one is known.

    Returns:
        For each unknown parameter, its path below the namespace and a sentence about
        the names that may have been meant. A namespace in which nothing is known counts
        as one parameter.
    """
    around: dict[str, None] = {}
    for path in sorted(known):
        parts = _split(path)
        around |= dict.fromkeys("/".join(parts[:n]) for n in range(1, len(parts) + 1))
    found: list[tuple[str, str]] = []

    def look(node: object, path: str) -> None:
        if path in known:
            return
        if path != params.path and path not in around:
            place, _, name = path.rpartition("/")
            others = [
                other.rpartition("/")[2]
                for other in around
                if other.rpartition("/")[0] == place
            ]
            below = path.removeprefix(params.path).strip("/")
            found.append((below, suggest(name, others)))
        elif isinstance(node, dict):
            for key, child in node.items():
                look(child, "/".join(_split(f"{path}/{key}")))

    look(params.tree.get(params.path), params.path)
    return found
