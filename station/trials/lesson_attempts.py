"""Lessons, read from YAML files, and attempts at them: motions of a student's robot.

The station has lessons of its own; users may have further ones.
"""

import re
import threading
from collections.abc import Mapping
from dataclasses import dataclass
from operator import ge, le
from pathlib import Path
from typing import Annotated, Self

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from station.core.control.controller import ControllerState
from station.core.errors import ConfigError, StationError, show, suggest
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.user_files import changing, make_private_folder, user_folder
from station.core.yaml_reader import read_yaml
from station.reports import LoopState
from station.trials.bench_analysis import KeptRuns, gain_names
from station.trials.errors import ExperimentError, LessonNotFoundError
from station.trials.excitations import Array
from station.wire.excitations import (
    BenchResponse,
    Lesson,
    LessonAnswer,
    LessonResult,
    Lessons,
    LessonVerdict,
)

_OWN = Path(__file__).parent / "lessons"
_FIGURE = re.compile(
    r"(?:(?:before\.)?(?:step|sine|chirp|multisine|relay)|now|watched|answer)"
    r"\.[a-z][a-z0-9_]*"
)
_LOOK = 0.5
"""Time between two reads of the ring [s], which keeps 4 s."""
_LONGEST = 7200.0
"""Longest attempt [s]; after this time the student has surely left."""
_REFLEX = "reflex"
_PERSON = re.compile(r"[^a-z0-9]+")


class Answer(BaseModel):
    """A number that the student types.

    Attributes:
        name: Name; checks call it `answer.NAME`.
        label: Name of the answer for people.
        unit: Its unit.
        scale: Factor from this unit to the unit of the figure, > 0.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    name: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
    label: str
    unit: str = ""
    scale: Annotated[float, Field(gt=0.0)] = 1.0


class Check(BaseModel):
    """A condition on a figure.

    Attributes:
        value: The figure.
        says: The condition in words.
        hint: A likely reason of a failure, and advice.
        at_least: Smallest allowed value: a number, or a figure.
        at_most: Largest allowed value: a number, or a figure.
        near: Wanted value: a number, or a figure.
        within: Allowed deviation from `near`, as a share of it, > 0.
        times: Factor on the figures in `at_least` and `at_most`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    value: str
    says: str
    hint: str
    at_least: float | str | None = None
    at_most: float | str | None = None
    near: float | str | None = None
    within: Annotated[float, Field(gt=0.0)] = 0.1
    times: float = 1.0

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse malformed names of figures, and checks without a bound.

        Raises:
            ValueError: The name of a figure is malformed, or there is no bound.
        """
        bounds = (self.at_least, self.at_most, self.near)
        for name in (self.value, *bounds):
            if isinstance(name, str) and not _FIGURE.fullmatch(name):
                raise ValueError(f"{show(name)} is no figure, e.g. step.overshoot")
        if all(bound is None for bound in bounds):
            raise ValueError("a check needs at_least, at_most or near")
        return self

    def is_met(self, figures: Mapping[str, float]) -> bool:
        """Return whether the condition holds; False if a figure is missing."""
        value = figures.get(self.value)
        if value is None:
            return False
        for bound, holds in (
            (self.at_least, ge),
            (self.at_most, le),
        ):
            limit = self._number(bound, figures, self.times)
            if bound is not None and (limit is None or not holds(value, limit)):
                return False
        near = self._number(self.near, figures, 1.0)
        if self.near is None:
            return True
        return near is not None and abs(value - near) <= self.within * abs(near)

    @staticmethod
    def _number(
        bound: float | str | None, figures: Mapping[str, float], times: float
    ) -> float | None:
        if not isinstance(bound, str):
            return bound
        found = figures.get(bound)
        return None if found is None else times * found


class LessonText(BaseModel):
    """A lesson as it is written in its file.

    Attributes:
        title: Name for people.
        order: Place among the lessons.
        controllers: Controllers of the exercise, the main one first.
        joint: Joint of the exercise.
        text: The task, in Markdown.
        answers: Numbers that the student types.
        checks: Conditions, in the order of the page.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    title: str
    order: float = 1000.0
    controllers: Annotated[tuple[str, ...], Field(strict=False, min_length=1)]
    joint: str
    text: str
    answers: tuple[Answer, ...] = ()
    checks: Annotated[tuple[Check, ...], Field(min_length=1)]


@dataclass(frozen=True, slots=True)
class Book:
    """All lessons of a station.

    Attributes:
        lessons: Lessons by name, in their order.
        unusable: Files that are not lessons, with their faults.
    """

    lessons: Mapping[str, LessonText]
    unusable: tuple[str, ...]

    def get(self, name: str) -> LessonText:
        """Return a lesson.

        Raises:
            LessonNotFoundError: There is no such lesson.
        """
        if name not in self.lessons:
            raise LessonNotFoundError(
                f"There is no lesson '{name}'.",
                remedy=suggest(name, self.lessons),
                details={"lesson": name},
            )
        return self.lessons[name]


def open_book(folder: Path | None = None) -> Book:
    """Return the station's and the user's lessons; the latter replace equal names.

    Args:
        folder: Folder of the user's lessons, one `NAME.yaml` each; None for the default
            folder. A file that is not a lesson is left out and reported.
    """
    found: dict[str, LessonText] = {}
    unusable = []
    for place in (_OWN, user_folder("lessons") if folder is None else folder):
        for path in sorted(place.glob("*.yaml")):
            try:
                found[path.stem] = LessonText.model_validate(
                    read_yaml(path).values, strict=False
                )
            except ConfigError as error:
                unusable.append(error.message)
            except ValidationError as error:
                reasons = "; ".join(
                    f"{'.'.join(map(str, each['loc']))}: {each['msg']}"
                    for each in error.errors()
                )
                unusable.append(f"{path}: {reasons}.")
    ordered = dict(sorted(found.items(), key=lambda one: (one[1].order, one[0])))
    return Book(ordered, tuple(unusable))


class LessonWatch:
    """Collects figures of the robot's motions from the next cycle on.

    Args:
        station: The station.
        lesson: Lesson, whose controllers and joint are watched.

    Attributes:
        figures: `reflexes`, `recoveries`, `switches` between the lesson's controllers,
            `gaps` (cycles between two of these controllers in which none ran),
            `largest_speed` [rad/s or m/s] and `largest_error` [rad or m] of the joint.
    """

    def __init__(self, station: Station, lesson: LessonText) -> None:
        self._station, self._lesson = station, lesson
        self._cycle = station.loop.cycle
        self._mode, self._ran, self._gap = "", "", 0
        names = ("reflexes", "recoveries", "switches", "gaps")
        self.figures = dict.fromkeys(names, 0.0)

    def take(self) -> None:
        """Take the cycles since the last call."""
        rows = self._station.snapshots.rows_since(self._cycle)
        if not rows.modes:
            return
        self._cycle = rows.newest
        for mode in rows.modes:
            self.figures["reflexes"] += mode == _REFLEX != self._mode
            self.figures["recoveries"] += self._mode == _REFLEX != mode
            self._mode = mode
        names = self._station.joint_names
        if self._lesson.joint in names:
            states = rows.states_of_joints()[:, 1, names.index(self._lesson.joint)]
            self._keep("largest_speed", states)
        ran = [""] * len(rows)
        for controller in self._lesson.controllers:
            if controller not in {one.name for one in self._station.controllers()}:
                continue
            joints = self._station.manager.get_controller(controller).joint_names
            samples = rows.columns_of(controller, len(joints))
            for k in np.flatnonzero(~np.isnan(samples[:, 0, 0])).tolist():
                ran[k] = controller
            if self._lesson.joint in joints:
                column = list(joints).index(self._lesson.joint)
                self._keep("largest_error", samples[:, 2, column])
        self._count(ran)

    def _keep(self, name: str, values: Array) -> None:
        known = values[np.isfinite(values)]
        if len(known):
            largest = float(np.abs(known).max())
            self.figures[name] = max(largest, self.figures.get(name, 0.0))

    def _count(self, ran: list[str]) -> None:
        """Count the switches, and the cycles in which none of the controllers ran."""
        for name in ran:
            if not name:
                self._gap += self._ran != ""
                continue
            if self._ran:
                # The first cycle of a controller that starts has no sample.
                self.figures["gaps"] += max(0, self._gap - 1)
                self.figures["switches"] += name != self._ran
            self._ran, self._gap = name, 0


class LessonAttempts:
    """The lessons of a station, the present attempt, and the progress of all persons.

    Args:
        station: The station.
        runs: Kept runs of the bench; those after the beginning of an attempt belong to
            it.
        folder: Folder of the user's lessons; None for the default folder. Its subfolder
            `progress` has a YAML file for each person.
    """

    def __init__(
        self,
        station: Station,
        runs: KeptRuns,
        folder: Path | None = None,
    ) -> None:
        self._station, self._runs, self._folder = station, runs, folder
        self._lock = threading.Lock()
        self._name = ""
        self._watch: LessonWatch | None = None
        self._known: dict[str, str] = {}
        self._end = threading.Event()

    def lessons(self, person: str) -> Lessons:
        """Return all lessons with a person's progress."""
        book = open_book(self._folder)
        solved = self._progress(person)
        found = [
            Lesson(
                name=name,
                title=one.title,
                text=one.text,
                controllers=list(one.controllers),
                joint=one.joint,
                answers=[
                    LessonAnswer(name=a.name, label=a.label, unit=a.unit)
                    for a in one.answers
                ],
                is_solved=name in solved,
                is_begun=name == self._name,
            )
            for name, one in book.lessons.items()
        ]
        return Lessons(lessons=found, unusable=list(book.unusable))

    def begin(self, name: str, person: str) -> Lesson:
        """Begin an attempt; it ends the present attempt, even of another person.

        Raises:
            LessonNotFoundError: There is no such lesson.
        """
        lesson = open_book(self._folder).get(name)
        with self._lock:
            self._end.set()
            self._end = threading.Event()
            self._name = name
            self._known = {run.name: run.created_at for run in self._runs.list()}
            self._watch = LessonWatch(self._station, lesson)
            # A station that is stepped by hand needs no thread: its user asks for the
            # check.
            if self._station.loop.state is LoopState.RUNNING:
                threading.Thread(
                    target=self._look,
                    args=(self._watch, self._end),
                    name="lesson",
                    daemon=True,
                ).start()
        return next(one for one in self.lessons(person).lessons if one.name == name)

    def close(self) -> None:
        """End the present attempt."""
        with self._lock:
            self._end.set()
            self._name, self._watch = "", None

    def take(self) -> None:
        """Read the cycles since the last call; a thread does so while the loop runs."""
        with self._lock:
            if self._watch is not None:
                self._watch.take()

    def check(
        self, name: str, person: str, answers: Mapping[str, float]
    ) -> LessonResult:
        """Check the present attempt, and keep a success.

        Args:
            name: The lesson.
            person: Name of the student.
            answers: Numbers that the student has typed, by name, in the units of the
                lesson.

        Raises:
            LessonNotFoundError: There is no such lesson.
            ExperimentError: The lesson was not begun, or the progress cannot be saved.
        """
        lesson = open_book(self._folder).get(name)
        if name != self._name or self._watch is None:
            raise ExperimentError(
                f"The lesson '{name}' has not been begun, so nothing of it was seen.",
                remedy=f"Begin it: `station lesson begin {name}`.",
            )
        self.take()
        figures = self._figures(lesson, self._watch)
        for answer in lesson.answers:
            if answer.name in answers:
                figures[f"answer.{answer.name}"] = answers[answer.name] * answer.scale
        verdicts: list[LessonVerdict] = []
        for one in lesson.checks:
            is_met, value = one.is_met(figures), figures.get(one.value)
            hint = "" if is_met else one.hint
            # Missing figures get no hint of their own: the first hint says how to get
            # them.
            if value is None and not all(verdict.is_met for verdict in verdicts):
                hint = "Not measured yet."
            verdicts.append(
                LessonVerdict(says=one.says, is_met=is_met, value=value, hint=hint)
            )
        is_solved = all(verdict.is_met for verdict in verdicts)
        if is_solved:
            self._keep_solved(person, name)
        return LessonResult(name=name, is_solved=is_solved, verdicts=verdicts)

    def _look(self, watch: LessonWatch, end: threading.Event) -> None:
        looks = 0
        loop = self._station.loop
        while not end.wait(_LOOK) and looks < _LONGEST / _LOOK:
            if loop.state is not LoopState.RUNNING:
                return
            loop.cycle_yield.wait_if_cycle_is_due()
            with self._lock:
                if watch is self._watch:
                    watch.take()
            looks += 1

    def _figures(self, lesson: LessonText, watch: LessonWatch) -> dict[str, float]:
        """Return all figures of an attempt, by the names that lessons use."""
        found = {f"watched.{key}": value for key, value in watch.figures.items()}
        found |= {f"now.{key}": value for key, value in self._now(lesson).items()}
        kinds = ("step", "sine", "chirp", "multisine", "relay")
        counts = dict.fromkeys(kinds, 0)
        for summary in reversed(self._runs.list()):
            if self._known.get(summary.name) == summary.created_at:
                continue
            if summary.joint != lesson.joint:
                continue
            if summary.controller not in lesson.controllers:
                continue
            counts[summary.kind] += 1
            start = {1: "", 2: "before."}.get(counts[summary.kind])
            if start is not None:
                values = {**summary.metrics, **summary.gains}
                found |= {f"{start}{summary.kind}.{k}": v for k, v in values.items()}
            if summary.kind == "relay" and start == "":
                run = self._runs.get(summary.name)
                found["relay.applied"] = float(self._is_applied(run))
        return found | {f"{kind}.count": float(n) for kind, n in counts.items()}

    def _now(self, lesson: LessonText) -> dict[str, float]:
        station, main = self._station, lesson.controllers[0]
        state = station.latest()
        found = {"reflex": float(state.mode == _REFLEX)}
        for status in station.controllers():
            if status.name == main:
                found["running"] = float(status.state is ControllerState.RUNNING)
                gains = station.tuning.gains(main).values
                for key in ("p", "i", "d", "i_clamp_max", "i_clamp_min"):
                    for name in (f"{lesson.joint}/{key}", key):
                        if name in gains:
                            found.setdefault(key, float(gains[name]))
        arms = Arms(station.robots)
        if arms.names():
            found["load"] = float(arms.state(arms.names()[0]).m_load)
        return found

    def _is_applied(self, run: BenchResponse) -> bool:
        """Return whether the gains in force are proposals of one rule for a run."""
        try:
            now = self._station.tuning.gains(run.controller).values
        except StationError:
            return False
        names = gain_names(now, run.joint).values()
        return any(
            all(abs(now[n] - one.gains[n]) <= 1e-3 * abs(one.gains[n]) for n in names)
            for one in run.proposals
        )

    def _file(self, person: str) -> Path:
        folder = user_folder("lessons") if self._folder is None else self._folder
        name = _PERSON.sub("-", person.lower()).strip("-") or "anybody"
        return folder / "progress" / f"{name}.yaml"

    def _progress(self, person: str) -> list[str]:
        try:
            kept = read_yaml(self._file(person)).values.get("solved")
        except ConfigError:
            return []  # no lesson is solved yet, or the file is damaged
        return [str(name) for name in kept] if isinstance(kept, list) else []

    def _keep_solved(self, person: str, lesson: str) -> None:
        path = self._file(person)
        try:
            make_private_folder(path.parent)
            with changing(path.parent):
                solved = sorted({*self._progress(person), lesson})
                part = path.with_suffix(".part")
                part.write_text(yaml.safe_dump({"solved": solved}), "utf-8")
                part.replace(path)
        except OSError as error:
            raise ExperimentError(f"{path} cannot be written: {error}.") from error
