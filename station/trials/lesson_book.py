"""Read lessons from YAML files: the station's own, and those of the user."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from operator import ge, le
from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from station.core.errors import ConfigError, show, suggest
from station.core.user_files import user_folder
from station.core.yaml_reader import read_yaml
from station.trials.errors import LessonNotFoundError

_OWN = Path(__file__).parent / "lessons"
_FIGURE = re.compile(
    r"(?:(?:before\.)?(?:step|sine|chirp|multisine|relay)|now|watched|answer)"
    r"\.[a-z][a-z0-9_]*"
)


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
