"""The exceptions that experiments raise on purpose.

```
StationError
└── ExperimentError            an experiment cannot be carried out
    ├── UnknownParameterError  a trial names an unknown parameter (KeyError)
    ├── ImpossibleRangeError   a value or range is not allowed (ValueError)
    ├── WorkerMismatchError    a worker has another version or configuration
    ├── ExperimentNotFoundError   there is no experiment of that name (KeyError)
    ├── ExperimentRunningError    its state, running or not, does not allow this
    ├── LessonNotFoundError       there is no lesson of that name (KeyError)
    ├── BenchRunNotFoundError     there is no kept run of that name (KeyError)
    ├── BenchRefusedError         a measurement cannot be done, or was ended
    └── TooManyExperimentsError   more trials or experiments than a station takes
```
"""

from station.core.errors import StationError


class ExperimentError(StationError):
    """An experiment cannot be carried out."""

    code = "experiment"


class UnknownParameterError(ExperimentError, KeyError):
    """A trial or a range names an unknown parameter."""

    code = "unknown_parameter"


class ImpossibleRangeError(ExperimentError, ValueError):
    """A value or a range of values is not allowed."""

    code = "impossible_range"


class WorkerMismatchError(ExperimentError):
    """A worker has another version or another configuration than the caller."""

    code = "worker_mismatch"


class ExperimentNotFoundError(ExperimentError, KeyError):
    """There is no experiment of that name."""

    code = "experiment_not_found"


class ExperimentRunningError(ExperimentError, RuntimeError):
    """The present state of an experiment, running or not, does not allow a request."""

    code = "experiment_running"


class TooManyExperimentsError(ExperimentError, ValueError):
    """There would be more trials or experiments than a station accepts."""

    code = "too_many_experiments"


class BenchRefusedError(ExperimentError):
    """A measurement of the robot is not possible now, or was ended early."""

    code = "bench_refused"


class BenchRunNotFoundError(ExperimentError, KeyError):
    """The bench has kept no run of that name."""

    code = "bench_run_not_found"


class LessonNotFoundError(ExperimentError, KeyError):
    """There is no lesson of that name."""

    code = "lesson_not_found"
