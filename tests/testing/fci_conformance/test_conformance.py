"""The checks of an endpoint: ours passes; an arm without errors is found out."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from station.app.fci_run import features_of
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.fci.server.robot_session import ClientFeatures
from station.hw.franka.fci.wire.robot_protocol import (
    FR3,
    PANDA,
    Architecture,
    System,
)
from station.hw.franka.franka_parameters import read_parameters
from station.hw.franka.simulated.franka_world import simulate_one
from station.testing.fci_conformance import dialog, plugin
from tests.hw.franka.scripted_arm import ScriptedArm
from tests.testing.fci_conformance.pumped_endpoint import run_checks


@pytest.mark.slow
@pytest.mark.parametrize(
    "protocol",
    [
        FR3[-1],
        *(pytest.param(one, marks=pytest.mark.long) for one in (PANDA, *FR3[:-1])),
    ],
    ids=lambda one: f"version {one.version}",
)
def test_simulated_arm_passes(protocol, tmp_path, monkeypatch, capsys):
    robot = {
        "arm": "panda" if protocol is PANDA else "fr3",
        "arm_id": "panda",
        "robot_description": "example-robot-data:panda",
    }
    root = Parameters(ParameterTree({"robot": robot}))
    parameters = read_parameters(root.namespace("robot"))
    arm = simulate_one(parameters, root).arms["panda"]
    _, rows, report = run_checks(
        arm,
        tmp_path,
        monkeypatch,
        features=replace(
            features_of(parameters, protocol.version, pytest.fail),
            libraries={(Architecture.X64, System.LINUX): b"\x7fELF"},
        ),
        arguments=["--fci-move"],
    )
    failed = {check: row for check, row in rows.items() if row["result"] == "failed"}
    assert not failed, capsys.readouterr().out
    passed = [row for row in rows.values() if row["result"] == "passed"]
    assert len(passed) > 60, capsys.readouterr().out
    assert report["version"] == protocol.version
    assert all(row["expected"] for row in rows.values() if row["result"] == "passed")


def test_reflex_before_a_state_shows_the_motion_is_the_end_of_the_motion(
    tmp_path, monkeypatch, capsys
):
    # An ideal arm feels in its first cycle that a load is not there.
    robot = {
        "arm": "panda",
        "arm_id": "panda",
        "robot_description": "example-robot-data:panda",
        "realism": "ideal",
    }
    root = Parameters(ParameterTree({"robot": robot}))
    arm = simulate_one(read_parameters(root.namespace("robot")), root).arms["panda"]
    _, rows, _ = run_checks(
        arm,
        tmp_path,
        monkeypatch,
        features=ClientFeatures(),
        arguments=["--fci-move", "-k", "load_that_is_not_there"],
    )
    check = "load that is not there ends in a reflex"
    assert rows[check]["result"] == "passed", capsys.readouterr().out


def test_the_load_of_a_check_goes_even_if_the_endpoint_falls_silent(
    tmp_path, monkeypatch
):
    arm, loads = ScriptedArm(), []

    def fall_silent(*_):
        loads.append(arm.state.m_load)
        raise dialog.FciSilenceError("no newer state")

    monkeypatch.setattr(dialog.Dialog, "move", fall_silent)
    check = "load that is not there ends in a reflex"
    _, rows, _ = run_checks(
        arm,
        tmp_path,
        monkeypatch,
        features=ClientFeatures(),
        arguments=["--fci-move", "-k", "load_that_is_not_there"],
    )

    assert rows[check]["result"] == "failed"
    assert (loads, arm.state.m_load) == ([2.5], 0.0)


def test_checks_that_move_are_left_out_unless_asked_for(tmp_path, monkeypatch, capsys):
    arm = ScriptedArm()
    code, rows, report = run_checks(
        arm, tmp_path, monkeypatch, features=ClientFeatures()
    )
    assert code == 1
    assert not arm.sent
    assert rows["stop preempts a motion"]["result"] == "skipped: it moves the arm"
    assert rows["accelerometers feel gravity"]["result"] == "not in this version"
    assert rows["version is agreed"] == {
        "check": "version is agreed",
        "area": "reading",
        "result": "passed",
        "expected": "Connect with version 5: success, version 5",
        "seen": "success, version 5",
    }
    assert report["moved"] is False
    said = capsys.readouterr().out
    assert "Franka Control Interface 5 at " in said
    # This arm tells no gravity and has no model.
    gravity = rows["gravity is told"]
    assert gravity["result"] == "failed"
    assert gravity["seen"] == "(0, 0, 0) m/s²"
    assert "expected: O_ddP_O is 9.81 m/s²" in said
    assert rows["model library is sent"]["result"] == "failed"


def test_arm_without_errors_is_found_out(tmp_path, monkeypatch):
    """An arm that follows each command, and tells no names of errors."""
    arguments = ["--fci-move", "-k", "jump or silence or singular or preempts"]
    code, rows, _ = run_checks(
        ScriptedArm(),
        tmp_path,
        monkeypatch,
        features=ClientFeatures(),
        arguments=arguments,
    )
    assert code == 1
    assert rows["stop preempts a motion"]["result"] == "passed"
    silence = rows["error by its cause: silence of positions at rest"]
    assert silence["seen"] == "reflex aborted; robot mode 4; recovery: idle"
    jumps = [row["result"] for check, row in rows.items() if "jump" in check]
    assert jumps == ["failed"] * 7
    jump = rows["error by its cause: jump of a joint position by 5 mrad"]
    assert jump["seen"].startswith("success")
    assert "joint_motion_generator_velocity_discontinuity" in jump["expected"]


@pytest.mark.parametrize(
    ("late_at", "result", "told"),
    [
        ([300], "passed", "0.0800 rad further"),
        pytest.param(
            range(0, 10_000, 200),
            "failed",
            "this side was late in 28 cycles",
            marks=pytest.mark.long,
        ),
    ],
)
def test_check_is_made_again_if_this_side_was_late(
    late_at, result, told, tmp_path, monkeypatch
):
    _, rows, _ = run_checks(
        ScriptedArm(),
        tmp_path,
        monkeypatch,
        features=ClientFeatures(),
        arguments=["--fci-move", "-k", "goes_where_it_is_told"],
        late_at=late_at,
    )
    row = rows["motion goes where it is told"]
    assert row["result"] == result
    assert told in row["seen"]


def test_server_of_something_else_is_named(monkeypatch):
    class WebServer:
        udp_port = 1

        def __init__(self, *_arguments, **_options):
            pass

        def send(self, data):
            pass

        def receive(self, _timeout):
            return b"HTTP/1.0 400 Bad Request"

        def close(self):
            pass

    monkeypatch.setattr(dialog, "FciNetwork", WebServer)
    options = {"--fci": "arm", "--fci-port": 80}
    config = SimpleNamespace(
        getoption=options.get, stash={}, addinivalue_line=lambda *_: None
    )
    told = "arm:80 does not answer as a robot: libfranka: Unexpected answer to command"
    with pytest.raises(pytest.UsageError, match=told):
        plugin.pytest_configure(config)
