"""The limit of open files is raised as far as possible, and told when too low."""

import fcntl
import os
import resource

import pytest

from station.local import descriptors
from station.local.descriptors import (
    ENOUGH,
    LEAST,
    open_more_files,
    shortage,
    wait_until_readable,
)

ANY = resource.RLIM_INFINITY


@pytest.fixture
def limits(monkeypatch):
    """Return the limits of the test, in a list that `setrlimit` changes."""
    found = [(64, 64)]
    monkeypatch.setattr(descriptors.resource, "getrlimit", lambda _: found[-1])
    monkeypatch.setattr(
        descriptors.resource, "setrlimit", lambda _, limits: found.append(limits)
    )
    return found


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ((64, 100), (100, 100)),
        ((64, 4096), (ENOUGH, 4096)),
        ((64, ANY), (ENOUGH, ANY)),
        ((1024, 4096), (1024, 4096)),
        ((ANY, ANY), (ANY, ANY)),
    ],
)
def test_a_soft_limit_is_raised_to_what_is_enough(limits, before, after):
    limits[:] = [before]
    open_more_files()

    assert limits[-1] == after


@pytest.mark.parametrize(("most", "is_told"), [(LEAST - 1, True), (LEAST, False)])
def test_too_few_files_are_told_with_a_way_out(limits, most, is_told):
    limits[:] = [(most, most)]
    told = shortage()

    assert (told is not None) is is_told
    assert told is None or f"{most} files" in told
    assert told is None or "ulimit -n" in told


def test_any_number_of_files_is_enough(limits):
    limits[:] = [(64, ANY)]

    assert shortage() is None


def test_descriptors_beyond_those_of_select_are_waited_for():
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if hard != ANY and hard < 2000:
        pytest.skip("This process may not open so many files.")
    resource.setrlimit(resource.RLIMIT_NOFILE, (2000, hard))
    reading, writing = os.pipe()
    high = fcntl.fcntl(reading, fcntl.F_DUPFD, 1500)
    try:
        assert not wait_until_readable([high], 0.0)
        os.write(writing, b"!")
        assert wait_until_readable([high], 0.0)
        assert wait_until_readable([high])
    finally:
        for one in (reading, writing, high):
            os.close(one)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
