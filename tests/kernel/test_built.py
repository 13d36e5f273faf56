"""The kernel that fits is found; why there is none is said."""

import fcntl
import sys

import pytest

import station.kernel
from station.kernel import built
from station.kernel.built import (
    FAILURE,
    LOCK,
    SWITCH,
    KernelStatus,
    find_kernel,
    is_being_built,
    load_kernel,
    needs_building,
    present_status,
)
from station.kernel.manifest import fingerprint, module_file
from station.kernel.places import cache_place, package_place
from tests.kernel.conftest import write_kernel

pytestmark = pytest.mark.usefixtures("environment")


@pytest.fixture
def lock(environment):
    """Yield while somebody builds a kernel in the environment."""
    with (environment / LOCK).open("wb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def test_a_kernel_that_fits_runs(environment):
    directory = write_kernel(environment)

    found = find_kernel()

    assert found.is_compiled
    assert found.directory == directory


@pytest.mark.parametrize("place", [package_place, cache_place])
def test_kernels_of_a_wheel_and_of_the_cache_run(place):
    directory = write_kernel(place())

    assert find_kernel().directory == directory


def test_the_interpreted_kernel_can_be_asked_for(environment, monkeypatch):
    write_kernel(environment)
    monkeypatch.setenv(SWITCH, "0")

    found = find_kernel()

    assert (found.mode, found.is_forced) == ("interpreted", True)
    assert found.reason == "STATION_COMPILED=0 asks for it."


def test_a_compiled_kernel_that_is_asked_for_must_be_there(environment, monkeypatch):
    monkeypatch.setenv(SWITCH, "1")
    with pytest.raises(ImportError, match="There is no compiled kernel"):
        find_kernel()

    write_kernel(environment)
    assert find_kernel().is_compiled


@pytest.mark.parametrize("value", ["yes", "2", "true"])
def test_other_wishes_are_refused(monkeypatch, value):
    monkeypatch.setenv(SWITCH, value)

    with pytest.raises(ImportError, match=f"'{value}'.*must be 0"):
        find_kernel()


@pytest.mark.usefixtures("has_all_tools")
def test_a_first_start_says_that_the_station_will_build_it():
    assert find_kernel().text() == (
        "interpreted: There is no compiled kernel. `station run` builds one beside the "
        "station."
    )


def test_a_machine_without_compiler_is_told_so(monkeypatch):
    monkeypatch.setattr(built, "missing_tool", lambda: "No C compiler was found.")

    reason = find_kernel().reason

    assert reason == "There is no compiled kernel. No C compiler was found."


@pytest.mark.usefixtures("has_all_tools")
def test_a_kernel_of_other_sources_is_stale_and_not_run(environment):
    directory = write_kernel(environment, name="old", sources="others")

    found = find_kernel()

    assert found.mode == "interpreted"
    assert f"{directory} is stale: it was built from other sources." in found.reason


@pytest.mark.usefixtures("has_all_tools")
def test_a_kernel_for_another_python_is_not_run(environment):
    write_kernel(environment, name="other", built_for="cpython-399 Linux x86_64")

    found = find_kernel()

    assert found.mode == "interpreted"
    assert "is for cpython-399 Linux x86_64, and this is" in found.reason


@pytest.mark.usefixtures("has_all_tools")
def test_a_damaged_kernel_is_not_run(environment):
    directory = write_kernel(environment)
    (directory / module_file("twice")).write_text("a libr")

    found = find_kernel()

    assert found.mode == "interpreted"
    assert f"The kernel at {directory} is damaged" in found.reason


@pytest.mark.usefixtures("has_all_tools")
def test_a_build_that_failed_is_not_tried_again(environment):
    status = find_kernel()
    assert needs_building(status)

    failure = environment / f"{fingerprint()}{FAILURE}"
    failure.write_text("gcc: out of luck\n")

    assert not needs_building(status)
    assert f"failed, see {failure}" in find_kernel().reason


@pytest.mark.usefixtures("has_all_tools", "lock")
def test_a_kernel_that_is_being_built_is_not_built_twice():
    status = find_kernel()

    assert is_being_built()
    assert status.reason == "A compiled kernel is being built; the next start loads it."
    assert not needs_building(status)


@pytest.mark.usefixtures("has_all_tools")
def test_what_is_built_meanwhile_runs_from_the_next_start_on(environment):
    status = find_kernel()
    assert present_status(status) == status

    write_kernel(environment)

    now = present_status(status)
    assert (now.mode, now.directory) == ("interpreted", None)
    assert "has been built meanwhile; the next start loads it" in now.reason


@pytest.mark.usefixtures("has_all_tools")
def test_a_damaged_kernel_does_not_count_as_built_meanwhile(environment):
    status = find_kernel()

    directory = write_kernel(environment)
    (directory / module_file("twice")).write_text("a libr")

    assert present_status(status) == status


@pytest.mark.usefixtures("lock")
def test_a_build_beside_the_station_is_told():
    status = KernelStatus("interpreted", "There is no compiled kernel.")

    assert "is being built" in present_status(status).reason


def test_who_asked_for_the_interpreted_kernel_gets_no_build(monkeypatch):
    monkeypatch.setenv(SWITCH, "0")

    assert not needs_building(find_kernel())


def test_a_library_that_cannot_be_imported_leaves_the_sources(environment):
    status = find_kernel_of_text(environment)
    path = station.kernel.__path__
    before = list(path)

    found = load_kernel(status, path)

    assert found.mode == "interpreted"
    assert "cannot be imported" in found.reason
    assert path == before
    assert "station.kernel.twice" not in sys.modules
    assert present_status(found) == found
    assert find_kernel().mode == "interpreted"


def test_a_library_that_cannot_be_imported_is_an_error_for_who_asked(
    environment, monkeypatch
):
    monkeypatch.setenv(SWITCH, "1")
    status = find_kernel_of_text(environment)

    with pytest.raises(ImportError):
        load_kernel(status, ["sources"])


def find_kernel_of_text(environment):
    """Return the status of a kernel whose libraries are text files."""
    write_kernel(environment)
    status = find_kernel()
    assert status.is_compiled
    return status
