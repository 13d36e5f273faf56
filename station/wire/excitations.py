"""Wire models of what a joint is asked to do in a trial or at the bench.

All values of motions are offsets from where the joint begins, and add up when several
commands name the same joint.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from station.wire.base import RequestModel

Time = Annotated[float, Field(ge=0.0, le=3600.0)]
Frequency = Annotated[float, Field(gt=0.0, le=500.0)]
MOST_RECORDED = 100_000
"""Most values of a motion that was recorded."""
Vector = Annotated[tuple[float, ...], Field(strict=False, min_length=3, max_length=3)]


class _Tagged(RequestModel):
    """Base of the excitations; the kind tells them apart."""

    @override
    def model_post_init(self, context: object, /) -> None:
        """Count the kind among what was set: a client sends nothing else."""
        self.model_fields_set.add("kind")


class Step(_Tagged):
    """A set-point that jumps.

    Attributes:
        kind: Which excitation it is.
        joint: Joint, or element of the set-point.
        amplitude: Height [unit of the set-point].
        at: When [s].
    """

    kind: Literal["step"] = "step"
    joint: str
    amplitude: float
    at: Time = 0.0


class Sine(_Tagged):
    """A sine that fades in and out within a quarter of its duration, 0.5 s at most.

    Attributes:
        kind: Which excitation it is.
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


class Chirp(_Tagged):
    """A sine whose frequency grows linearly; it fades as `Sine` does.

    Attributes:
        kind: Which excitation it is.
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


class Multisine(_Tagged):
    """Several sines at once, whose phases keep the sum low; fades as `Sine` does.

    Attributes:
        kind: Which excitation it is.
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
    frequencies: Annotated[
        tuple[Frequency, ...], Field(strict=False, min_length=1, max_length=50)
    ]
    at: Time = 0.0
    lasts: Time | None = None


class Relay(_Tagged):
    """A set-point that changes sides when the joint has crossed the middle.

    Attributes:
        kind: Which excitation it is.
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


class Waypoints(_Tagged):
    """Motions from rest to rest with the least jerk, one after the other.

    Attributes:
        kind: Which excitation it is.
        joint: Joint, or element of the set-point.
        times: When each waypoint is reached [s], > 0 and increasing.
        values: Offset of each waypoint [unit of the set-point].
    """

    kind: Literal["waypoints"] = "waypoints"
    joint: str
    times: Annotated[
        tuple[Time, ...], Field(strict=False, min_length=1, max_length=1000)
    ]
    values: Annotated[tuple[float, ...], Field(strict=False)]

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


class Recorded(_Tagged):
    """Offsets that somebody recorded, e.g. before an incident.

    Attributes:
        kind: Which excitation it is.
        joint: Joint, or element of the set-point.
        times: When each value begins [s], increasing.
        values: Offsets [unit of the set-point].
        between: Whether a value is held until the next one (`hold`), or a smooth curve
            goes through them (`smooth`).
    """

    kind: Literal["recorded"] = "recorded"
    joint: str
    times: Annotated[
        tuple[Time, ...], Field(strict=False, min_length=1, max_length=MOST_RECORDED)
    ]
    values: Annotated[tuple[float, ...], Field(strict=False)]
    between: Literal["hold", "smooth"] = "hold"

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


class Push(_Tagged):
    """A force on a link of the simulated robot.

    Attributes:
        kind: Which excitation it is.
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
