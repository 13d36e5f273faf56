"""Edited modules are read anew, whatever the clock of the files says."""

import os
import sys

import pytest

from station.core.control.plugin_modules import PluginModules


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Return a function that writes a module of the package `hot_package`."""
    folder = tmp_path / "hot_package"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", False)

    def write(name, text, stamp=None):
        path = folder / f"{name}.py"
        path.write_text(text)
        if stamp is not None:
            os.utime(path, ns=(stamp, stamp))

    yield write
    for name in [each for each in sys.modules if each.startswith("hot_package")]:
        del sys.modules[name]


def test_a_module_that_has_not_changed_is_imported_once(package):
    package("one", "value = object()")
    modules = PluginModules()

    assert modules.load("hot_package.one") is modules.load("hot_package.one")


def test_an_edit_of_the_same_size_within_a_second_is_seen(package):
    modules = PluginModules()
    package("one", "value = 1", stamp=1_000_000_000)
    assert modules.load("hot_package.one").value == 1

    package("one", "value = 2", stamp=1_000_000_001)

    assert modules.load("hot_package.one").value == 2


def test_an_edited_helper_is_read_anew_with_the_module_that_needs_it(package):
    modules = PluginModules()
    package("helper", "value = 1")
    package("one", "from hot_package.helper import value")
    assert modules.load("hot_package.one").value == 1

    package("helper", "value = 20")
    package("one", "from hot_package.helper import value  # edited")

    assert modules.load("hot_package.one").value == 20


def test_an_edit_that_cannot_be_imported_is_told(package):
    modules = PluginModules()
    package("one", "value = 1")
    modules.load("hot_package.one")

    package("one", "value =")

    with pytest.raises(SyntaxError):
        modules.load("hot_package.one")


def test_what_is_forgotten_is_imported_again(package):
    modules = PluginModules()
    package("one", "value = object()")
    before = modules.load("hot_package.one").value

    modules.forget()

    assert modules.load("hot_package.one").value is not before


def test_the_stations_own_modules_stay_together():
    modules = PluginModules()
    before = sys.modules["station.core.errors"]

    modules.load("station.controllers.joint_state_controller")

    assert sys.modules["station.core.errors"] is before
