"""Named sets of gains: saved, compared, applied, and the last change taken back."""

from collections.abc import Mapping
from typing import Annotated

from fastapi import APIRouter, Path

from station.api.dependencies import Operator, ServicesDep, Viewer
from station.api.json_route import JsonRoute
from station.api.routes.problems import problems
from station.api.services import Services
from station.library import gain_sets
from station.reports import GainsChange
from station.wire import GainsChanges, GainSet, GainSetRequest, GainSets
from station.wire.gain_sets import GainSetName

router = APIRouter(
    prefix="/gain-sets", tags=["gains"], dependencies=[Viewer], route_class=JsonRoute
)
Name = Annotated[GainSetName, Path(description="Name of the set.", examples=["stiff"])]


@router.get("", responses=problems())
def list_gain_sets(services: ServicesDep) -> GainSets:
    """List the saved sets of gains."""
    return GainSets(gain_sets=services.gain_sets.names())


@router.post("/undo", dependencies=[Operator], responses=problems(409, 503))
def undo_gains(services: ServicesDep) -> GainsChanges:
    """Take the last change of gains back, whether it set gains or applied a set.

    A hundred changes are remembered, and each call takes one more back.
    """
    return _changes(services.station.tuning.undo())


@router.get("/{name}", responses=problems(404, 422))
def get_gain_set(name: Name, services: ServicesDep) -> GainSet:
    """Return a set, and where it differs from the gains in force."""
    return _gain_set(services, services.gain_sets.get(name))


@router.put("/{name}", dependencies=[Operator], responses=problems(404, 413, 422))
def save_gain_set(
    name: Name, services: ServicesDep, request: GainSetRequest | None = None
) -> GainSet:
    """Save the gains in force under a name; a set of that name is replaced."""
    saved = services.gain_sets.save(name, _chosen(request))
    return _gain_set(services, saved)


@router.delete("/{name}", dependencies=[Operator], responses=problems(404, 422))
def delete_gain_set(name: Name, services: ServicesDep) -> GainSet:
    """Delete a set; return its last content."""
    found = _gain_set(services, services.gain_sets.get(name))
    services.gain_sets.delete(name)
    return found


@router.post(
    "/{name}/apply",
    dependencies=[Operator],
    responses=problems(404, 413, 422, 503),
)
def apply_gain_set(
    name: Name, services: ServicesDep, request: GainSetRequest | None = None
) -> GainsChanges:
    """Put a set into force: all gains of all its controllers in the same cycle.

    When one value is not allowed, or a controller is not loaded, nothing changes.
    """
    return _changes(services.gain_sets.apply(name, _chosen(request)))


def _chosen(request: GainSetRequest | None) -> list[str] | None:
    return None if request is None else request.controllers


def _gain_set(services: Services, found: gain_sets.GainSet) -> GainSet:
    return GainSet.model_validate({
        "name": found.name,
        "saved_at": found.saved_at,
        "gains": found.gains,
        "differences": services.gain_sets.differences(found.name),
    })


def _changes(changes: Mapping[str, GainsChange]) -> GainsChanges:
    return GainsChanges.model_validate({"changes": changes})
