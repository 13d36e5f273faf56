"""Named files of the user: names that are none, and files that cannot be used."""

import os

import pytest

from station.core.errors import (
    GainSetError,
    GainSetNotFoundError,
    PlotLayoutError,
    PlotLayoutNotFoundError,
)
from station.core.yaml_reader import FILE
from station.library.yaml_folder import FileKind, PlotLayouts, YamlFolder
from station.reports import DockSettings, PlotSettings

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


PLOTS = (
    PlotSettings(["position/a", "d/dt position/a"], span=30.0),
    PlotSettings(["effort/a"], xy=True, transform="norm"),
)


@pytest.fixture
def layouts(tmp_path):
    return PlotLayouts(tmp_path)


def test_a_layout_is_saved_read_and_deleted(layouts):
    saved = layouts.save("torques", PLOTS)
    assert layouts.names() == ["torques"]
    assert layouts.get("torques") == saved
    assert tuple(saved.plots) == PLOTS
    docks = DockSettings(["plots"], 468.0, 236.0, {"joints": 300.0})
    layouts.save("torques", PLOTS, docks)
    layouts.save("torques", PLOTS[:1])  # without docks, which stay
    assert layouts.get("torques").docks == docks
    assert tuple(layouts.delete("torques").plots) == PLOTS[:1]
    with pytest.raises(PlotLayoutNotFoundError, match="no plot layout 'torques'"):
        layouts.get("torques")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("plots: 3", "valid tuple"),
        ("plots: []\ndocks: {side: 3}", "folded: "),
        ("plots: [{span: 1}]", "0/keys: Field required"),
        ("plots: [{keys: [a], span: -1, xy: false, transform: ''}]", "shows -1.0 s"),
    ],
)
def test_a_malformed_file_is_refused(layouts, tmp_path, text, why):
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(PlotLayoutError, match=why):
        layouts.get("bad")
