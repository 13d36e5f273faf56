"""The verb `fci`."""

import json

import pytest

from station.app.fci_run import FciRun
from station.cli.main import main
from station.hw.franka.fci.server.fci_server import FciCounts


@pytest.fixture
def runs(monkeypatch):
    """The runs that the verb has begun; none of them serves."""
    begun = []

    def run(self):
        begun.append(self)
        self._tell("ready")
        return FciCounts()

    monkeypatch.setattr(FciRun, "run", run)
    return begun


def test_the_configured_arm_is_served_where_it_is_told(runs, tmp_path, capsys):
    file = tmp_path / "station.yaml"
    file.write_text("robot: {arm_id: left}\n", encoding="utf-8")
    code = main(["fci", str(file), "--host", "127.0.0.9", "--patience", "0.5"])
    assert code == 0
    (run,) = runs
    assert run._config.robot_parameters()["arm_id"] == "left"
    assert (run._settings.host, run._settings.patience) == ("127.0.0.9", 0.5)
    assert capsys.readouterr().out == "ready\n"


@pytest.mark.usefixtures("runs")
def test_json_is_a_line_per_message(capsys):
    assert main(["fci", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"message": "ready"}
