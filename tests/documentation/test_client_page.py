"""The examples of docs/client.md run, and its reference is whole."""

import re
import runpy
import sys
from pathlib import Path

import pytest

from station import client
from station.api.app import create_app
from station.api.auth import Authenticator
from station.api.server import ApiServer
from station.app.composition import compose
from station.client import StationClient
from station.config import load_config

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "client.md").read_text()
MOTION, STREAM = re.findall(r"^```python\n(.*?)^```", PAGE, re.S | re.M)[:2]


@pytest.fixture
def client_page(monkeypatch):
    """Return what makes the reference."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    yield runpy.run_path(str(ROOT / "tools" / "client_page.py"))
    sys.modules.pop("client_page", None)


def test_reference_is_that_of_the_docstrings(client_page):
    assert client_page["page"]() == PAGE, "run make client"


def test_reference_has_every_part_of_the_client():
    """No reader looks for `client.recordings` in the source."""
    nowhere = StationClient("http://nowhere", "token")
    for name, part in vars(nowhere).items():
        if not name.startswith("_"):
            section = PAGE.partition(f"- **{type(part).__name__}**:")[2]
            assert f"`client.{name}`" in section.partition("\n")[0]


def test_every_class_of_the_reference_can_be_looked_up(client_page):
    """The page says `python -m pydoc station.client.CLASS`."""
    for kind in client_page["CLASSES"]:
        assert getattr(client, kind.__name__, None) is kind


@pytest.mark.slow
@pytest.mark.alone
def test_examples_run(monkeypatch, capsys):
    station = compose(load_config()).station
    station.loop.start()
    try:
        with ApiServer(
            create_app(station, Authenticator("operator")), port=0
        ) as server:
            monkeypatch.setenv("STATION_URL", server.url)
            monkeypatch.setenv("STATION_TOKEN", "operator")
            exec(MOTION, {})
            width, rows, columns, _ = capsys.readouterr().out.split(maxsplit=3)
            exec(STREAM, {})
    finally:
        station.loop.stop()

    assert float(width) == pytest.approx(0.0, abs=1e-3)
    assert int(rows.strip("(,")) > 100
    assert columns == "7)"
    assert float(capsys.readouterr().out) > 1.0
