"""Verbs that list, load and unload controllers, and list what they can claim."""

import json

import pytest

from station.reports import examples_of
from station.wire import Hardware


def test_controllers_are_listed(run):
    outcome = run("list_controllers")

    name, state = outcome.out.splitlines()[1].split()[::2]
    assert (outcome.code, name, state) == (0, "arm", "running")


@pytest.mark.parametrize("option", ["--claimed-interfaces", "-v"])
def test_claims_are_listed_when_asked_for(run, option):
    assert "PositionJoint: j1, j2" not in run("list").out
    assert "PositionJoint: j1, j2" in run(f"list {option}").out


def test_a_fault_is_listed_unasked_and_in_one_line(run, station):
    assert "fault" not in run("list").out

    station.faults = {"arm": "update raised ValueError: two\nlines"}

    lines = run("list").out.splitlines()
    assert len(lines) == 3
    assert lines[1].endswith("update raised ValueError: two lines")


def test_list_can_be_json(run):
    controllers = json.loads(run("list-controllers --json").out)

    assert [c["name"] for c in controllers] == ["arm", "leg"]
    assert controllers[0]["claimed_resources"][0]["resources"] == ["j1", "j2"]


def test_empty_list_is_said_to_be(run, station):
    station.states = {}

    assert run("list").out == "No controllers are loaded.\n"
    assert json.loads(run("list --json").out) == []


def test_types_are_listed(run):
    assert "JointGroupPositionController" in run("list_controller_types").out
    assert json.loads(run("list-types --json").out)[0]["base_class"] == "Base"


def test_parameters_of_a_type_are_listed(run):
    group = "position_controllers/JointGroupPositionController"

    head, _, *rows = run(f"list_controller_types {group}").out.splitlines()

    assert head == f"{group}: Forwards positions."
    assert rows[0].split()[:6] == ["command_timeout", "number", "s", "0.2", ">", "0,"]
    assert "hold, stop" in rows[1]


def test_a_misspelt_type_is_answered_with_the_nearest(run):
    outcome = run("list_controller_types position_controllers/JointGroupPosition")

    assert outcome.code == 2
    assert "position_controllers/JointGroupPositionController" in outcome.err


def test_controller_is_loaded_from_the_configuration(run, station):
    assert run("load hand").code == 0
    assert station.calls == [("load", "hand", None, None)]


def test_controller_is_loaded_with_the_parameters_of_a_file(run, station, tmp_path):
    path = tmp_path / "ros.yaml"
    path.write_text("panda:\n  hand: {type: a/B, p: 1e-3}\n")

    assert run(f"load_controller hand {path} --type c/D").code == 0
    assert station.calls == [("load", "hand", "c/D", {"type": "a/B", "p": 0.001})]
    assert station.unknown_params == "tell"


def test_file_without_the_controller_is_refused(run, station, tmp_path):
    path = tmp_path / "ros.yaml"
    path.write_text("hand: {type: a/B}")

    outcome = run(f"load foot {path}")

    assert outcome.code == 2
    assert "it has controllers: hand" in outcome.err
    assert station.calls == []


def test_loading_may_be_given_more_time(run, station):
    assert run("load hand --load-timeout 120").code == 0
    assert station.load_timeout == 120.0


def test_controller_is_unloaded(run):
    assert run("unload leg").out == "Unloaded leg.\n"
    assert json.loads(run("unload leg --json").out)["name"] == "leg"


def test_types_are_reloaded(run, station):
    assert run("reload_controller_libraries").out == "Unloaded: no controller.\n"
    assert run("reload-controller-libraries --force-kill").out == "Unloaded: arm.\n"
    assert station.calls == [("reload", False), ("reload", True)]


EXAMPLE = Hardware.model_validate(examples_of(Hardware.__doc__)[0])


def test_resources_are_listed_with_who_claims_them(run, station):
    station.hardware = lambda: EXAMPLE
    outcome = run("list_hardware_interfaces")

    line = outcome.out.splitlines()[1].split()
    assert line == ["elbow_joint", "hardware_interface::EffortJointInterface", "arm"]
    assert "elbow_trans" not in outcome.out


def test_limits_transmissions_and_clamps_are_listed_when_asked_for(run, station):
    station.hardware = lambda: EXAMPLE
    out = run("list-hardware-interfaces -v").out

    assert "-3.14 to 3.14" in out
    assert "elbow_trans" in out
    assert "its range is empty" in out
    assert out.splitlines()[-1].split()[-4:] == ["12", "400", "150", "effort"]


def test_hardware_can_be_json(run, station):
    station.hardware = lambda: EXAMPLE
    told = json.loads(run("list_hardware_interfaces --json").out)
    assert told == EXAMPLE.model_dump(mode="json")


def test_chains_are_drawn_for_graphviz(run):
    graph = run("view_controller_chains --dot").out

    assert '"diff" -> "wheel" [label="joint/velocity" style=solid];' in graph
    assert '"wheel" [style=filled fillcolor="#d0e8d0"];' in graph


def test_chains_are_listed_in_the_order_of_updates(run):
    first, second = run("view_controller_chains").out.splitlines()[1:]

    assert first.split() == ["1", "diff", "running", "-", "wheel", "-"]
    assert second.split()[:5] == ["2", "wheel", "running", "chained", "-"]
    assert "reference wheel/joint/velocity (diff)" in second


def test_hardware_components_are_listed(run):
    lines = run("list_hardware_components").out.splitlines()
    assert lines[0] == "left: inactive (no cable), system, franka_hw/FrankaHW"
    assert lines[2].split() == ["j1", "EffortJoint", "commanded", "unavailable", "-"]
    assert "JointState" in run("list_hardware_components -v").out
    assert json.loads(run("list_hardware_components --json").out)[0]["name"] == "left"


def test_a_hardware_component_is_brought_into_a_state(run, station):
    outcome = run("set_hardware_component_state left active --stop-controllers")
    assert (outcome.code, outcome.out) == (0, "left is active.\n")
    options = {"stop_controllers": True}
    assert station.calls == [("component", "left", "active", options)]
    assert run("set_hardware_component_state left asleep").code == 2


@pytest.mark.parametrize(
    ("line", "call", "out"),
    [
        ("get", ("parameter", ""), {"p": 1.0}),
        ("get arm/gains", ("parameter", "arm/gains"), {"p": 1.0}),
        ("delete arm/p", ("delete_parameter", "arm/p"), 3),
    ],
)
def test_parameters_are_printed_as_json(run, station, line, call, out):
    assert json.loads(run(f"parameters {line}").out) == out
    assert station.calls == [call]


@pytest.mark.parametrize(
    ("word", "value"),
    [("0.5", 0.5), ("[1,2]", [1, 2]), ("true", True), ("panda", "panda"), ("1e", "1e")],
)
def test_a_value_is_json_or_text(run, station, word, value):
    assert run(f"parameters set arm/p {word}").out == "Done.\n"
    assert station.calls == [("set_parameter", "arm/p", value)]


@pytest.mark.parametrize("line", ["set arm/p", "delete", "get a b", "delete / ", "set"])
def test_wrong_words_are_wrong_usage(run, station, line):
    assert run(f"parameters {line}").code == 2
    assert station.calls == []
