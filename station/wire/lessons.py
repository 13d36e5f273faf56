"""Wire models of lessons: exercises that are checked on the student's own run."""

from typing import Annotated

from pydantic import Field

from station.wire.base import FileName, Items, RequestModel, ResponseModel

Person = Annotated[str, Field(max_length=100)]


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
