"""Run-time parameters of controllers: read, change and undo them, keep them in sets."""

from collections.abc import Mapping
from typing import Annotated

from fastapi import Header, Path, Request, Response

from station import wire
from station.api import answers
from station.api.audit import note_mark
from station.api.dependencies import ServicesDep, StationDep
from station.api.errors import ProblemError
from station.api.routes.routing import change, problems, routes_of
from station.api.services import Services
from station.core.facade.station import Station
from station.library import gain_sets
from station.reports import GainsChange
from station.wire.base import FileName
from station.wire.controllers import GainsOfControllersPatch

router = routes_of("gains")


def etag_of(station: Station, revision: int) -> str:
    """Return the entity tag of a revision; it differs between runs of the station."""
    return f'"{station.boot_id[:12]}-{revision}"'


@router.get("/controllers/{name}/gains", responses=problems(404))
def get_gains(name: str, response: Response, station: StationDep) -> wire.Gains:
    """Return the gains, the unit and range of each, and their ETag."""
    found = station.tuning.gains(name)
    etag = etag_of(station, found.revision)
    response.headers["ETag"] = etag
    return answers.gains(found, etag)


@router.patch("/controllers/{name}/gains", **change(404, 412, 413, 422, 503))
def patch_gains(
    name: str,
    request: wire.GainsPatch,
    connection: Request,
    response: Response,
    station: StationDep,
    if_match: Annotated[str | None, Header()] = None,
) -> GainsChange:
    """Change some gains; all of them take effect in the same cycle.

    All values are checked together: if one is not allowed, no value changes. With
    If-Match the change is refused if the gains have changed since.
    """
    revision = None
    if if_match is not None and if_match.strip() != "*":
        revision = _matching_revision(station, name, if_match)
    change = station.tuning.set_gains(name, request.values, revision)
    response.headers["ETag"] = etag_of(station, change.revision)
    old, new = change.previous, change.values
    changed = (f"{key} {old[key]:g} → {new[key]:g}" for key in request.values)
    note_mark(connection, f"gains {', '.join(changed)}")
    return change


@router.patch("/gains", **change(404, 412, 413, 422, 503))
def patch_gains_of_controllers(
    request: GainsOfControllersPatch, station: StationDep
) -> wire.GainsChanges:
    """Change gains of several controllers; all of them take effect in the same cycle.

    All changes are checked together, and undone together.
    """
    changes = station.tuning.set_many(request.changes, request.revisions)
    return wire.GainsChanges.model_validate({"changes": changes})


def _matching_revision(station: Station, name: str, if_match: str) -> int:
    """Return the present revision if If-Match names it.

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


Name = Annotated[FileName, Path(description="Name of the set.", examples=["stiff"])]


@router.get("/gain-sets", responses=problems())
def list_gain_sets(services: ServicesDep) -> wire.GainSets:
    """List the saved sets of gains."""
    return wire.GainSets(
        gain_sets=services.gain_sets.names(),
        undoable_changes=services.station.tuning.undoable_changes,
    )


@router.post("/gain-sets/undo", **change(409, 503))
def undo_gains(services: ServicesDep) -> wire.GainsChanges:
    """Undo the last change of gains, whether it set gains or applied a set.

    The station remembers a hundred changes, and each call undoes one more.
    """
    return _changes(services.station.tuning.undo())


@router.get("/gain-sets/{name}", responses=problems(404, 422))
def get_gain_set(name: Name, services: ServicesDep) -> wire.GainSet:
    """Return a set, and its differences from the gains in force."""
    return _gain_set(services, services.gain_sets.get(name))


@router.put("/gain-sets/{name}", **change(404, 413, 422))
def save_gain_set(
    name: Name, services: ServicesDep, request: wire.GainSetRequest | None = None
) -> wire.GainSet:
    """Save the gains in force under a name; they replace a set of the same name."""
    saved = services.gain_sets.save(name, _chosen(request))
    return _gain_set(services, saved)


@router.delete("/gain-sets/{name}", **change(404, 422))
def delete_gain_set(name: Name, services: ServicesDep) -> wire.GainSet:
    """Delete a set; return it."""
    found = _gain_set(services, services.gain_sets.get(name))
    services.gain_sets.delete(name)
    return found


@router.post("/gain-sets/{name}/apply", **change(404, 413, 422, 503))
def apply_gain_set(
    name: Name, services: ServicesDep, request: wire.GainSetRequest | None = None
) -> wire.GainsChanges:
    """Put a set into force: all gains of all its controllers in the same cycle.

    If one value is not allowed, or a controller is not loaded, nothing changes.
    """
    return _changes(services.gain_sets.apply(name, _chosen(request)))


def _chosen(request: wire.GainSetRequest | None) -> list[str] | None:
    return None if request is None else request.controllers


def _gain_set(services: Services, found: gain_sets.GainSet) -> wire.GainSet:
    return wire.GainSet.model_validate({
        "name": found.name,
        "saved_at": found.saved_at,
        "gains": found.gains,
        "differences": services.gain_sets.differences(found.name),
    })


def _changes(changes: Mapping[str, GainsChange]) -> wire.GainsChanges:
    return wire.GainsChanges.model_validate({"changes": changes})
