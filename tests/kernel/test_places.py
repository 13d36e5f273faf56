"""Kernels lie in the package, the environment or the cache, and nowhere else."""

import sys
from pathlib import Path

import pytest

from station.kernel import places

pytestmark = pytest.mark.usefixtures("sources")


def make(*folders):
    for folder in folders:
        folder.mkdir(parents=True, exist_ok=True)


def test_the_package_comes_first_then_the_environment_then_the_cache():
    wanted = [
        places.package_place(),
        places.environment_place(),
        places.cache_place(),
    ]
    make(*wanted)

    assert places.places() == wanted


def test_places_that_do_not_exist_are_left_out(environment):
    assert places.places() == [environment]


def test_nothing_is_built_into_a_python_that_is_no_virtual_environment(monkeypatch):
    monkeypatch.setattr(sys, "prefix", sys.base_prefix)

    assert places.environment_place() is None
    assert places.building_place() == places.cache_place()


def test_kernels_are_built_in_the_environment(environment):
    assert places.building_place() == environment


@pytest.mark.usefixtures("sources")
def test_kernels_are_built_in_the_cache_when_the_environment_cannot_be_written(
    environment, monkeypatch
):
    can_write = places.os.access
    monkeypatch.setattr(
        places.os,
        "access",
        lambda path, mode: Path(path) != environment and can_write(path, mode),
    )

    assert places.building_place() == places.cache_place()


def test_there_may_be_no_place_to_build_in(monkeypatch):
    monkeypatch.setattr(places.os, "access", lambda *_: False)

    assert places.building_place() is None


def test_a_cache_that_others_can_write_is_not_trusted():
    cache = places.cache_place()
    make(cache)
    assert places.places() == [cache]

    cache.chmod(0o777)

    assert places.places() == []


def test_a_cache_of_another_user_is_not_trusted(monkeypatch):
    cache = places.cache_place()
    make(cache)
    owner = cache.stat().st_uid
    if owner == 0:
        pytest.skip("what belongs to root is trusted, and root runs this")
    monkeypatch.setattr(places.os, "getuid", lambda: owner + 1)

    assert places.places() == []


def test_the_cache_is_in_the_home_unless_it_is_named(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", "relative/is/ignored")
    monkeypatch.setenv("HOME", str(tmp_path))

    assert places.cache_place() == tmp_path / ".cache" / "control-station" / "kernel"


def test_a_user_without_a_home_has_no_cache(monkeypatch):
    def homeless():
        raise RuntimeError("no home")

    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(places.Path, "home", homeless)

    assert places.cache_place() is None
