"""What a build needs is found, and what is missing is named."""

import pytest

from station.kernel import toolchain


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """Return a function that says which programs are on PATH."""

    def install(*names):
        for name in names:
            path = tmp_path / name
            path.write_text("#!/bin/sh\n")
            path.chmod(0o755)
        return tmp_path

    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(toolchain.sysconfig, "get_config_var", lambda _: "icc -pthread")
    return install


@pytest.fixture
def headers(tmp_path, monkeypatch):
    """Let Python's header files be in a folder of the test."""
    folder = tmp_path / "include"
    folder.mkdir()
    (folder / "Python.h").touch()
    monkeypatch.setattr(toolchain.sysconfig, "get_path", lambda _: str(folder))
    return folder


def test_the_compiler_that_built_python_is_preferred(programs):
    folder = programs("gcc", "icc")

    assert toolchain.find_compiler() == [str(folder / "icc"), "-pthread"]


def test_another_compiler_does_when_that_one_is_not_here(programs):
    folder = programs("clang", "gcc")

    assert toolchain.find_compiler() == [str(folder / "gcc")]


def test_the_user_may_name_the_compiler(programs, monkeypatch):
    folder = programs("gcc", "icc", "zig")
    monkeypatch.setenv("CC", "zig cc")

    assert toolchain.find_compiler() == [str(folder / "zig"), "cc"]


def test_a_compiler_is_asked_for_its_version(programs):
    folder = programs("gcc")
    (folder / "gcc").write_text("#!/bin/sh\necho gcc 12.2, asked with $1\n")

    assert toolchain.compiler_version() == "gcc 12.2, asked with --version\n"


def test_a_missing_compiler_has_no_version(programs):
    programs()

    assert toolchain.compiler_version() == ""


def test_a_missing_compiler_is_named(programs):
    programs()

    assert toolchain.find_compiler() is None
    assert "No C compiler was found" in toolchain.missing_tool()


@pytest.mark.usefixtures("headers")
def test_nothing_is_missing(programs):
    programs("cc")

    assert toolchain.missing_tool() is None


def test_missing_header_files_are_named(programs, headers):
    programs("cc")
    (headers / "Python.h").unlink()

    assert "header files are missing" in toolchain.missing_tool()


@pytest.mark.usefixtures("headers")
def test_missing_cython_is_named(programs, monkeypatch):
    programs("cc")
    monkeypatch.setattr(toolchain, "find_spec", lambda _: None)

    assert toolchain.missing_tool() == "Cython is not installed."
