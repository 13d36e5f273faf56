"""Extensions that fit run; why the sources run is said, and what would change that."""

import fcntl
import os
import shutil
import subprocess
import sys

import pytest

from station import compiled
from station.compiled import SWITCH, BuildRecord
from station.compiled_finder import SHARED, SUFFIX, CompiledFinder

BUILT = "compiled: It was built from these sources for "


@pytest.fixture(autouse=True)
def checkout(tmp_path, monkeypatch):
    """Return a checkout with the compiled module `twice` and no extensions."""
    package = tmp_path / "station"
    (package / "core").mkdir(parents=True)
    (package / "core" / "twice.py").write_text("KIND = 'source'\n")
    (package / "core" / "twice.pxd").write_text("cpdef double twice(double x)\n")
    (tmp_path / "setup.py").write_text("# flags\n")
    monkeypatch.setattr(compiled, "PACKAGE", package)
    monkeypatch.setattr(compiled, "missing_tool", lambda: None)
    monkeypatch.delenv(SWITCH, raising=False)
    compiled.status.cache_clear()
    yield tmp_path
    compiled.status.cache_clear()


@pytest.fixture
def building(checkout):
    """Yield while somebody builds in the checkout."""
    (checkout / "build").mkdir()
    with (checkout / "build" / "extensions.lock").open("wb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def library(name):
    stem = compiled.PACKAGE.joinpath(*name.split(".")[1:])
    return stem.with_name(f"{stem.name}{SUFFIX}")


def write_extensions(**changed):
    """Write extensions that fit, but for what is changed in their record."""
    for name in (SHARED, *compiled.compiled_modules()):
        library(name).parent.mkdir(parents=True, exist_ok=True)
        library(name).write_text("a library")
    record = compiled.built_record(compiled.PACKAGE)
    values = {field: getattr(record, field) for field in record.__slots__}
    BuildRecord(**{**values, **changed}).write()


def decide_again():
    compiled.status.cache_clear()
    return compiled.status()


def test_extensions_that_fit_run():
    write_extensions()

    assert compiled.status().text().startswith(BUILT)


def test_a_process_decides_once():
    assert not compiled.status().is_compiled

    write_extensions()

    assert not compiled.status().is_compiled


def test_the_sources_can_be_asked_for(monkeypatch):
    write_extensions()
    monkeypatch.setenv(SWITCH, "0")

    found = compiled.status()

    assert (found.mode, found.is_forced) == ("interpreted", True)
    assert found.reason == "STATION_COMPILED=0 asks for it."
    assert not compiled.needs_building()


def test_extensions_that_are_asked_for_must_be_there(monkeypatch):
    monkeypatch.setenv(SWITCH, "1")
    with pytest.raises(ImportError, match=r"no compiled extensions.*`make compile`"):
        compiled.status()

    write_extensions()
    assert compiled.status().is_forced


@pytest.mark.parametrize("value", ["yes", "2", "true"])
def test_other_wishes_are_refused(monkeypatch, value):
    monkeypatch.setenv(SWITCH, value)

    with pytest.raises(ImportError, match=f"'{value}'.*must be 0"):
        compiled.status()


def test_a_first_start_says_that_the_station_builds():
    assert compiled.status().reason == (
        "There are no compiled extensions. "
        "`station run` builds them beside the station."
    )
    assert compiled.needs_building()


def test_a_machine_without_compiler_is_told_so(monkeypatch):
    monkeypatch.setattr(compiled, "missing_tool", lambda: "No C compiler was found.")

    reason = compiled.status().reason

    assert reason == "There are no compiled extensions. No C compiler was found."
    assert not compiled.needs_building()


def test_an_installed_package_is_not_built_in(checkout):
    (checkout / "setup.py").unlink()

    assert "Install the station anew" in compiled.status().reason
    assert not compiled.needs_building()


def change_source(checkout):
    (checkout / "station" / "core" / "twice.py").write_text("KIND = 'edited'\n")


def change_types(checkout):
    (checkout / "station" / "core" / "twice.pxd").write_text("# edited\n")


def change_flags(checkout):
    (checkout / "setup.py").write_text("# other flags\n")


def add_module(checkout):
    (checkout / "station" / "more.py").write_text("")
    (checkout / "station" / "more.pxd").write_text("")


@pytest.mark.parametrize(
    "change", [change_source, change_types, change_flags, add_module]
)
def test_extensions_of_other_sources_are_stale(checkout, change):
    write_extensions()
    change(checkout)

    assert "stale: they were built from other sources." in compiled.status().reason
    assert compiled.needs_building()


def test_extensions_for_another_python_do_not_run():
    write_extensions(target="cpython-399 Linux x86_64")

    assert "are for cpython-399 Linux x86_64; this is " in compiled.status().reason


@pytest.mark.parametrize("damage", [lambda f: f.write_text("a"), lambda f: f.unlink()])
def test_a_damaged_extension_is_not_run(damage):
    write_extensions()
    damage(library("station.core.twice"))

    assert "core/twice" in compiled.status().reason
    assert "missing or damaged" in compiled.status().reason


def test_a_broken_record_counts_as_none():
    write_extensions()
    compiled.record_path().write_text("{")

    assert "There are no compiled extensions." in compiled.status().reason


def test_a_build_that_failed_is_not_tried_again_until_the_sources_change(checkout):
    write_extensions(extensions={}, failure="gcc: out of luck.")

    assert "failed: gcc: out of luck." in compiled.status().reason
    assert not compiled.needs_building()
    change_source(checkout)
    assert "luck" not in decide_again().reason
    assert compiled.needs_building()


@pytest.mark.usefixtures("building")
def test_what_is_being_built_is_not_built_twice():
    assert "are being built; the next start loads them." in compiled.status().reason
    assert not compiled.needs_building()
    with pytest.raises(BlockingIOError):
        compiled.build_in_background()


def test_what_is_built_meanwhile_runs_from_the_next_start_on():
    before = compiled.status()
    assert compiled.present_status() == before

    write_extensions()

    now = compiled.present_status()
    assert now.mode == "interpreted"
    assert "have been built; the next start loads them." in now.reason


def test_a_build_in_the_background_holds_the_lock_until_it_ends(checkout):
    (checkout / "setup.py").write_text("import sys; sys.stdin.read()\n")
    started = []

    class Process(subprocess.Popen):
        def __init__(self, command, **options):
            started.append(self)
            super().__init__(command, **{**options, "stdin": subprocess.PIPE})

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(subprocess, "Popen", Process)
        compiled.build_in_background()
    (process,) = started
    assert process.args[:2] == [sys.executable, "setup.py"]
    assert "--idle" in process.args
    assert compiled.is_being_built()

    process.communicate()

    assert not compiled.is_being_built()


class TestFinder:
    """Where Python looks for a module that is compiled."""

    def find(self, name="station.core.twice", finder=None):
        path = [str(compiled.PACKAGE / "core")]
        return (finder or CompiledFinder()).find_spec(name, path)

    def test_interpreted_the_source_is_found_beside_an_extension(self, monkeypatch):
        write_extensions()
        monkeypatch.setenv(SWITCH, "0")

        assert self.find().origin.endswith("twice.py")

    def test_compiled_the_extension_is_found(self):
        write_extensions()

        assert self.find().origin == str(library("station.core.twice"))

    @pytest.mark.parametrize("name", ["station.core.other", "json.decoder"])
    def test_other_modules_are_left_to_python(self, name):
        assert self.find(name) is None

    def test_an_extension_that_was_built_anew_is_refused(self):
        write_extensions()
        finder = CompiledFinder()
        assert self.find(finder=finder) is not None

        os.utime(library("station.core.twice"), (1.0, 1.0))

        with pytest.raises(ImportError, match="Start the process again"):
            self.find(finder=finder)


def test_missing_tools_are_named(monkeypatch):
    monkeypatch.undo()
    assert compiled.missing_tool() is None or shutil.which("gcc") is None
    monkeypatch.setenv("PATH", "/nonexistent")
    monkeypatch.setenv("CC", "")
    assert compiled.missing_tool().startswith("No C compiler was found")
