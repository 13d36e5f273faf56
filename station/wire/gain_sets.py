"""Wire models of named sets of gains."""

from typing import Annotated

from pydantic import Field

from station.reports import GainDifference, GainsChange
from station.wire.base import Items, RequestModel, ResponseModel

GainSetName = Annotated[
    str, Field(min_length=1, max_length=100, pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$")
]
"""A name that is also one segment of a URL and the name of a file."""


class GainSet(ResponseModel):
    """A saved set of gains, and where it differs from the gains in force.

    Attributes:
        name: Name of the set.
        saved_at: When it was saved, ISO 8601.
        gains: Saved values by controller and gain, each in the unit of the gain.
        differences: The gains that differ; empty when the set is in force.

    Example:
        {"name": "stiff", "saved_at": "2026-11-22T09:15:00+00:00", "gains": {"arm":
         {"panda_joint1/p": 600.0}}, "differences": [{"controller": "arm", "name":
         "panda_joint1/p", "saved": 600.0, "present": 500.0}]}
    """

    name: str
    saved_at: str
    gains: dict[str, dict[str, float]]
    differences: Items[GainDifference]


class GainSets(ResponseModel):
    """The saved sets.

    Attributes:
        gain_sets: Names of the sets, sorted.
    """

    gain_sets: Items[str]


class GainSetRequest(RequestModel):
    """Controllers whose gains are saved or applied.

    Attributes:
        controllers: Names of controllers; null or left out for all: those that are
            loaded when saving, those of the set when applying.

    Example:
        {"controllers": ["arm"]}
    """

    controllers: list[str] | None = Field(default=None, min_length=1, max_length=64)


class GainsOfControllersPatch(RequestModel):
    """Change gains of several controllers in one cycle, all of them or none.

    Attributes:
        changes: New values by controller and name, in the units and ranges of the
            gains' schema; the other gains stay.
        revisions: Revisions of the gains that the caller has read, by controller; the
            change is refused when one is another by now. Null for whatever they are.

    Example:
        {"changes": {"arm": {"panda_joint1/p": 500.0}}, "revisions": {"arm": 4}}
    """

    changes: dict[
        str, Annotated[dict[str, float], Field(min_length=1, max_length=1024)]
    ] = Field(min_length=1, max_length=64)
    revisions: dict[str, int] | None = Field(default=None, max_length=64)


class GainsChanges(ResponseModel):
    """Changes of gains in one cycle.

    Attributes:
        changes: The change of each controller, by its name.
    """

    changes: dict[str, GainsChange]
