"""Folders that several stations of a user share."""

import os
import stat

import pytest

from station.core.user_files import (
    changing,
    is_locked,
    make_private_folder,
    open_regular,
    read_regular,
    try_lock,
)


def _mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def test_missing_folders_are_private_and_those_of_the_user_stay_as_they_are(tmp_path):
    mine = tmp_path / "mine"
    mine.mkdir(mode=0o755)
    make_private_folder(mine / "a" / "b")

    assert [_mode(one) for one in (mine, mine / "a", mine / "a" / "b")] == [
        0o755,
        0o700,
        0o700,
    ]


def test_the_stations_own_folder_is_closed_to_others(tmp_path):
    folder = tmp_path / "control-station" / "recordings"
    folder.mkdir(parents=True)
    folder.chmod(0o755)
    folder.parent.chmod(0o755)

    make_private_folder(folder)

    assert (_mode(folder), _mode(folder.parent)) == (0o700, 0o700)


def test_only_regular_files_are_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path in (tmp_path / "pipe", tmp_path):
        with pytest.raises(OSError, match="no regular file"):
            open_regular(path)


def test_a_file_that_is_too_large_is_not_read(tmp_path):
    (tmp_path / "x").write_text("12345")
    assert read_regular(tmp_path / "x", 5) == "12345"
    with pytest.raises(OSError, match="larger than 4 bytes"):
        read_regular(tmp_path / "x", 4)


def test_a_lock_is_seen_until_its_file_is_closed(tmp_path):
    path = tmp_path / "x"
    path.touch()
    first, second = open_regular(path), open_regular(path)
    assert try_lock(first)
    assert not try_lock(second)
    assert is_locked(path)
    os.close(second)
    os.close(first)
    assert not is_locked(path)
    assert not is_locked(tmp_path / "nothing")


def test_whoever_waits_too_long_for_a_folder_is_told(tmp_path):
    now = [0.0]
    slept = []

    def sleep(time):
        slept.append(time)
        now[0] += 0.5

    with (
        changing(tmp_path),
        pytest.raises(TimeoutError, match="another station"),
        changing(tmp_path, lambda: now[0], sleep),
    ):
        pass
    assert len(slept) == 4
    with changing(tmp_path):
        assert list(tmp_path.iterdir()) == []
