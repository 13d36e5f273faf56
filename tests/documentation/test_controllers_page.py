"""docs/controllers.md lists every controller; each declares the parameters it reads."""

import re
from dataclasses import dataclass, field
from functools import cache

import pytest

from station.controllers import CONTROLLERS
from station.core.control.controller_factory import COMMON_PARAMETERS
from station.core.parameters import Parameters
from tests.api.openapi_document import operations
from tests.conformance.benches import JOINTS, bench_for
from tests.documentation.shell_examples import ROOT
from tests.for_each import for_each

PAGE = (ROOT / "docs" / "controllers.md").read_text()
GETTERS = ("get_float", "get_int", "get_bool", "get_str", "get_str_list")


def table(heading: str) -> list[list[str]]:
    """Return the cells of the table below a heading, without its head.

    A row without a first cell goes on with the cells of the row above.
    """
    section = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows: list[list[str]] = []
    for line in [line for line in section.splitlines() if line.startswith("|")][2:]:
        cells = [cell.strip() for cell in line[1:-1].split("|")]
        if cells[0]:
            rows.append(cells)
        else:
            rows[-1] = [
                ", ".join(filter(None, both))
                for both in zip(rows[-1], cells, strict=True)
            ]
    return rows


TYPES = {row[0].strip("`"): row for row in table("Types")}


# Sensors publish under their own names.
SENSORS = {"mock_wrench": "`<sensor>`", "mock_imu": "`<sensor>`"}


@dataclass
class Reading:
    """A controller after loading, and what it asked the parameters for.

    Attributes:
        bench: Where it runs.
        status: Its status.
        controller: The controller.
        defaults: By key: the defaults given; nothing for a key that is only looked at.
    """

    bench: object
    status: object
    controller: object
    defaults: dict[str, list[object]] = field(default_factory=dict)


@cache
def reading_of(controller_type: str) -> Reading:
    """Load a controller and note every parameter of its own that it reads."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        return load_and_note(controller_type, monkeypatch)


def load_and_note(controller_type: str, monkeypatch: pytest.MonkeyPatch) -> Reading:
    asked: dict[str, list[object]] = {}

    def note(view, key, *defaults):
        path = view.resolve(key)
        if path.startswith("it/"):
            name = re.sub("|".join(JOINTS), "<joint>", path.removeprefix("it/"))
            asked.setdefault(name, []).extend(defaults)

    def watch(name):
        original = getattr(Parameters, name)

        def getter(view, key="", default=None):
            note(view, key, *([default] if name in GETTERS else []))
            return original(view, key, default)

        monkeypatch.setattr(Parameters, name, getter)

    for name in ("get", *GETTERS):
        watch(name)
    has = Parameters.has

    def looked_at(view, key):
        note(view, key)
        return has(view, key)

    monkeypatch.setattr(Parameters, "has", looked_at)
    bench = bench_for(controller_type)
    (status,) = bench.manager.list_controllers()
    return Reading(bench, status, bench.manager.get_controller("it"), asked)


def test_all_types_are_told():
    assert sorted(TYPES) == sorted(CONTROLLERS)


@for_each("controller_type", CONTROLLERS)
def test_the_interface_is_the_one_that_is_claimed(controller_type):
    reading = reading_of(controller_type)
    claims = reading.status.claimed_resources
    told = [cell.strip("`") for cell in TYPES[reading.status.type][1].split(", ")]

    assert [c.hardware_interface.rpartition("::")[2] for c in claims] == told


@for_each("controller_type", CONTROLLERS)
def test_what_it_takes_is_told(controller_type):
    reading = reading_of(controller_type)
    controller = reading.controller
    ports = {
        "set-points": controller.set_points,
        "goals": controller.goals,
        "trajectories": controller.trajectories,
    }
    takes = [name for name, port in ports.items() if port is not None]

    assert TYPES[reading.status.type][2] == (", ".join(takes) or "nothing")


def test_the_resources_that_stand_for_topics_and_actions_exist():
    cells = [row[1] for row in table("Topics, services and actions of the originals")]
    told = re.findall(r"`([A-Z]+) ([^`?]+)", " ".join(cells))
    routes = {(verb, path.replace("…", "/controllers/{name}")) for verb, path in told}
    known = {
        (verb, path.removeprefix("/api/v1").replace("{goal_id}", "{id}"))
        for verb, path in operations()
    }

    assert len(routes) >= 8
    assert routes <= known


@for_each("controller_type", CONTROLLERS)
def test_every_parameter_that_is_read_is_declared_and_no_other(controller_type):
    reading = reading_of(controller_type)
    declared = reading.controller.declared_parameters()
    names = {one.name for one in (*COMMON_PARAMETERS, *declared)}

    assert set(reading.defaults) == names | {"type"}


@for_each("controller_type", CONTROLLERS)
def test_defaults_are_those_that_are_declared(controller_type):
    reading = reading_of(controller_type)
    for one in (*COMMON_PARAMETERS, *reading.controller.declared_parameters()):
        for default in reading.defaults[one.name]:
            if default is None:
                assert one.is_required or one.default_text or not one.default, one.name
            elif isinstance(default, bool | int | float | str):
                assert one.default_text or default == one.default, one.name


@for_each("name", ["state_publish_rate", "action_monitor_rate"])
def test_parameters_without_effect_are_told(name):
    assert f"`{name}`" in PAGE
