"""The faults that tests order of the mock."""

from dataclasses import dataclass, field


@dataclass(slots=True)
class MockScript:
    """The faults of the mock; by default there are none.

    Attributes:
        refusal: Why `prepare_switch` refuses; None when every switch is accepted.
        switch_cycles: Cycles that every switch of the hardware takes, >= 0.
        failing: Names of controllers for which the hardware cannot switch.
        nan_sensors: Names of joints whose position and velocity read NaN.
        slow_cycles: How long the next cycles take in `read` [s], one number each.
        read_error: What `read` raises; None for nothing.
        mode: The robot's mode, one word.
    """

    refusal: str | None = None
    switch_cycles: int = 0
    failing: set[str] = field(default_factory=set)
    nan_sensors: set[str] = field(default_factory=set)
    slow_cycles: list[float] = field(default_factory=list)
    read_error: Exception | None = None
    mode: str = "running"
