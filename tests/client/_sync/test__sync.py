"""The client for plain Python is generated from the client for asyncio."""

import inspect
import runpy
from pathlib import Path

import pytest

import station.client

ROOT = Path(__file__).parents[3]
KINDS = ["StationClient", "RobotClient", "GripperClient", "SimulationClient"]


def test_the_generated_modules_are_up_to_date():
    generator = runpy.run_path(str(ROOT / "tools" / "generate_client.py"))

    assert generator["stale"]() == [], "run tools/generate_client.py"


def test_a_module_that_was_edited_or_left_behind_is_found(tmp_path):
    generator = runpy.run_path(str(ROOT / "tools" / "generate_client.py"))
    for name, text in generator["generate"]().items():
        (tmp_path / name).write_text(text)
    (tmp_path / "robot_client.py").write_text("")
    (tmp_path / "left_behind.py").write_text("")
    generator["stale"].__globals__["TARGET"] = tmp_path

    assert generator["stale"]() == ["left_behind.py", "robot_client.py"]


@pytest.mark.parametrize("kind", KINDS)
def test_both_clients_have_the_same_methods(kind):
    def methods(client):
        members = inspect.getmembers(client, inspect.isfunction)
        return {
            name: str(inspect.signature(member)).partition(" ->")[0]
            for name, member in members
            if not name.startswith("_")
        }

    blocking = methods(getattr(station.client, kind))
    assert blocking == methods(getattr(station.client, f"Async{kind}"))
    assert blocking
