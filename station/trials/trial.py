"""A trial as data: configuration, script, parameters and seed; its hash names it.

A script is plain data from a file. A configuration is kept as text, so that it can be
sent to other machines and compared.
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from station.config import StationConfig, load_config
from station.config.models import Controller
from station.core.errors import ConfigError, show
from station.core.yaml_reader import read_yaml
from station.trials.errors import ExperimentError, ImpossibleRangeError
from station.wire.excitations import Command, Motion, Push


class Script(BaseModel):
    """The script of a trial.

    A script is plain data, so that a file can hold it:

    ```yaml
    controller: effort_joint_trajectory_controller
    duration: 2.0
    commands:
      - {kind: waypoints, joint: panda_joint1, times: [0.6, 1.2], values: [0.3, 0.0]}
      - {kind: push, link: panda_link7, at: 1.5, lasts: 0.1, force: [0, 10, 0]}
    ```

    All values of motions are offsets from the joint's initial position. Several
    commands for the same joint add up.

    Attributes:
        controller: The controller that is started and commanded.
        duration: Length of the trial [s], > 0.
        commands: Motions of joints; without any, the controller holds.
        begin: Initial positions [rad or m], by joint; other joints begin where the
            world starts.
        settling_band: Half-width of the band of the settling time, as a share of the
            step's amplitude, 0 to 1.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    controller: str
    duration: Annotated[float, Field(gt=0.0, le=3600.0)]
    commands: Annotated[tuple[Command, ...], Field(max_length=1000)] = ()
    begin: dict[str, float] = {}
    settling_band: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.02

    @property
    def motions(self) -> tuple[Motion, ...]:
        """The commands that move joints."""
        return tuple(c for c in self.commands if not isinstance(c, Push))

    @property
    def pushes(self) -> tuple[Push, ...]:
        """The commands that push links."""
        return tuple(c for c in self.commands if isinstance(c, Push))


def parse_script(data: object, source: str = "script") -> Script:
    """Return a script from plain data.

    Args:
        data: Content of a file.
        source: Name of the file in an error.

    Raises:
        ExperimentError: The data are not a script; the message has every reason.
    """
    try:
        return Script.model_validate(data)
    except ValidationError as error:
        reasons = "; ".join(
            f"{'.'.join(map(str, each['loc'])) or 'script'}: {each['msg']} "
            f"(given: {show(each['input'])})"
            for each in error.errors()
        )
        raise ExperimentError(
            f"{source} is no script of a trial: {reasons}.",
            remedy="docs/experiments.md lists the commands and their fields.",
        ) from error


def read_script(path: Path) -> Script:
    """Return the script in a YAML file.

    Raises:
        ExperimentError: The file cannot be read, or does not hold a script.
    """
    try:
        data = read_yaml(path).values
    except ConfigError as error:
        raise ExperimentError(error.message, remedy=error.remedy) from error
    return parse_script(data, str(path))


_NOT_OF_A_TRIAL = ("api", "ui", "watchdog")
"""Sections of servers. They keep their defaults, because a trial runs no server, and
the token of a server must not be sent or stored with results."""


@dataclass(frozen=True)
class Setup:
    """A station's whole configuration, with the content of the files that it names.

    Paths of URDFs and meshes stay paths: every machine that runs trials needs them.

    Args:
        text: The configuration as canonical JSON; `load` makes it.
    """

    text: str

    @classmethod
    def load(
        cls,
        config: Path | str | Mapping[str, object] | None = None,
        *,
        controllers: Sequence[Path | str] = (),
        settings: Mapping[str, object] | None = None,
    ) -> Self:
        """Return the setup of a configuration; arguments as for `station.open`.

        Raises:
            ConfigError: A file cannot be read, or a value is not allowed.
        """
        loaded = load_config(
            Path(config) if isinstance(config, str) else config,
            controller_files=[Path(file) for file in controllers],
            flags=settings,
        )
        return cls.of(loaded)

    @classmethod
    def of(cls, config: StationConfig) -> Self:
        """Return the setup of a loaded configuration."""
        values = config.model_dump(mode="json", exclude=set(_NOT_OF_A_TRIAL))
        values["parameters"] = config.parameters
        if config.ros_controllers:
            values["ros_controllers"] = sorted(config.ros_controllers)
        return cls(canonical(values))

    def with_controllers(self, loaded: Mapping[str, Mapping[str, object]]) -> Self:
        """Return the setup with the controllers that a station has loaded.

        Args:
            loaded: Parameters of each controller, `type` among them, by name. They
                replace controllers of the same name in the configuration.
        """
        values = json.loads(self.text)
        values["controllers"] = {
            **values.get("controllers", {}),
            # Validated like a configuration with these controllers.
            **{
                name: Controller.model_validate(parameters).model_dump(mode="json")
                for name, parameters in loaded.items()
            },
        }
        return replace(self, text=canonical(values))

    @cached_property
    def digest(self) -> str:
        """Name of the setup: 16 hexadecimal digits."""
        return digest_of(self.text)

    def config(self) -> StationConfig:
        """Return the configuration."""
        defaults = load_config().model_dump(mode="json", include=set(_NOT_OF_A_TRIAL))
        values = {**defaults, **json.loads(self.text)}
        names = frozenset(values.pop("ros_controllers", ()))
        return StationConfig.model_validate({**values, "ros_controllers": names})


def canonical(data: object) -> str:
    """Return the canonical JSON text of some data: sorted keys, no blanks.

    Raises:
        ValueError: A number is not finite.
    """
    return json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest_of(text: str) -> str:
    """Return the first 16 hexadecimal digits of the SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


State = Literal["done", "failed"]


@dataclass(frozen=True)
class Trial:
    """One closed-loop run of a simulated station.

    Args:
        setup: The configuration.
        script: Commands of the trial.
        parameters: Differences from the configuration, by the names that
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
        """Name of the trial: 16 hexadecimal digits, computed from all its data."""
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
            ExperimentError: The text does not hold a trial.
        """
        data = json.loads(text)
        script = parse_script(data["script"])
        return cls(setup, script, data["parameters"], data["seed"])

    def with_parameters(
        self, changes: Mapping[str, float], seed: int | None = None
    ) -> Self:
        """Return the trial with changed parameters, and with another seed if given."""
        return replace(
            self,
            parameters={**self.parameters, **changes},
            seed=self.seed if seed is None else seed,
        )


@dataclass(frozen=True, slots=True)
class TrialResult:
    """The result of a trial.

    Attributes:
        hash: Hash of the trial.
        state: `done`; or `failed` when the robot or the controller stopped with a
            fault, or the trial was refused. The metrics of a failed trial are those of
            the time before.
        reason: Why it failed; None when it is done.
        metrics: Metrics by name, finite numbers only; metrics that do not apply to the
            script are left out.
        seconds: Wall time of the trial [s].
        worker: Host and process that ran the trial.
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
