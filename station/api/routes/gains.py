"""Run-time parameters of controllers: read and change them while they run."""

from typing import Annotated

from fastapi import APIRouter, Header, Response

from station.api import answers
from station.api.dependencies import Operator, StationDep, Viewer
from station.api.errors import ProblemError
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.core.facade.station import Station
from station.reports import GainsChange
from station.wire import Gains, GainsChanges, GainsPatch
from station.wire.gain_sets import GainsOfControllersPatch

router = APIRouter(tags=["gains"], dependencies=[Viewer], route_class=JsonRoute)


def etag_of(station: Station, revision: int) -> str:
    """Return the entity tag of a revision; tags differ between runs of the station."""
    return f'"{station.boot_id[:12]}-{revision}"'


@router.get("/controllers/{name}/gains", responses=problems(404))
def get_gains(name: str, response: Response, station: StationDep) -> Gains:
    """Return the gains, the unit and range of each, and their ETag."""
    found = station.tuning.gains(name)
    etag = etag_of(station, found.revision)
    response.headers["ETag"] = etag
    return answers.gains(found, etag)


@router.patch(
    "/controllers/{name}/gains",
    dependencies=[Operator],
    responses=problems(404, 412, 413, 422, 503),
)
def patch_gains(
    name: str,
    request: GainsPatch,
    response: Response,
    station: StationDep,
    if_match: Annotated[str | None, Header()] = None,
) -> GainsChange:
    """Change some gains; all of them take effect in the same cycle.

    The set is checked as a whole: when one value is not allowed, no value changes.
    With If-Match the change is refused when the gains have changed since.
    """
    revision = None
    if if_match is not None and if_match.strip() != "*":
        revision = _matching_revision(station, name, if_match)
    change = station.tuning.set_gains(name, request.values, revision)
    response.headers["ETag"] = etag_of(station, change.revision)
    return change


@router.patch(
    "/gains",
    dependencies=[Operator],
    responses=problems(404, 412, 413, 422, 503),
)
def patch_gains_of_controllers(
    request: GainsOfControllersPatch, station: StationDep
) -> GainsChanges:
    """Change gains of several controllers; all of them take effect in the same cycle.

    The change is checked as a whole, and taken back as a whole.
    """
    changes = station.tuning.set_many(request.changes, request.revisions)
    return GainsChanges.model_validate({"changes": changes})


def _matching_revision(station: Station, name: str, if_match: str) -> int:
    """Return the present revision when If-Match names it.

    Raises:
        ProblemError: If-Match names another revision.
    """
    revision = station.tuning.gains(name).revision
    etag = etag_of(station, revision)
    if etag not in {tag.strip() for tag in if_match.split(",")}:
        raise ProblemError(
            412,
            "gains_changed",
            f"The gains of '{name}' are at {etag}, not at {if_match:.200}.",
            "Read them again and repeat the change.",
        )
    return revision
