"""The kernel is built as a whole, once, where it can be; old ones go."""

import os
import sys
from importlib.machinery import ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_file_location

import pytest

import station.kernel
from station.kernel import build
from station.kernel.build import BuildError
from station.kernel.built import FAILURE, find_kernel
from station.kernel.manifest import fingerprint, module_file
from station.kernel.toolchain import missing_tool
from tests.kernel.conftest import write_kernel

pytestmark = pytest.mark.usefixtures("environment")

needs_compiler = pytest.mark.skipif(
    missing_tool() is not None, reason=str(missing_tool())
)
# One module shares what all modules of a compiled kernel have in common.
needs_kernel = pytest.mark.skipif(
    not station.kernel.STATUS.is_compiled, reason=station.kernel.STATUS.reason
)


def import_library(path):
    loader = ExtensionFileLoader("station.kernel.twice", str(path))
    spec = spec_from_file_location("station.kernel.twice", path, loader=loader)
    module = module_from_spec(spec)
    loader.exec_module(module)
    sys.modules.pop("station.kernel.twice")  # where Cython puts it
    return module


TRY_IMPORT = build._try_import


@pytest.fixture
def compiled(monkeypatch):
    """Let compiling a module write a file; return the names of the modules."""
    names = []

    def compile_module(name, tree, directory):
        source = tree / "station" / "kernel" / f"{name}.py"
        assert source.is_file() or name == build._SHARED
        if name != build._SHARED:
            names.append(name)
        result = directory / module_file(name)
        result.write_text("a library")
        return result

    monkeypatch.setattr(build, "missing_tool", lambda: None)
    monkeypatch.setattr(build, "_compile", compile_module)
    monkeypatch.setattr(build, "_try_import", lambda *_: None)
    return names


@pytest.mark.slow
@needs_compiler
@needs_kernel
def test_sources_become_a_kernel_that_runs():
    directory = build.build()

    module = import_library(directory / module_file("twice"))
    assert (module.KIND, module.twice(1.5)) == ("compiled", 3.0)
    assert find_kernel().directory == directory


@pytest.mark.slow
@needs_compiler
def test_a_compiler_that_fails_is_quoted(environment, sources):
    (sources / "twice.pxd").write_text("cpdef nonsense\n")

    with pytest.raises(BuildError, match=r"twice\.pxd"):
        build.build()

    failure = environment / f"{fingerprint()}{FAILURE}"
    assert "twice.pxd" in failure.read_text()
    assert [path for path in environment.iterdir() if path.is_dir()] == []


@pytest.mark.usefixtures("compiled")
def test_a_kernel_that_cannot_be_imported_is_no_kernel(environment, monkeypatch):
    monkeypatch.setattr(build, "_try_import", TRY_IMPORT)

    with pytest.raises(BuildError, match=r"station\.kernel\.twice"):
        build.build()

    assert find_kernel().mode == "interpreted"
    assert [path for path in environment.iterdir() if path.is_dir()] == []


def test_a_kernel_that_is_there_is_not_built_again(compiled):
    first = build.build()

    assert build.build() == first
    assert compiled == ["twice"]


@pytest.mark.usefixtures("compiled")
def test_a_damaged_kernel_is_replaced():
    directory = build.build()
    (directory / module_file("twice")).write_text("a libr")

    assert build.build() == directory
    assert find_kernel().is_compiled


@pytest.mark.usefixtures("compiled")
def test_sources_that_change_during_the_build_leave_no_kernel(sources, monkeypatch):
    write_file = build._compile

    def edit_and_compile(*arguments):
        (sources / "twice.py").write_text("# edited\n")
        return write_file(*arguments)

    monkeypatch.setattr(build, "_compile", edit_and_compile)

    with pytest.raises(BuildError, match="changed during the build"):
        build.build()
    assert find_kernel().mode == "interpreted"


def test_a_module_that_is_made_of_the_same_is_taken_over(sources, compiled):
    add_user(sources)
    build.build()
    (sources / "user.py").write_text("# edited\n")

    directory = build.build()

    assert sorted(compiled) == ["twice", "user", "user"]
    assert find_kernel().directory == directory


def test_what_uses_changed_types_is_compiled_again(sources, compiled):
    add_user(sources)
    build.build()
    (sources / "twice.pxd").write_text("cpdef float twice(float value) noexcept\n")

    build.build()

    assert sorted(compiled) == ["twice", "twice", "user", "user"]


def test_another_compiler_compiles_everything_again(sources, compiled, monkeypatch):
    add_user(sources)
    build.build()
    (sources / "user.py").write_text("# edited\n")
    monkeypatch.setattr(build, "compiler_version", lambda: "another one")

    build.build()

    assert sorted(compiled) == ["twice", "twice", "user", "user"]


def test_a_damaged_module_is_not_taken_over(sources, compiled):
    add_user(sources)
    before = build.build()
    (before / module_file("twice")).write_text("a libr")
    (sources / "user.py").write_text("# edited\n")

    build.build()

    assert sorted(compiled) == ["twice", "twice", "user", "user"]


def add_user(sources):
    """Add a module that uses the types of `twice`."""
    (sources / "user.py").write_text("# as it was\n")
    (sources / "user.pxd").write_text("from station.kernel.twice cimport twice\n")


@pytest.mark.usefixtures("compiled")
def test_old_kernels_and_what_killed_builds_left_go(environment):
    for age in range(10):
        old = write_kernel(environment, name=f"old{age}", sources="others")
        os.utime(old, (1000.0 - age, 1000.0 - age))
    (environment / ".building-x" / "kernel").mkdir(parents=True)
    (environment / f"old{FAILURE}").touch()

    newest = build.build()

    left = {path.name for path in environment.iterdir() if path.is_dir()}
    assert left == {newest.name, "old0", "old1", "old2"}
    assert list(environment.glob(f"*{FAILURE}")) == []


def test_a_missing_tool_is_an_error(monkeypatch):
    monkeypatch.setattr(build, "missing_tool", lambda: "Cython is not installed.")

    with pytest.raises(BuildError, match="Cython is not installed"):
        build.build()


@pytest.mark.usefixtures("compiled", "sources")
def test_no_place_to_build_in_is_an_error(monkeypatch):
    monkeypatch.setattr(build, "building_place", lambda: None)

    with pytest.raises(BuildError, match="can be written"):
        build.build()


@pytest.mark.parametrize(
    ("arguments", "code"), [([], 1), (["--background"], 1), (["--optional"], 0)]
)
def test_the_command_says_what_is_missing(monkeypatch, capsys, arguments, code):
    missing = "Cython is not installed."
    monkeypatch.setattr(build, "missing_tool", lambda: missing)
    monkeypatch.setattr(sys, "argv", ["build", *arguments])

    assert build.main() == code
    assert capsys.readouterr().err == f"kernel: not compiled. {missing}\n"


@pytest.mark.usefixtures("compiled")
def test_the_command_prints_where_the_kernel_is(environment, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["build"])

    assert build.main() == 0
    assert capsys.readouterr().out == f"{environment / fingerprint()}\n"
