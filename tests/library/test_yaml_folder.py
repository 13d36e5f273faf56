"""Named files of the user: names that are none, and files that cannot be used."""

import os

import pytest

from station.core.errors import GainSetError, GainSetNotFoundError
from station.core.yaml_reader import FILE
from station.library.yaml_folder import FileKind, YamlFolder

KIND = FileKind("gain set", "gain-sets", GainSetNotFoundError, GainSetError)


@pytest.fixture
def files(tmp_path):
    return YamlFolder(KIND, tmp_path / "files")


def test_what_was_written_is_read_listed_and_deleted(files):
    files.write("b", {"x": 1})
    files.write("a-1", {"x": 2})
    assert files.names() == ["a-1", "b"]
    assert files.read("b") == {"x": 1}
    files.delete("b")
    files.delete("b")
    assert files.names() == ["a-1"]


@pytest.mark.parametrize("name", ["../x", "", "-", "a/b", "a" * 101])
def test_a_name_that_leaves_the_folder_is_none(files, name):
    for ask in (files.read, files.delete, lambda n: files.write(n, {})):
        with pytest.raises(GainSetNotFoundError, match="is no name of a gain set"):
            ask(name)


def test_an_unknown_name_is_answered_with_a_similar_one(files):
    files.write("stiff", {})
    with pytest.raises(GainSetNotFoundError) as caught:
        files.read("stif")
    assert "stiff" in caught.value.remedy


def test_a_file_that_is_no_yaml_or_too_large_says_where_it_is(files):
    files.write("x", {"a": 1})
    path = files.folder / "x.yaml"
    path.write_text("{")
    with pytest.raises(GainSetError, match=str(path)):
        files.read("x")
    path.write_text(" " * (FILE.characters + 1))
    with pytest.raises(GainSetError, match="larger than 1000000 bytes"):
        files.read("x")


def test_a_pipe_among_the_files_holds_nobody_up(files):
    files.write("good", {"a": 1})
    os.mkfifo(files.folder / "pipe.yaml")

    assert files.names() == ["good"]
    with pytest.raises(GainSetError, match="no regular file"):
        files.read("pipe")


def test_a_folder_that_cannot_be_written_is_told(files):
    files.folder.write_text("a file is in the way")
    with pytest.raises(GainSetError):
        files.write("x", {})
