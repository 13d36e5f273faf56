"""The script of a trial: which controller runs, and what it is asked to do when.

A script is plain data, so that a file can hold it:

```yaml
controller: effort_joint_trajectory_controller
duration: 2.0
commands:
  - {kind: waypoints, joint: panda_joint1, times: [0.6, 1.2], values: [0.3, 0.0]}
  - {kind: push, link: panda_link7, at: 1.5, lasts: 0.1, force: [0, 10, 0]}
```

All values of motions are offsets from where the joint begins, and add up when several
commands name the same joint.
"""

from pathlib import Path
from typing import Annotated, Literal, Self

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from station.core.errors import show
from station.experiments.errors import ExperimentError

Time = Annotated[float, Field(ge=0.0, le=3600.0)]
Frequency = Annotated[float, Field(gt=0.0, le=500.0)]
Vector = Annotated[tuple[float, ...], Field(min_length=3, max_length=3)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Step(_Part):
    """A set-point that jumps.

    Attributes:
        joint: Joint, or element of the set-point.
        amplitude: Height [unit of the set-point].
        at: When [s].
    """

    kind: Literal["step"] = "step"
    joint: str
    amplitude: float
    at: Time = 0.0


class Sine(_Part):
    """A sine that fades in and out within a quarter of its duration, 0.5 s at most.

    Attributes:
        joint: Joint, or element of the set-point.
        amplitude: Largest offset [unit of the set-point].
        frequency: Frequency [Hz], > 0.
        at: When it begins [s].
        lasts: How long it lasts [s]; to the end of the script when None.
    """

    kind: Literal["sine"] = "sine"
    joint: str
    amplitude: float
    frequency: Frequency
    at: Time = 0.0
    lasts: Time | None = None


class Chirp(_Part):
    """A sine whose frequency grows linearly; it fades as `Sine` does.

    Attributes:
        joint: Joint, or element of the set-point.
        amplitude: Largest offset [unit of the set-point].
        first: Frequency at the beginning [Hz], > 0.
        last: Frequency at the end [Hz], > 0.
        at: When it begins [s].
        lasts: How long it lasts [s]; to the end of the script when None.
    """

    kind: Literal["chirp"] = "chirp"
    joint: str
    amplitude: float
    first: Frequency
    last: Frequency
    at: Time = 0.0
    lasts: Time | None = None


class Multisine(_Part):
    """Several sines at once, whose phases keep the sum low; fades as `Sine` does.

    Attributes:
        joint: Joint, or element of the set-point.
        amplitude: Bound of the sum [unit of the set-point].
        frequencies: Frequencies [Hz], > 0, 1 to 50 of them.
        at: When it begins [s].
        lasts: How long it lasts [s]; to the end of the script when None.

    Source:
        M. Schroeder, Synthesis of low-peak-factor signals and binary sequences with
        low autocorrelation, 1970: the phases.
    """

    kind: Literal["multisine"] = "multisine"
    joint: str
    amplitude: float
    frequencies: Annotated[tuple[Frequency, ...], Field(min_length=1, max_length=50)]
    at: Time = 0.0
    lasts: Time | None = None


class Relay(_Part):
    """A set-point that changes sides when the joint has crossed the middle.

    Attributes:
        joint: Joint, or element of the set-point.
        amplitude: Offset to either side [unit of the set-point].
        hysteresis: How far beyond the middle the joint changes sides [rad or m], >= 0.
        at: When it begins [s].
    """

    kind: Literal["relay"] = "relay"
    joint: str
    amplitude: float
    hysteresis: Annotated[float, Field(ge=0.0)] = 0.0
    at: Time = 0.0


class Waypoints(_Part):
    """Motions from rest to rest with the least jerk, one after the other.

    Attributes:
        joint: Joint, or element of the set-point.
        times: When each waypoint is reached [s], > 0 and increasing.
        values: Offset of each waypoint [unit of the set-point].
    """

    kind: Literal["waypoints"] = "waypoints"
    joint: str
    times: Annotated[tuple[Time, ...], Field(min_length=1, max_length=1000)]
    values: tuple[float, ...]

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse times that do not increase or do not fit the values.

        Raises:
            ValueError: They do not.
        """
        ordered = all(
            a < b for a, b in zip((0.0, *self.times), self.times, strict=False)
        )
        if len(self.times) != len(self.values) or not ordered:
            raise ValueError(
                "times must increase from above 0, and there must be one per value"
            )
        return self


class Recorded(_Part):
    """Offsets that somebody recorded, e.g. before an incident; held in between.

    Attributes:
        joint: Joint, or element of the set-point.
        times: When each value begins [s], increasing.
        values: Offsets [unit of the set-point].
    """

    kind: Literal["recorded"] = "recorded"
    joint: str
    times: Annotated[tuple[Time, ...], Field(min_length=1, max_length=100_000)]
    values: tuple[float, ...]

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse times that do not increase or do not fit the values.

        Raises:
            ValueError: They do not.
        """
        ordered = all(a < b for a, b in zip(self.times, self.times[1:], strict=False))
        if len(self.times) != len(self.values) or not ordered:
            raise ValueError("times must increase, and there must be one per value")
        return self


class Push(_Part):
    """A force on a link of the simulated robot.

    Attributes:
        link: The link.
        at: When it begins [s].
        lasts: How long it lasts [s], > 0.
        force: Force in the world's axes at the centre of mass [N], shape (3,).
    """

    kind: Literal["push"] = "push"
    link: str
    at: Time
    lasts: Annotated[float, Field(gt=0.0, le=3600.0)]
    force: Vector


Motion = Step | Sine | Chirp | Multisine | Relay | Waypoints | Recorded
Command = Annotated[Motion | Push, Field(discriminator="kind")]


class Script(_Part):
    """What a trial does.

    Attributes:
        controller: The controller that is started and commanded.
        duration: Length of the trial [s], > 0.
        commands: What happens; nothing but the controller's hold without commands.
        begin: Where joints begin [rad or m], by name; others at the world's start.
        settling_band: Half-width of the band of the settling time, as a share of the
            step's amplitude, 0 to 1.
    """

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
        data: What a file holds.
        source: What the error names.

    Raises:
        ExperimentError: The data are no script, and every reason why.
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
        ExperimentError: The file cannot be read or holds no script.
    """
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise ExperimentError(f"The script {path} cannot be read: {error}.") from error
    return parse_script(data, str(path))
