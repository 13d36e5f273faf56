"""The file by which a dashboard knows who is logged in."""

import json
import logging

import pytest

from station.app.sessions_file import SessionsFile
from station.ui.sessions.sessions import KeptSession, Role

HERE = "http://127.0.0.1:8000"
KEPT = [
    KeptSession("cookie 1", Role.OPERATOR, "", 100.0),
    KeptSession("cookie 2", Role.VIEWER, "named", 200.5),
]


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    return tmp_path / "station"


def test_what_was_saved_is_loaded_by_the_next_dashboard():
    SessionsFile(8080, HERE).save(KEPT)
    assert SessionsFile(8080, HERE).load() == KEPT
    assert SessionsFile(8081, HERE).load() == []


def test_sessions_of_another_station_are_none_here():
    file = SessionsFile(8080, HERE)
    file.save(KEPT)
    assert SessionsFile(8080, "http://elsewhere:8000").load() == []
    file.move_to("http://127.0.0.1:9000")
    file.save(KEPT)
    assert SessionsFile(8080, "http://127.0.0.1:9000").load() == KEPT


def test_the_file_is_its_users_alone(directory):
    SessionsFile(8080, HERE).save(KEPT)
    assert (directory / "8080.sessions").stat().st_mode & 0o777 == 0o600


def test_the_newest_sessions_are_kept():
    many = [KeptSession(f"cookie {i}", Role.OPERATOR, "x" * 64, i) for i in range(512)]
    SessionsFile(8080, HERE).save(many)
    loaded = SessionsFile(8080, HERE).load()
    assert loaded == many[-150:]


@pytest.mark.parametrize(
    "sessions", ["", "{}", "[1]", '[{"identifier": "a"}]', '[{"role": "king"}]']
)
def test_a_text_of_somebody_else_is_no_session(directory, sessions):
    SessionsFile(8080, HERE).save([])
    text = json.dumps({"station": HERE, "sessions": sessions})
    (directory / "8080.sessions").write_text(text)
    assert SessionsFile(8080, HERE).load() == []


def test_a_directory_that_cannot_be_written_is_logged(directory, caplog):
    directory.write_text("a file where the directory should be")
    with caplog.at_level(logging.WARNING):
        SessionsFile(8080, HERE).save(KEPT)
    assert "Sessions are not kept" in caplog.text
