"""Samples of a stream as NumPy arrays, or as a table if pandas is installed."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from typing_extensions import override

from station.wire import StreamFrame

if TYPE_CHECKING:
    from types import ModuleType
    from typing import TypeAlias

    import numpy as np
    from numpy.typing import NDArray
    from pandas import DataFrame

    Array: TypeAlias = NDArray[np.float64]


class Samples(Mapping[str, "Array"]):
    """Numbers of a topic over time: `samples["position"]`, shape (n, joints).

    Args:
        topic: Topic that was streamed.

    Attributes:
        topic: Topic that was streamed.
        names: Names of the arrays' columns, usually of joints.
        lost: Number of cycles that were lost in transmission.

    Raises:
        ModuleNotFoundError: NumPy is not installed: `pip install numpy`.
    """

    def __init__(self, topic: str) -> None:
        # Fail before collecting samples that could not be read: the client runs without
        # NumPy.
        self._numpy = _load_numpy()
        self.topic = topic
        self.names: tuple[str, ...] = ()
        self.lost = 0
        self._stamps: list[float] = []
        self._samples: list[Mapping[str, object]] = []
        self._widths: dict[str, int | None] = {}

    @property
    def stamp(self) -> "Array":
        """Station time of each sample [s], shape (n,)."""
        found: Array = self._numpy.array(self._stamps)
        return found

    @property
    def duration(self) -> float:
        """Station time from the first sample to the last one [s]."""
        return self._stamps[-1] - self._stamps[0] if self._stamps else 0.0

    def add(self, frame: StreamFrame) -> None:
        """Append the samples of a frame.

        Args:
            frame: A frame of the topic, with one sample or a batch of them.
        """
        data = frame.data
        names = data.get("name")
        if isinstance(names, list):
            self.names = tuple(map(str, names))
        lost = data.get("lost")
        self.lost += lost if isinstance(lost, int) else 0
        batch = data.get("samples", [data])
        for sample in batch if isinstance(batch, list) else ():
            if isinstance(sample, dict):
                self._append(sample, frame.stamp)

    def cut(self, seconds: float) -> None:
        """Drop the samples later than some seconds after the first one.

        Args:
            seconds: Station time [s].
        """
        first = self._stamps[0] if self._stamps else 0.0
        # Half a nanosecond of tolerance, because stamps are sums of periods.
        count = sum(stamp - first <= seconds + 5e-10 for stamp in self._stamps)
        del self._stamps[count:], self._samples[count:]

    def frame(self) -> "DataFrame":
        """Return a table with one row per sample, by stamp, and a column per number.

        Columns are named like `position/panda_joint1`.

        Raises:
            ModuleNotFoundError: pandas is not installed: `pip install pandas`.
        """
        try:
            from pandas import DataFrame, Index
        except ModuleNotFoundError as error:
            raise ModuleNotFoundError(
                "A table needs pandas: pip install pandas.", name="pandas"
            ) from error

        columns: dict[str, Array] = {}
        for key, array in self.items():
            if array.ndim == 1:
                columns[key] = array
                continue
            named = len(self.names) == array.shape[1]
            labels = self.names if named else tuple(map(str, range(array.shape[1])))
            columns |= {
                f"{key}/{label}": array[:, column]
                for column, label in enumerate(labels)
            }
        return DataFrame(columns, index=Index(self.stamp, name="stamp"))

    @override
    def __getitem__(self, key: str) -> "Array":
        """Return one quantity, shape (n, k), or (n,) if it is one number.

        NaN stands for a missing number.
        """
        width = self._widths[key]
        absent = None if width is None else [None] * width
        rows = [sample.get(key, absent) for sample in self._samples]
        found: Array = self._numpy.array(rows, dtype=float)
        return found

    @override
    def __iter__(self) -> Iterator[str]:
        return iter(self._widths)

    @override
    def __len__(self) -> int:
        return len(self._widths)

    @override
    def __repr__(self) -> str:
        return (
            f"<{len(self._stamps)} samples of {self.topic} over {self.duration:.3f} s: "
            f"{', '.join(self._widths)}>"
        )

    def _append(self, sample: Mapping[str, object], stamp: float) -> None:
        own = sample.get("stamp", stamp)
        self._stamps.append(own if isinstance(own, float) else stamp)
        self._samples.append(sample)
        for key, value in sample.items():
            if key not in {"stamp", "name"} and _is_numeric(value):
                width = len(value) if isinstance(value, list) else None
                self._widths.setdefault(key, width)


def _load_numpy() -> "ModuleType":
    """Import NumPy.

    Raises:
        ModuleNotFoundError: The package is not installed.
    """
    try:
        import numpy
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            "Samples are arrays of NumPy: pip install numpy.", name="numpy"
        ) from error
    return numpy


def _is_numeric(value: object) -> bool:
    """Return whether a value is a number, null, or a list of numbers and nulls."""
    if isinstance(value, list):
        return bool(value) and all(
            item is None or isinstance(item, int | float) for item in value
        )
    return isinstance(value, int | float)
