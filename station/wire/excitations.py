"""Wire models of excitations of a joint, measured responses, and lessons about them.

A lesson is an exercise that is checked on the student's own run.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from typing_extensions import override

from station.wire.base import FileName, Items, Measurements, RequestModel, ResponseModel

Time = Annotated[float, Field(ge=0.0, le=3600.0)]
Frequency = Annotated[float, Field(gt=0.0, le=500.0)]
MOST_RECORDED = 100_000
"""Largest number of values of a recorded motion."""
Vector = Annotated[tuple[float, ...], Field(strict=False, min_length=3, max_length=3)]
Person = Annotated[str, Field(max_length=100)]


class _Tagged(RequestModel):
    """Base of the excitations, which differ by the value of `kind`."""

    @override
    def model_post_init(self, context: object, /) -> None:
        """Mark `kind` as a set field, because a client sends only set fields."""
        self.model_fields_set.add("kind")


class Step(_Tagged):
    """A set-point that jumps.

    Attributes:
        kind: Kind of the excitation.
        joint: Joint, or element of the set-point.
        amplitude: Height [unit of the set-point].
        at: When it jumps [s].
    """

    kind: Literal["step"] = "step"
    joint: str
    amplitude: float
    at: Time = 0.0


class Sine(_Tagged):
    """A sine that fades in and out within a quarter of its duration, 0.5 s at most.

    Attributes:
        kind: Kind of the excitation.
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
        kind: Kind of the excitation.
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
        kind: Kind of the excitation.
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
        kind: Kind of the excitation.
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
    """Motions of least jerk from rest to rest, one after the other.

    Attributes:
        kind: Kind of the excitation.
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
            ValueError: The times do not increase, or do not fit the values.
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
    """Recorded offsets, e.g. of the time before an incident.

    Attributes:
        kind: Kind of the excitation.
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
            ValueError: The times do not increase, or do not fit the values.
        """
        ordered = all(a < b for a, b in zip(self.times, self.times[1:], strict=False))
        if len(self.times) != len(self.values) or not ordered:
            raise ValueError("times must increase, and there must be one per value")
        return self


class Push(_Tagged):
    """A force on a link of the simulated robot.

    Attributes:
        kind: Kind of the excitation.
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


LONGEST = 10.0
"""Longest measurement [s]."""
Excitation = Annotated[
    Step | Sine | Chirp | Multisine | Relay, Field(discriminator="kind")
]


class BenchRequest(RequestModel):
    """An excitation of one joint through the set-points of a running controller.

    Attributes:
        excitation: Motion of the joint, from where it is.
        duration: How long the response is measured [s], above 0, at most 10.
        settling_band: Half-width of the band of the settling time, as a share of the
            step, above 0 and below 1.
        relay_gain: Proportional gain of the joint during a relay test, > 0. Integral
            and derivative gain are 0 meanwhile, so that they do not shape the
            oscillation. Afterwards the old gains are back. None leaves the gains in
            force.
        name: Name under which the station keeps the response; None lets the station
            choose.

    Example:
        {"excitation": {"kind": "step", "joint": "panda_joint7", "amplitude": 0.1},
         "duration": 1.5}
    """

    excitation: Excitation
    duration: Annotated[float, Field(gt=0.0, le=LONGEST)] = 2.0
    settling_band: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.02
    relay_gain: Annotated[float, Field(gt=0.0, le=1e6)] | None = None
    name: FileName | None = None


class BodeCurve(ResponseModel):
    """A response over the frequency.

    Attributes:
        gain: Gains, shape (k,).
        phase: Phases without jumps [deg], shape (k,).
    """

    gain: Items[float]
    phase: Items[float]


class Bode(ResponseModel):
    """The frequency responses of a joint in its loop.

    Attributes:
        frequency: Frequencies, increasing [Hz], shape (k,).
        coherence: Share of the position's power that the set-point explains, 0 to 1,
            shape (k,).
        closed_loop: From the set-point to the position.
        open_loop: From the error to the position.
        plant: From the controller's command to the position [rad or m per its unit].
    """

    frequency: Items[float]
    coherence: Items[float]
    closed_loop: BodeCurve
    open_loop: BodeCurve
    plant: BodeCurve


class GainProposal(ResponseModel):
    """Gains that a tuning rule computes from the ultimate gain and period.

    Attributes:
        rule: Name of the rule, e.g. `tyreus_luyben_pid`.
        title: Name of the rule for people.
        source: Publication.
        gains: Values by the names of the controller's gains.
        note: Restriction that a reader needs; empty without one.
    """

    rule: str
    title: str
    source: str
    gains: dict[str, float]
    note: str = ""


class BenchResponse(ResponseModel):
    """Response of a joint to an excitation.

    Attributes:
        name: Name of the run.
        created_at: When it was measured, ISO 8601.
        controller: Name of the controller.
        joint: Name of the joint.
        kind: Kind of the excitation.
        amplitude: Size of the excitation [rad or m]; for a part of a recording, the
            size of the set-point's motion.
        gains: Gains of the controller during the measurement, by name.
        time: Station time since the beginning [s], shape (k,).
        desired: Set-point at each time [rad or m], shape (k,); null before the first
            one.
        position: Measured position [rad or m], shape (k,).
        velocity: Measured velocity [rad/s or m/s], shape (k,).
        effort: Measured effort [Nm or N], shape (k,).
        output: Commands of the controller [unit of its interface], shape (k,).
        metrics: Metrics of this joint over all cycles, by name; one that does not
            apply is left out. Margins, bandwidth and the like are among them.
        units: The unit of each metric, by its name.
        cycles: How many cycles were measured, 1 or more; the arrays hold a few hundred
            of these cycles at most.
        bode: Frequency responses of a chirp or a multisine; null for others.
        proposals: Gains by rule, after a relay test with a proportional gain only;
            empty otherwise.
        lost: Cycles that were overwritten before they could be read, 0 or more.
    """

    name: str = ""
    created_at: str = ""
    controller: str
    joint: str
    kind: str
    amplitude: float = 0.0
    gains: dict[str, float]
    time: Items[float]
    desired: Measurements
    position: Measurements
    velocity: Measurements
    effort: Measurements
    output: Measurements
    metrics: dict[str, float]
    units: dict[str, str]
    cycles: int
    lost: int
    bode: Bode | None = None
    proposals: Items[GainProposal] = Field(default_factory=list)


class BenchRun(ResponseModel):
    """A run that the station keeps, without its curves.

    Attributes:
        name: Name of the run.
        created_at: When it was measured, ISO 8601.
        controller: Name of the controller.
        joint: Name of the joint.
        kind: Kind of the excitation.
        gains: p, i and d of the joint, as far as its controller has them.
        metrics: Its metrics by name.
    """

    name: str
    created_at: str
    controller: str
    joint: str
    kind: str
    gains: dict[str, float]
    metrics: dict[str, float]


class BenchRuns(ResponseModel):
    """The runs that the station keeps.

    Attributes:
        runs: The runs, the oldest first.
    """

    runs: Items[BenchRun]


class PartRequest(RequestModel):
    """A part of a recording that is read as a test of a joint.

    Attributes:
        controller: Controller that commanded the joint.
        joint: The joint.
        kind: How the part is read: a step's rise and overshoot, gain and phase at a
            sine's frequency, Bode plot of a chirp or multisine, or oscillation under a
            relay.
        begin: Station time at which the part begins [s]; None for the beginning of the
            recording.
        end: Station time at which the part ends [s]; None for the end of the recording.
        low: Lowest frequency of a chirp or multisine, or that of a sine [Hz].
        high: Highest frequency of a chirp or multisine [Hz].
        name: Name under which the station keeps the result; None lets the station
            choose.

    Example:
        {"controller": "effort_group_position_controller", "joint": "panda_joint7",
         "kind": "step", "begin": 12.5, "end": 14.0}
    """

    controller: str
    joint: str
    kind: Literal["step", "sine", "chirp", "multisine", "relay"]
    begin: float | None = None
    end: float | None = None
    low: Frequency = 0.2
    high: Frequency = 10.0
    name: FileName | None = None


class LessonAnswer(ResponseModel):
    """A number that the student works out and types.

    Attributes:
        name: Name of the answer.
        label: Its name for people.
        unit: Its unit.
    """

    name: str
    label: str
    unit: str = ""


class LessonVerdict(ResponseModel):
    """The result of one check.

    Attributes:
        says: Statement that is checked.
        is_met: Whether it holds.
        value: The measured value; null when it was not measured.
        hint: A likely reason of the failure, and advice; empty when it holds.
    """

    says: str
    is_met: bool
    value: float | None
    hint: str


class Lesson(ResponseModel):
    """An exercise, and how far the person is with it.

    Attributes:
        name: Name of the lesson.
        title: Its name for people.
        text: The task, in Markdown.
        controllers: Controllers that the exercise uses, the main one first.
        joint: Joint that it is about.
        answers: Numbers that the student types.
        is_solved: Whether the person has solved it.
        is_begun: Whether the station watches an attempt of it now.
    """

    name: str
    title: str
    text: str
    controllers: Items[str]
    joint: str
    answers: Items[LessonAnswer]
    is_solved: bool
    is_begun: bool


class Lessons(ResponseModel):
    """The lessons in their order.

    Attributes:
        lessons: The lessons.
        unusable: Files of the user's folder that are no lessons, with their faults.
    """

    lessons: Items[Lesson]
    unusable: Items[str]


class LessonBeginRequest(RequestModel):
    """A person begins a lesson.

    Attributes:
        person: Name of the person, whose progress is kept.

    Example:
        {"person": "ada"}
    """

    person: Person = ""


class LessonCheckRequest(RequestModel):
    """A person asks for a check.

    Attributes:
        person: Name of the person, whose progress is kept.
        answers: Numbers by the names of the answers, in their units.

    Example:
        {"person": "ada", "answers": {"steady_error": 5.1}}
    """

    person: Person = ""
    answers: dict[FileName, float] = Field(default_factory=dict)


class LessonResult(ResponseModel):
    """The outcome of a check.

    Attributes:
        name: Name of the lesson.
        is_solved: Whether all checks are met.
        verdicts: The checks in their order.
    """

    name: str
    is_solved: bool
    verdicts: Items[LessonVerdict]
