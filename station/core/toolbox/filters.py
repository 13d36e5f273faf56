"""Chains of filters over several numbers, as controllers of ROS 2 declare them.

    filter_chain:
      filter1: {name: smooth, type: control_filters/LowPassFilterDouble, params: {…}}
      filter2: {name: mean, type: filters/MeanFilterDouble, params: {…}}

Source: ros2 filters@2.x filter_chain.hpp, mean.hpp, median.hpp; control_toolbox@6.x
control_filters: low_pass_filter.hpp, exponential_filter.hpp.
"""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Mapping
from math import exp, pi
from statistics import median_low
from typing import NoReturn

from typing_extensions import override

from station.core.errors import ParameterError, show

LIMITS: Mapping[str, tuple[float, float]] = {
    "number_of_observations": (1.0, 10_000.0),
    "sampling_frequency": (1e-9, 1e9),
    "damping_frequency": (1e-9, 1e9),
    "damping_intensity": (-1e3, 1e3),
    "alpha": (0.0, 1.0),
}
"""Range of each parameter: frequencies in Hz, the intensity in dB."""


class Filter(ABC):
    """Computes n numbers from n numbers, once per cycle."""

    @abstractmethod
    def update(self, values: list[float]) -> list[float]:
        """Return the filtered numbers, shape (n,), a new list.

        Args:
            values: The numbers, shape (n,).
        """


class WindowFilter(Filter):
    """Computes the mean, the median or the like of the last numbers of each channel.

    Args:
        compute: Returns the result for a list of numbers that is not empty.
        size: Number of last numbers that are kept, > 0.
    """

    def __init__(self, compute: Callable[[list[float]], float], size: int) -> None:
        self._compute = compute
        self._kept: deque[list[float]] = deque(maxlen=size)

    @override
    def update(self, values: list[float]) -> list[float]:
        self._kept.append(list(values))
        return [self._compute(list(each)) for each in zip(*self._kept, strict=True)]


class LowPassFilter(Filter):
    """Computes share * (last input) + (1 - share) * (last output).

    Args:
        share: Share of the input, 0 to 1.
        is_late: Whether to use the input of the cycle before, as the low-pass of
            control_filters does; otherwise the present input.
    """

    def __init__(self, share: float, *, is_late: bool) -> None:
        self._share = share
        self._is_late = is_late
        self._input: list[float] = []
        self._output: list[float] = []

    @override
    def update(self, values: list[float]) -> list[float]:
        # The first numbers pass, because there is no output before them.
        last = self._output or values
        taken = (self._input or values) if self._is_late else values
        share = self._share
        self._output = [
            share * value + (1.0 - share) * before
            for value, before in zip(taken, last, strict=True)
        ]
        self._input = list(values)
        return list(self._output)


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)


def _low_pass(params: Mapping[str, float]) -> Filter:
    cutoff = 2.0 * pi * params["damping_frequency"] / params["sampling_frequency"]
    kept = exp(-cutoff / 10.0 ** (params["damping_intensity"] / -10.0))
    return LowPassFilter(1.0 - kept, is_late=True)


def _window(
    compute: Callable[[list[float]], float],
) -> Callable[[Mapping[str, float]], Filter]:
    return lambda p: WindowFilter(compute, int(p["number_of_observations"]))


_KINDS: Mapping[
    str, tuple[Callable[[Mapping[str, float]], Filter], tuple[str, ...]]
] = {
    "filters/MeanFilter": (_window(_mean), ("number_of_observations",)),
    # Of an even number the original takes the lower one of the two in the middle.
    "filters/MedianFilter": (_window(median_low), ("number_of_observations",)),
    "control_filters/LowPassFilter": (
        _low_pass,
        ("sampling_frequency", "damping_frequency", "damping_intensity"),
    ),
    "control_filters/ExponentialFilter": (
        lambda p: LowPassFilter(p["alpha"], is_late=False),
        ("alpha",),
    ),
}
"""By type without its ending, one of `_FILTERED`: the function that makes the filter,
and the filter's parameters."""
_FILTERED = ("Double", "Wrench", "MultiChannelDouble")


class FilterChain:
    """Applies filters one after the other.

    Args:
        filters: The filters in their order; without filters the numbers pass.
    """

    def __init__(self, filters: list[Filter]) -> None:
        self._filters = filters

    @classmethod
    def read(cls, value: object, place: str) -> "FilterChain":
        """Return the chain that a parameter describes.

        Args:
            value: Value of the parameter: the filters `filter1`, `filter2` and so on;
                None, `none` or no filters for a chain that lets all numbers pass.
            place: Path of the parameter, for messages.

        Raises:
            ParameterError: A filter is of an unknown type, or its parameters are
                missing, unknown or out of their range.
        """
        if value is None or value == "none":
            return cls([])
        if not isinstance(value, Mapping):
            _refuse(place, value, "a mapping with filter1, filter2, …")
        names = [f"filter{number}" for number in range(1, len(value) + 1)]
        for name in value:
            if name not in names:
                _refuse(f"{place}/{name}", value[name], f"one of {names}")
        return cls([_read_filter(value[name], f"{place}/{name}") for name in names])

    def update(self, values: list[float]) -> list[float]:
        """Return the filtered numbers, shape (n,).

        Args:
            values: The numbers, shape (n,).
        """
        for each in self._filters:
            values = each.update(values)
        return values

    def __len__(self) -> int:
        """Return the number of filters."""
        return len(self._filters)


def _read_filter(value: object, place: str) -> Filter:
    if not isinstance(value, Mapping) or set(value) - {"name", "type", "params"}:
        _refuse(place, value, "a mapping of name, type and params")
    kind = str(value.get("type"))
    stems = [kind.removesuffix(end) for end in _FILTERED if kind.endswith(end)]
    found = next((_KINDS[stem] for stem in stems if stem in _KINDS), None)
    if found is None:
        known = ", ".join(f"{stem}Double" for stem in _KINDS)
        _refuse(f"{place}/type", value.get("type"), f"one of {known}")
    make, names = found
    given = value.get("params") or {}
    if not isinstance(given, Mapping):
        _refuse(f"{place}/params", given, f"a mapping of {', '.join(names)}")
    # `divider` of the low-pass has no effect in the original either.
    for name in given:
        if name not in {*names, "divider"}:
            _refuse(
                f"{place}/params/{name}", given[name], f"left out: {kind} has {names}"
            )
    for name in names:
        lower, upper = LIMITS[name]
        number = given.get(name)
        # One chained comparison, so that NaN is refused, too.
        if not _is_number(number) or not lower <= float(str(number)) <= upper:
            _refuse(
                f"{place}/params/{name}",
                number,
                f"a number from {lower:g} to {upper:g}",
            )
    return make({name: float(given[name]) for name in names})


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _refuse(place: str, value: object, allowed: str) -> NoReturn:
    raise ParameterError(
        f"Parameter '{place}' is {show(value)}; it must be {allowed}.",
        remedy="Correct the filter chain.",
        details={"parameter": place},
    )
