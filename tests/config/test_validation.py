"""What is wrong with a configuration is said by key, value and what is allowed."""

from math import inf

import pytest

from station.config.loading import load_config, validate
from station.core.errors import ConfigError

MINIMAL = {
    "station": {
        "rate": 1000,
        "real_time_factor": 1.0,
        "update_budget": "period",
        "controller_modules": [],
    },
    "robot": {"type": "a/B"},
    "scene": {"objects": []},
    "controllers": {},
    "start": [],
    "api": {"host": "127.0.0.1", "port": 0, "token": None},
    "ui": {"enabled": True, "port": 0, "reconnect_window": 60.0},
    "watchdog": {"enabled": True, "notice_after": 0.08, "end_after": None},
    "records": {
        "enabled": True,
        "directory": None,
        "max_bytes": 1_000_000,
        "max_count": 10,
        "incidents": 5,
    },
    "foxglove": {"enabled": False, "host": "127.0.0.1", "port": 0},
    "rosbridge": {"enabled": False, "host": "127.0.0.1", "port": 0},
    "rehearsal": {
        "operator": "off",
        "agent": "required",
        "pose_tolerance": 0.01,
        "tube": 0.03,
    },
    "fci": {"enabled": False, "host": "127.0.0.1"},
}


def place(path: tuple[str | int, ...]) -> str:
    return f"<{'/'.join(map(str, path))}>"


def test_minimal_configuration_is_valid():
    assert validate(MINIMAL, place).station.rate == 1000.0


@pytest.mark.parametrize(
    ("written", "longest"), [("period", 0.001), (0.02, 0.02), (None, inf)]
)
def test_the_budget_of_an_update_is_the_period_a_time_or_none(written, longest):
    values = {**MINIMAL, "station": {**MINIMAL["station"], "update_budget": written}}

    assert validate(values, place).station.longest_update() == longest


def test_modules_of_configured_controllers_may_be_loaded_besides_the_listed_ones():
    station = {**MINIMAL["station"], "controller_modules": ["listed.package"]}
    controllers = {"arm": {"type": "mine.arm:Arm"}, "hand": {"type": "a/Hand"}}
    values = {**MINIMAL, "station": station, "controllers": controllers}

    modules = validate(values, place).controller_modules()

    assert modules == {"listed.package", "mine.arm"}


def test_an_envelope_of_agents_is_written_in_lists():
    bounds = {"joints": {"panda_joint1": [-1, 1]}, "workspace": {"z": [0.1, 0.8]}}

    envelope = validate(
        {**MINIMAL, "agents": {"envelope": bounds}}, place
    ).agents.envelope

    assert envelope.joints == {"panda_joint1": (-1.0, 1.0)}
    assert envelope.workspace == {"z": (0.1, 0.8)}


@pytest.mark.parametrize(
    ("bounds", "message"),
    [
        ({"joints": {"j": [1, -1]}}, "it must be two numbers, the lower one first."),
        ({"joints": {"j": 1.0}}, "it must be two numbers, the lower one first."),
        ({"joints": {"j": [0.1]}}, "agents.envelope.joints.j[1] is missing."),
        ({"joints": {"j": ["-1", 1]}}, "joints.j[0] is '-1'; it must be a number."),
        ({"workspace": {"w": [0, 1]}}, "workspace.w is 'w'; it must be"),
    ],
)
def test_an_impossible_range_of_an_envelope_is_refused(bounds, message):
    with pytest.raises(ConfigError) as caught:
        validate({**MINIMAL, "agents": {"envelope": bounds}}, place)

    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("section", "value", "message"),
    [
        (
            "foo",
            1,
            "<foo>: foo is unknown; allowed are station, robot, scene, controllers",
        ),
        (
            "api",
            {"host": "h", "port": 0, "token": None, "allowed_origins": ["*"]},
            "allowed_origins[0] is '*'; it must be scheme, host and port of a page",
        ),
        (
            "api",
            {"host": "h", "port": 0, "token": None, "prot": 1},
            "<api/prot>: api.prot is unknown; allowed are host, port, token, tls, "
            "allowed_origins.",
        ),
        (
            "station",
            {"rate": "fast", "real_time_factor": 1.0},
            "<station/rate>: station.rate is 'fast'; it must be a number.",
        ),
        (
            "station",
            {"rate": 1e6, "real_time_factor": 1.0},
            "station.rate is 1000000.0; it must be less than or equal to 10000.",
        ),
        (
            "station",
            {"rate": 1000, "real_time_factor": 1e-6},
            "station.real_time_factor is 1e-06; it must be 0.01 to 100.",
        ),
        (
            "station",
            {"rate": 1000, "real_time_factor": 101.0},
            "station.real_time_factor is 101.0; it must be 0.01 to 100.",
        ),
        (
            "station",
            {**MINIMAL["station"], "update_budget": [0.1]},
            "<station/update_budget>: station.update_budget is [0.1]; it must be a "
            "number greater than 0, 'period' or null.",
        ),
        (
            "api",
            {"host": "h", "port": 0, "token": "short"},
            "api.token is a text of 5 characters; it must be text of 8 characters or "
            "more.",
        ),
        (
            "api",
            {"host": "", "port": 0, "token": None},
            "api.host is ''; it must be some text.",
        ),
        (
            "cameras",
            {"cell": {"position": [0, 0, 1], "target": [0, 0, 0], "fow": 1}},
            "cameras.cell.fow is unknown; allowed are frame, position, target, up, fov",
        ),
        (
            "ui",
            {"enabled": 1, "port": 0, "reconnect_window": 0.0},
            "ui.enabled is 1; it must be true or false.",
        ),
        ("ui", {"port": 0, "reconnect_window": 0.0}, "ui.enabled is missing."),
        ("ui", 3, "ui is 3; it must be a mapping."),
        ("start", "arm", "start is 'arm'; it must be a list."),
        ("start", ["arm"], "<start/0>: start[0] is 'arm'; allowed are the names"),
        ("robot", {"type": "franka"}, "it must be package/Class"),
        ("controllers", {"arm": {}}, "controllers.arm.type is missing."),
        ("controllers", {"a b": {"type": "a/B"}}, "controllers.a b is 'a b'; it must"),
        (
            "controllers",
            {"robot": {"type": "a/B"}},
            "controllers.robot has a name that is taken",
        ),
    ],
)
def test_problem_is_named(section, value, message):
    with pytest.raises(ConfigError) as caught:
        validate({**MINIMAL, section: value}, place)

    assert message in str(caught.value)


def test_every_problem_is_named_at_once():
    values = {
        **MINIMAL,
        "station": {**MINIMAL["station"], "update_budget": -1.0},
        "ui": {**MINIMAL["ui"], "enabled": 1, "port": -1},
        "start": [3],
    }

    with pytest.raises(ConfigError) as caught:
        validate(values, place)

    assert len(caught.value.problems) == 4


def test_long_values_are_shortened():
    with pytest.raises(ConfigError) as caught:
        validate({**MINIMAL, "start": "x" * 1000}, place)

    assert len(str(caught.value)) < 200


def test_defaults_are_valid():
    assert load_config().start == ["joint_state_controller"]
