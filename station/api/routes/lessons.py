"""Lessons: exercises that the station checks on the student's own run."""

from typing import Annotated

from fastapi import Path, Query

from station.api.dependencies import AccessDep, ServicesDep
from station.api.routes.routing import change, problems, routes_of
from station.wire.base import FileName
from station.wire.lessons import (
    Lesson,
    LessonBeginRequest,
    LessonCheckRequest,
    LessonResult,
    Lessons,
)

router = routes_of("lessons", "/lessons")
Name = Annotated[
    FileName, Path(description="Name of the lesson.", examples=["damping"])
]
Person = Annotated[
    str,
    Query(
        max_length=100,
        description="Person whose progress is told; the bearer of the token if empty.",
        examples=["ada"],
    ),
]


@router.get("", responses=problems(422))
def list_lessons(
    services: ServicesDep, access: AccessDep, person: Person = ""
) -> Lessons:
    """List the lessons in their order, with the progress of a person."""
    return services.lessons.lessons(person or access.name)


@router.post("/{name}/begin", **change(404, 413, 422))
def begin_lesson(
    name: Name, request: LessonBeginRequest, services: ServicesDep, access: AccessDep
) -> Lesson:
    """Begin a lesson; the station watches the robot from now on."""
    return services.lessons.begin(name, request.person or access.name)


@router.post("/{name}/check", **change(404, 409, 413, 422))
def check_lesson(
    name: Name, request: LessonCheckRequest, services: ServicesDep, access: AccessDep
) -> LessonResult:
    """Check the robot's motions since the lesson was begun; the attempt goes on."""
    person = request.person or access.name
    return services.lessons.check(name, person, request.answers)
