"""A trial as data: configuration, script, parameters and seed; its hash names it."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, Self

from station.core.errors import show
from station.trials.errors import ImpossibleRangeError
from station.trials.script import Script, parse_script
from station.trials.setup import Setup, canonical, digest_of

State = Literal["done", "failed"]


@dataclass(frozen=True)
class Trial:
    """One closed-loop run of a simulated station.

    Args:
        setup: The configuration.
        script: What happens.
        parameters: What differs from the configuration, by the names that
            `station.trials.parameters` explains; all finite.
        seed: Seed of the measurement noise, >= 0.

    Raises:
        ImpossibleRangeError: A parameter is not finite, or the seed is negative.
    """

    setup: Setup
    script: Script
    parameters: Mapping[str, float] = field(default_factory=dict)
    seed: int = 0

    def __post_init__(self) -> None:
        for name, value in self.parameters.items():
            if not math.isfinite(value):
                raise ImpossibleRangeError(
                    f"Parameter '{name}' is {value}; allowed are finite numbers.",
                    details={"parameter": name},
                )
        if self.seed < 0:
            raise ImpossibleRangeError(
                f"The seed is {self.seed}; allowed are integers >= 0."
            )

    @cached_property
    def hash(self) -> str:
        """Name of the trial: 16 hexadecimal digits of all that it consists of."""
        return digest_of(f"{self.setup.digest}{self.to_json()}")

    def to_json(self) -> str:
        """Return everything but the setup as canonical JSON."""
        return canonical({
            "script": self.script.model_dump(mode="json"),
            "parameters": {k: float(v) for k, v in self.parameters.items()},
            "seed": self.seed,
        })

    @classmethod
    def from_json(cls, setup: Setup, text: str) -> Self:
        """Return the trial that `to_json` wrote.

        Raises:
            ExperimentError: The text holds no trial.
        """
        data = json.loads(text)
        script = parse_script(data["script"])
        return cls(setup, script, data["parameters"], data["seed"])

    def with_parameters(
        self, changes: Mapping[str, float], seed: int | None = None
    ) -> Self:
        """Return the trial with other parameters, and another seed if one is given."""
        return replace(
            self,
            parameters={**self.parameters, **changes},
            seed=self.seed if seed is None else seed,
        )


@dataclass(frozen=True, slots=True)
class TrialResult:
    """The result of a trial.

    Attributes:
        hash: The trial's.
        state: `done`, or `failed` when the robot or the controller gave up or the
            trial was refused; the metrics are then those of the time before.
        reason: Why it failed; None when it is done.
        metrics: By name, finite numbers alone; a metric that the script has no use for
            is left out.
        seconds: Wall time of the trial [s].
        worker: Where it ran: host and process.
    """

    hash: str
    state: State
    reason: str | None
    metrics: Mapping[str, float]
    seconds: float
    worker: str

    def describe(self) -> str:
        """Return the result in one line."""
        shown = ", ".join(f"{k} {v:.4g}" for k, v in self.metrics.items())
        return (
            f"{self.hash} {self.state}: {show(self.reason) if self.reason else shown}"
        )
