"""Parameters of a controller as a file: loaded again, it has the gains in force."""

from dataclasses import replace

import pytest
import yaml

from station.controllers import CONTROLLERS
from station.core.errors import ControllerNotFoundError
from station.library.gain_sets import controller_file, write_gains
from tests.api.spring import make_station
from tests.conformance.benches import bench_for

EXAMPLES = "franka_example_controllers"
WITHOUT_PARAMETER = {
    f"{EXAMPLES}/ForceExampleController": ("",),
    f"{EXAMPLES}/CartesianImpedanceExampleController": ("",),
    f"{EXAMPLES}/DualArmCartesianImpedanceExampleController": ("",),
    f"{EXAMPLES}/TeleopJointPDExampleController": ("_scaling", "force_feedback_"),
    # That of the start.
    "impedance_controllers/CartesianImpedanceController": ("/posture",),
}
"""Parts of the names of gains that come from no parameter, by type of controller."""


def other(values, schema):
    """Return values in their ranges, none of which is the value before."""
    found = {}
    for name, value in values.items():
        lower, upper = schema[name].minimum, schema[name].maximum
        if name.endswith("i_clamp_min"):
            found[name] = -3.0
        elif (lower, upper) == (0.0, 1.0) and value in {0.0, 1.0}:
            found[name] = 1.0 - value
        else:
            found[name] = (
                (value + upper) / 2.0 if value < upper else (lower + upper) / 2
            )
    return found


@pytest.mark.parametrize("controller_type", CONTROLLERS)
def test_a_controller_loaded_from_the_file_has_the_gains_in_force(controller_type):
    bench = bench_for(controller_type)
    before = bench.manager.get_controller("it")
    tunables = before.tunables
    wanted = other(tunables.values, tunables.schema)
    tunables.apply(tunables.checked(wanted))
    params = bench.parameters.namespace("it")

    unwritten = write_gains(params, tunables, type(before).declared_parameters())

    again = bench_for(controller_type, **params.get())
    found = again.manager.get_controller("it").tunables.values
    changed = {name for name, value in found.items() if value != wanted[name]}
    assert {line.split(":")[0] for line in unwritten} == changed
    parts = WITHOUT_PARAMETER.get(controller_type, ())
    assert changed == {name for name in wanted if any(part in name for part in parts)}


@pytest.fixture
def station():
    station = make_station()
    station.load_controller("one", "test/Spring", {"joint": "j", "k": 2.0})
    station.loop.step()
    return station


def test_what_was_not_tuned_stands_as_it_was_written(station):
    file = controller_file(station, "one")

    assert file.startswith("# Parameters of one with its gains in force.\n")
    assert yaml.safe_load(file) == {
        "one": {"type": "test/Spring", "joint": "j", "k": 2.0}
    }


def test_a_tuned_gain_is_in_the_file_and_the_tree_stays(station):
    tunables = station.manager.get_controller("one").tunables
    tunables.apply({"k": 3.5})

    assert yaml.safe_load(controller_file(station, "one"))["one"]["k"] == 3.5
    assert station.parameters.get("one/k") == 2.0


def test_a_gain_without_a_parameter_is_named_in_a_comment(station):
    controller = station.manager.get_controller("one")
    schema, values = controller.tunables.schema, controller.tunables.values
    schema["extra"] = replace(schema["k"])
    values["extra"] = 1.0
    controller.tunables.apply({**values, "extra": 4.0})

    assert "# No parameter of one: extra: 4\n" in controller_file(station, "one")


def test_an_unknown_controller_is_refused(station):
    with pytest.raises(ControllerNotFoundError):
        controller_file(station, "two")
