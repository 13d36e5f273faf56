"""Every verb has a function and arguments; an unknown word gets the nearest."""

import json

import pytest

from station.cli import main
from station.cli.parser import Parser, parse
from station.cli.verbs import VERBS

USELESS = [
    ("scene list foo", "name ('foo')"),
    ("scene saved foo", "name ('foo')"),
    ("scene remove wall a=b", "KEY=VALUE"),
    ("control show --owner ada", "--owner ('ada')"),
    ("token list ada", "NAME ('ada')"),
    ("token list --role viewer", "--role ('viewer')"),
    ("agents list 5f", "NUMBER ('5f')"),
    ("record list foo", "NAME ('foo')"),
    ("record start x --format csv", "--format ('csv')"),
    ("record stop --note x", "--note ('x')"),
    ("incidents list foo", "ID ('foo')"),
    ("bench step j1 --frequency 1", "--frequency ([1.0])"),
    ("bench relay j1 --rule pid", "--rule ('pid')"),
]
"""Words and options that an action has no use for."""
TWICE = [
    "gains set arm j1/p=6 j1/p=5",
    "reset j1=1 j1=2",
    "scene put wall role=fence role=keep_out",
    "lesson check p_alone a=1 a=2",
    "robot panda set_load mass=1 mass=2",
    'parameters set a {"b":1,"b":2}',
]
"""Lines that give a value twice."""
LINES = {
    "run": "run",
    "fci": "fci station.yaml --host 127.0.0.2 --patience 0.1 --desk",
    "ui": "ui",
    "doctor": "doctor",
    "fetch_robot": "fetch_robot",
    "list_controllers": "list_controllers -v --claimed-interfaces",
    "list": "list",
    "list_controller_types": "list_controller_types",
    "list_types": "list_types",
    "list_hardware_interfaces": "list_hardware_interfaces -v",
    "load_controller": "load_controller arm arm.yaml --type a/B",
    "load": "load arm",
    "configure_controller": "configure_controller arm",
    "cleanup_controller": "cleanup_controller arm",
    "set_controller_state": "set_controller_state arm active",
    "list_hardware_components": "list_hardware_components -v",
    "set_hardware_component_state": "set_hardware_component_state panda inactive",
    "unload_controller": "unload_controller arm",
    "unload": "unload arm",
    "switch_controllers": "switch_controllers --activate a b --deactivate c",
    "start": "start a b",
    "spawn": "spawn a",
    "spawner": "spawner arm",
    "kill": "kill a",
    "gains": "gains show arm",
    "bench": "bench relay j1 --relay-gain 50",
    "lesson": "lesson check p_alone steady_error=5",
    "parameters": "parameters get",
    "reload_controller_libraries": "reload_controller_libraries",
    "echo": "echo joint_states --rate full",
    "command": "command arm 1 2",
    "gripper": "gripper panda grasp 0.03 20 --inner 0.01 --no-wait",
    "control": "control take --owner ada --force",
    "token": "token create ada --role viewer",
    "rehearse": "rehearse arm ready --seconds 2",
    "scene": "scene list",
    "view_controller_chains": "view_controller_chains --dot",
    "agents": "agents allow 5f0c81e09ab3",
    "mcp": "mcp --name tuner --journal calls.jsonl",
    "events": "events --follow --kind stop",
    "sweep": "sweep arm load=0:3",
    "robustness": "robustness arm --trials 5",
    "tune": "tune arm --live",
    "identify": "identify joint1",
    "validate": "validate robot.urdf ros.yaml --page card.html",
    "experiments": "experiments best x --count 3",
    "record": "record start walk --note heavy",
    "recover_file": "recover_file walk.mcap",
    "incidents": "incidents list",
    "goto": "goto arm 1 -2 --duration 3",
    "motion_sequence": "motion_sequence arm FILE",
    "stop": "stop",
    "release": "release --arm",
    "recover": "recover panda --restart",
    "pause": "pause",
    "resume": "resume",
    "step": "step 100",
    "reset": "reset panda_joint1=0.5",
    "robot": "robot panda set_load mass=0.5",
}


def test_every_verb_is_tried_here():
    assert {name for verb in VERBS for name in (verb.name, *verb.aliases)} == set(LINES)


@pytest.mark.parametrize("verb", LINES)
def test_verb_is_parsed_and_has_its_function(verb):
    options = parse(LINES[verb].split())

    assert callable(options.run)
    assert options.json is False


ALONE = {
    *("run", "fci", "doctor", "fetch_robot", "recover_file"),
    *("sweep", "robustness", "identify", "validate"),
}


@pytest.mark.parametrize("verb", sorted(set(LINES) - ALONE))
def test_client_verbs_can_name_the_station(verb):
    line = f"{LINES[verb]} --url http://x --token t --json"

    options = parse(line.split())

    assert (options.url, options.token, options.json) == ("http://x", "t", True)


def test_strictness_is_one_or_the_other():
    with pytest.raises(SystemExit):
        parse(["switch_controllers", "--strict", "--best-effort"])


def test_controller_files_add_up():
    line = "run station.yaml --controllers a.yaml b.yaml --controllers c.yaml"

    options = parse(line.split())

    assert options.config.name == "station.yaml"
    assert [path.name for path in options.controllers] == ["a.yaml", "b.yaml", "c.yaml"]


@pytest.fixture
def parser():
    parser = Parser(prog="station")
    verbs = parser.add_subparsers(metavar="VERB", dest="verb")
    for name in ("list_controllers", "load_controller", "gains", "goto", "run"):
        verbs.add_parser(name)
    return parser


def test_an_unknown_verb_gets_the_nearest(parser, capsys):
    with pytest.raises(SystemExit) as end:
        parser.parse_args(["list_controler"])

    assert end.value.code == 2
    assert "Did you mean 'list_controllers'?" in capsys.readouterr().err


def test_a_known_verb_is_taken(parser):
    assert parser.parse_args(["gains"]).verb == "gains"


@pytest.mark.parametrize(("line", "useless"), USELESS)
def test_a_word_that_has_no_use_is_refused(run, station, line, useless):
    outcome = run(line)

    assert (outcome.code, outcome.out, station.calls) == (2, "", [])
    assert f"has no use for {useless}" in outcome.err


@pytest.mark.parametrize("line", TWICE)
def test_a_value_that_is_given_twice_is_refused(run, station, line):
    outcome = run(line)

    assert (outcome.code, outcome.out, station.calls) == (2, "", [])
    assert " is given twice: " in outcome.err


@pytest.mark.parametrize(
    "line",
    ["echo loop -n 0", "scene foo", "stop --foo", "goto ready --duration nan"],
)
def test_wrong_usage_is_told_as_json_to_a_program(capsys, line):
    assert main([*line.split(), "--json"]) == 2

    told = json.loads(capsys.readouterr().err)
    assert told["code"] == "usage"
    assert told["detail"].endswith(".")
    assert not told["detail"].endswith("..")
