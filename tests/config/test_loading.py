"""Defaults, files, environment and flags are laid one over the other.

Environment variables name keys of the configuration.
"""

import json
from math import inf

import pytest

from station.config.loading import load_config, read_environment, validate
from station.config.models import StationConfig
from station.core.errors import ConfigError


@pytest.fixture
def write(tmp_path):
    """Return a function that writes a file and returns its path."""

    def write_file(text, name="station.yaml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write_file


def test_defaults_describe_the_panda():
    config = load_config()

    assert config.robot_parameters()["arm_id"] == "panda"
    joints = [f"panda_joint{i}" for i in range(1, 8)]
    effort = config.controller_parameters()["effort_group_position_controller"]
    assert effort["joints"] == joints
    p, d = ([effort[joint]["pid"][gain] for joint in joints] for gain in "pd")
    assert p == [200, 200, 200, 200, 60, 50, 30]
    assert d == [40, 40, 40, 40, 12, 10, 5]


def test_section_is_merged_key_by_key(write):
    config = load_config(write("station: {rate: 500}\nui: {enabled: false}"))

    assert config.station.rate == 500.0
    assert config.station.real_time_factor == 1.0
    assert config.ui.port == 8080
    assert config.start == ["joint_state_controller"]


@pytest.mark.parametrize(
    ("robot", "arm_id"),
    [
        ("{arm: fr3}", "fr3"),
        ("{arm: fr3, arm_id: left}", "left"),
        ("{arm_id: fr3}", "fr3"),
        ("{rate_limiting: true}", "panda"),
    ],
)
def test_arm_gives_its_name_to_the_joints_unless_they_have_one(write, robot, arm_id):
    config = load_config(write(f"robot: {robot}"))
    assert config.robot_parameters()["arm_id"] == arm_id
    controllers = config.controller_parameters()
    joints = controllers["position_group_controller"]["joints"]
    assert joints[6] == f"{arm_id}_joint7"


def test_arm_of_the_environment_or_command_line_gives_its_name(monkeypatch):
    assert load_config(flags={"robot.arm": "fr3"}).robot_parameters()["arm_id"] == "fr3"
    monkeypatch.setenv("STATION_ROBOT__ARM", "fr3")
    assert load_config().robot_parameters()["arm_id"] == "fr3"


@pytest.mark.parametrize("value", ["5", "null", "[left]"])
def test_an_arm_id_that_is_no_text_is_named_rather_than_its_controllers(write, value):
    with pytest.raises(ConfigError, match=r":1:17: robot.arm_id is .* must be text"):
        load_config(write(f"robot: {{arm_id: {value}}}"))


def test_default_controllers_follow_the_arm_id(write):
    config = load_config(write("robot: {arm_id: left}"))

    controller = config.controller_parameters()["effort_group_position_controller"]
    assert controller["joints"][0] == "left_joint1"
    assert controller["left_joint7"] == {"pid": {"p": 30, "i": 0, "d": 5}}


def test_controllers_of_a_file_replace_the_default_ones(write):
    config = load_config(write("controllers: {arm: {type: a/B, gains: {j: {p: 1}}}}"))

    assert config.controller_parameters() == {
        "arm": {"type": "a/B", "gains": {"j": {"p": 1}}}
    }
    assert config.start == []


def test_another_robot_gets_nothing_of_the_default_one(write):
    config = load_config(write("robot: {type: mock_hw/MockRobotHW, joints: [a]}"))

    assert config.robot_parameters() == {"type": "mock_hw/MockRobotHW", "joints": ["a"]}
    assert config.controllers == {}
    assert config.start == []


def test_controller_files_of_ros_are_added(write):
    ros = write(
        "panda:\n"
        "  arm: {type: a/B, joints: ['$(arg arm_id)_joint1']}\n"
        "  joint_limits: {panda_joint1: {max_velocity: 1}}\n",
        "ros.yaml",
    )

    config = load_config(controller_files=[ros])

    assert config.controller_parameters()["arm"] == {
        "type": "a/B",
        "joints": ["panda_joint1"],
    }
    assert "joint_state_controller" in config.controllers
    assert config.parameters == {"joint_limits": {"panda_joint1": {"max_velocity": 1}}}


def test_files_of_ros_are_merged_as_rosparam_does(write):
    left = write(
        "arm: {type: a/B, joints: [l], gains: {l: {p: 1, d: 1}}}\n"
        "joint_limits: {l: {max_velocity: 1}}",
        "left.yaml",
    )
    right = write(
        "arm: {type: a/B, gains: {l: {p: 2}}}\njoint_limits: {r: {max_velocity: 2}}",
        "right.yaml",
    )

    config = load_config(controller_files=[left, right])

    assert config.controller_parameters()["arm"] == {
        "type": "a/B",
        "joints": ["l"],
        "gains": {"l": {"p": 2, "d": 1}},
    }
    limits = {"l": {"max_velocity": 1}, "r": {"max_velocity": 2}}
    assert config.parameters == {"joint_limits": limits}
    assert config.ros_controllers == {"arm"}


@pytest.mark.parametrize("what", ["arm: {type: a/B}", "joint_limits: {j: {}}"])
def test_a_name_in_two_namespaces_of_two_files_is_refused(write, what):
    others = "x: {type: a/B}"
    files = [
        write(f"{side}: {{{what}, {side}_{others}}}", f"{side}.yaml")
        for side in ("left", "right")
    ]
    name = what.partition(":")[0]
    with pytest.raises(ConfigError, match=f"/right/{name} has .* /left/{name}"):
        load_config(controller_files=files)


@pytest.mark.parametrize("section", ["parameters", "ros_controllers"])
def test_sections_of_the_inside_are_refused(write, section):
    with pytest.raises(ConfigError, match=f"{section} is unknown"):
        load_config(write(f"{section}: []"))


def test_namespace_in_the_controllers_section_is_taken_off(write):
    text = (
        "controllers: {panda: {arm: {type: a/B}, joint_limits: {x: 1}}}\nstart: [arm]"
    )

    config = load_config(write(text))

    assert list(config.controllers) == ["arm"]
    assert config.parameters == {"joint_limits": {"x": 1}}


def test_flags_beat_environment_beats_file(write, monkeypatch):
    path = write("api: {port: 1}\nui: {port: 1}\nstation: {rate: 1}")
    monkeypatch.setenv("STATION_API__PORT", "2")
    monkeypatch.setenv("STATION_UI__PORT", "2")

    config = load_config(path, flags={"api.port": 3})

    assert (config.api.port, config.ui.port, config.station.rate) == (3, 2, 1.0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("api:\n  port: 70000", "station.yaml:2:9: api.port is 70000"),
        ("\nparameters: {}", "station.yaml:2:13: parameters is unknown"),
        ("controllers: {arm: {p: 1}}", "controllers.arm.type is missing"),
        ("start: [nobody]", "station.yaml:1:9: start[0] is 'nobody'"),
        ("robot: {type: 3}", "station.yaml:1:15: robot.type is 3"),
    ],
)
def test_problem_in_a_file_says_where(write, text, message):
    with pytest.raises(ConfigError) as caught:
        load_config(write(text))

    assert message in str(caught.value)


def test_problem_elsewhere_says_where(monkeypatch):
    monkeypatch.setenv("STATION_API__PORT", "-1")

    with pytest.raises(ConfigError) as caught:
        load_config(flags={"station.rate": 0.0})

    assert "environment variable STATION_API__PORT: api.port is -1" in str(caught.value)
    assert "command line: station.rate is 0.0" in str(caught.value)


def test_path_of_a_urdf_begins_at_the_file_that_names_it(write, tmp_path):
    path = write("robot: {robot_description: robots/arm.urdf}")
    found = load_config(path).robot_parameters()["robot_description"]
    assert found == str(tmp_path / "robots/arm.urdf")


@pytest.mark.parametrize("reference", ["example-robot-data:ur5", "/robots/arm.urdf"])
def test_other_names_of_robots_stay_as_they_are(write, reference):
    path = write(f"robot: {{robot_description: '{reference}'}}")
    found = load_config(path).robot_parameters()["robot_description"]
    assert found == reference


@pytest.mark.parametrize(
    ("variable", "text", "path", "value"),
    [
        ("STATION_API__PORT", "8001", ("api", "port"), 8001),
        ("STATION_STATION__RATE", "5e2", ("station", "rate"), 500.0),
        ("STATION_ROBOT__ARM_ID", "left", ("robot", "arm_id"), "left"),
        ("STATION_UI__ENABLED", "false", ("ui", "enabled"), False),
        ("STATION_START", '["arm"]', ("start",), ["arm"]),
        ("STATION_WATCHDOG__END_AFTER", "null", ("watchdog", "end_after"), None),
        ("STATION_ROSBRIDGE__ENABLED", "true", ("rosbridge", "enabled"), True),
        ("STATION_ROBOT__BASE_XYZ", "[1.0, 0, 0]", ("robot", "base_xyz"), [1.0, 0, 0]),
        (
            "STATION_CONTROLLERS__ARM__TYPE",
            "a/B",
            ("controllers", "arm", "type"),
            "a/B",
        ),
    ],
)
def test_variable_sets_a_key(monkeypatch, variable, text, path, value):
    monkeypatch.setenv(variable, text)

    assert list(read_environment()) == [(path, value, variable)]


def test_other_variables_are_not_ours(monkeypatch):
    monkeypatch.setenv("STATION_TOKEN", "secret")
    monkeypatch.setenv("STATION_URL", "http://robot:8000")

    assert list(read_environment()) == []


def test_variables_set_keys_of_every_section(monkeypatch):
    sections = {n for n, f in StationConfig.model_fields.items() if not f.exclude}
    for section in sections - {"start"}:
        monkeypatch.setenv(f"STATION_{section.upper()}__KEY", "1")

    found = {path[0] for path, _, _ in read_environment()}
    assert found == sections - {"start"}


def test_variable_of_an_unknown_section_is_refused(monkeypatch):
    monkeypatch.setenv("STATION_APPI__PORT", "8001")

    with pytest.raises(ConfigError, match="STATION_APPI__PORT: appi is unknown; all"):
        list(read_environment())


@pytest.mark.parametrize(
    ("section", "changed", "kept"),
    [
        ("fci", {"enabled": True}, {"host": "127.0.0.1"}),
        ("scene", {"arm_margin": 0.02}, {"objects": []}),
        ("agents", {"wait": 30.0}, {"approval": "always"}),
    ],
)
def test_section_is_combined_with_the_default_key_by_key(write, section, changed, kept):
    file = write(json.dumps({section: changed}))

    found = getattr(load_config(file), section).model_dump()
    assert {**found, **changed, **kept} == found


def test_list_that_is_no_json_is_refused(monkeypatch):
    monkeypatch.setenv("STATION_START", "arm")

    with pytest.raises(ConfigError, match="STATION_") as caught:
        list(read_environment())

    assert '["arm"]' in caught.value.remedy


def test_value_with_two_meanings_is_refused(monkeypatch):
    monkeypatch.setenv("STATION_API__PORT", "08000")

    with pytest.raises(ConfigError, match="environment variable STATION_API__PORT"):
        list(read_environment())


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
