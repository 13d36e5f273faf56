"""A simulated arm behind the Franka Control Interface, from its configuration."""

import os

import pytest

from station.app import fci_run
from station.app.composition import ROBOT_NAMESPACE, root_parameters
from station.app.fci_run import FciRobotError, FciRun, features_of
from station.config import load_config
from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.hw.franka.fci.server.model_library import ModelLibraryError
from station.hw.franka.fci.wire.robot_protocol import protocols_of
from station.hw.franka.franka_parameters import read_parameters

# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.19.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"


@pytest.fixture
def make(tmp_path, monkeypatch):
    """Make a run of a configuration that ends after three cycles; collect its lines."""
    serve = FciServer.run

    def run(server, is_over):
        left = iter(range(3))
        serve(server, lambda: is_over() or next(left, None) is None)

    monkeypatch.setattr(FciServer, "run", run)
    told, warned = [], []

    def build(text="", version=None):
        file = tmp_path / "station.yaml"
        file.write_text(text, encoding="utf-8")
        config = load_config(file, controller_files=[], flags={})
        settings = FciSettings(HOST)
        tellers = {"tell": told.append, "warn": warned.append}
        made = FciRun(config, settings, version, **tellers)
        return made, told, warned

    return build


@pytest.mark.parametrize(("version", "spoken"), [(None, "5 to 10"), (7, "7")])
def test_the_configured_arm_is_served_and_the_cycles_are_told(make, version, spoken):
    run, told, warned = make("robot: {arm_id: left}\n", version)
    assert run.run().cycles == 3
    start = f"Franka Control Interface {spoken} of arm 'left' at 127.19."
    assert told[0].startswith(start)
    assert told[1].startswith("3 cycles in ")
    assert told[1].endswith("0 of them commanded by clients, 0 commands lost")
    assert warned == []


def test_an_fr3_is_served_with_its_versions_and_a_wrong_name_is_told(make):
    run, told, warned = make("robot: {arm: fr3}\n")
    assert run.run().cycles == 3
    start = "Franka Control Interface 5 to 10 of arm 'fr3' at 127.19."
    assert told[0].startswith(start)
    assert warned == []
    run, _, warned = make("robot: {arm: fr3, arm_id: panda}\n")
    run.run()
    assert "Write arm_id: fr3" in warned[0]


def test_other_robots_are_refused(make):
    run, told, _ = make("robot: {type: mock_hw/MockRobotHW}\n")
    with pytest.raises(FciRobotError, match="mock_hw/MockRobotHW") as error:
        run.run()
    assert "franka_hw/FrankaHW" in error.value.remedy
    assert told == []


def test_without_a_compiler_the_arm_is_served_without_a_model(make, monkeypatch):
    def fail(_description):
        raise ModelLibraryError("There is no C compiler.", remedy="Install one.")

    monkeypatch.setattr(fci_run, "build_model_library", fail)
    run, _, warned = make()
    assert run.run().cycles == 3
    assert warned == [
        "Clients get no model library: There is no C compiler. Install one."
    ]


@pytest.mark.parametrize(("arm", "own"), [("panda", 5), ("fr3", 10)])
def test_arm_speaks_all_versions_and_names_its_newest_to_others(make, arm, own):
    root = root_parameters(make(f"robot: {{arm: {arm}}}\n")[0].config)
    parameters = read_parameters(root.namespace(ROBOT_NAMESPACE))
    spoken = [protocol.version for protocol in protocols_of(arm)]
    assert (sorted(spoken), spoken[-1]) == ([5, 6, 7, 8, 9, 10], own)
    assert [one.version for one in protocols_of(arm, 8)] == [8]
    features = features_of(parameters, 8, pytest.fail)
    assert f'<robot name="{arm}">' in features.robot_model
    assert [one.version for one in features.protocols] == [8]
