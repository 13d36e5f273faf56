"""The directory of a station's state."""

import stat

import pytest

from station.local.private_files import (
    StateDirectory,
    StateDirectoryError,
    state_directory,
)


@pytest.fixture(autouse=True)
def own_state(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))


def test_it_is_private_and_found_again():
    with StateDirectory() as one:
        first = one.path
    with StateDirectory() as again:
        assert again.path == first

    assert first.parent == state_directory()
    assert stat.S_IMODE(first.stat().st_mode) == 0o700


def test_two_stations_have_two():
    with StateDirectory() as one, StateDirectory() as other:
        assert one.path != other.path


def test_a_directory_that_cannot_be_made_is_told(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("no directory")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "file"))

    with pytest.raises(StateDirectoryError, match="cannot be used"):
        StateDirectory()
