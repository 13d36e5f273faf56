"""Where controllers come from.

Edited modules are read anew, whatever the clock of the files says.
"""

import os
import sys
import textwrap

import pytest

from station.core.control.controller import ControllerBase
from station.core.control.controller_loader import (
    ClassLoader,
    ControllerLoader,
    EntryPointLoader,
    PluginModules,
    TableLoader,
    create_controller,
    default_loaders,
)
from station.core.errors import (
    ControllerLoadError,
    ControllerModuleRefusedError,
    ControllerTypeNotFoundError,
)


class First(ControllerBase):
    """One kind."""


class Second(ControllerBase):
    """Another kind."""


class Broken(ControllerBase):
    """Cannot be constructed."""

    def __init__(self):
        raise RuntimeError("no motor")


class Empty(ControllerLoader):
    """Declares a type and returns nothing."""

    def declared_types(self):
        return ["test/Type"]

    def create(self, controller_type):
        return None


@pytest.fixture
def plugin(tmp_path, monkeypatch):
    """Return a function that writes the module `hot_plugin` with a version number."""
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def write(version):
        (tmp_path / "hot_plugin.py").write_text(
            textwrap.dedent(f"""
                from station.core.control.controller import ControllerBase

                class Plugin(ControllerBase):
                    version = {version}
            """)
        )

    yield write
    sys.modules.pop("hot_plugin", None)


def test_a_table_creates_classes_and_names_of_classes():
    loader = TableLoader({
        "a/First": First,
        "a/Base": "station.core.control.controller:ControllerBase",
    })

    assert isinstance(loader.create("a/First"), First)
    assert type(loader.create("a/Base")) is ControllerBase
    assert loader.create("a/Other") is None


def test_of_equal_declarations_the_last_one_counts():
    loader = TableLoader([("a/Type", First), ("a/Type", Second)])

    assert isinstance(loader.create("a/Type"), Second)


def test_loaders_are_asked_in_order():
    loaders = [TableLoader({"a/Type": First}), TableLoader({"a/Type": Second})]

    assert isinstance(create_controller(loaders, "a/Type"), First)


def test_a_loader_that_returns_nothing_passes_the_type_on():
    loaders = [Empty(), TableLoader({"test/Type": First})]

    assert isinstance(create_controller(loaders, "test/Type"), First)


def test_a_known_type_that_nobody_creates_is_refused():
    with pytest.raises(ControllerLoadError, match="No loader returned"):
        create_controller([Empty()], "test/Type")


def test_an_unknown_type_is_refused_with_the_known_ones():
    with pytest.raises(ControllerTypeNotFoundError, match="a/Nope") as caught:
        create_controller([TableLoader({"a/Type": First})], "a/Nope")

    assert "There are: a/Type." in caught.value.remedy


def test_a_constructor_that_raises_is_refused_with_its_reason():
    with pytest.raises(ControllerLoadError, match="RuntimeError: no motor"):
        create_controller([TableLoader({"a/Type": Broken})], "a/Type")


@pytest.mark.parametrize(
    "target", ["no_such_module:Class", "station.core.control.controller:NoSuchClass"]
)
def test_a_class_that_cannot_be_imported_is_refused(target):
    with pytest.raises(ControllerLoadError, match="cannot be created"):
        create_controller([ClassLoader()], target)


def test_a_module_that_exits_is_refused_and_ends_nothing(tmp_path, monkeypatch):
    (tmp_path / "leaving_plugin.py").write_text("raise SystemExit(4)")
    monkeypatch.syspath_prepend(str(tmp_path))

    with pytest.raises(ControllerLoadError, match="SystemExit: 4"):
        create_controller([ClassLoader()], "leaving_plugin:Any")


def test_a_class_that_is_no_controller_is_refused():
    with pytest.raises(ControllerLoadError, match="no controller"):
        create_controller([ClassLoader()], "station.core.clock:ManualClock")


def test_any_class_can_be_named_by_its_module(plugin):
    plugin(1)

    assert create_controller(default_loaders({}), "hot_plugin:Plugin").version == 1


def test_a_module_that_is_not_on_the_list_is_refused_and_not_imported(
    tmp_path, monkeypatch
):
    (tmp_path / "unlisted_plugin.py").write_text("raise SystemExit(4)")
    monkeypatch.syspath_prepend(str(tmp_path))

    with pytest.raises(ControllerModuleRefusedError, match="'unlisted_plugin'") as told:
        create_controller(default_loaders({}, ["hot_plugin"]), "unlisted_plugin:Any")

    assert told.value.details["allowed"] == ["hot_plugin"]
    assert "unlisted_plugin" not in sys.modules


@pytest.mark.parametrize(
    ("listed", "is_allowed"),
    [
        ("station.core.control.controller", True),
        ("station.core", True),
        ("station.cor", False),
        ("station.core.control.controller.more", False),
    ],
)
def test_a_listed_package_allows_the_modules_inside_of_it(listed, is_allowed):
    loader = ClassLoader([listed])
    target = "station.core.control.controller:ControllerBase"

    if is_allowed:
        assert type(loader.create(target)) is ControllerBase
    else:
        with pytest.raises(ControllerModuleRefusedError):
            loader.create(target)


def test_a_table_may_name_modules_that_the_list_does_not_allow(plugin):
    plugin(1)
    loaders = default_loaders({"hot/Plugin": "hot_plugin:Plugin"}, [])

    assert create_controller(loaders, "hot/Plugin").version == 1


@pytest.mark.parametrize("kind", ["class", "table"])
def test_an_edited_module_is_read_anew(plugin, kind):
    table = TableLoader({"hot_plugin:Plugin": "hot_plugin:Plugin"})
    loader = ClassLoader() if kind == "class" else table
    plugin(1)
    assert loader.create("hot_plugin:Plugin").version == 1
    plugin(2)
    assert loader.create("hot_plugin:Plugin").version == 2


@pytest.mark.parametrize("kind", ["class", "table"])
def test_reloading_imports_a_module_again(plugin, kind):
    table = TableLoader({"hot_plugin:Plugin": "hot_plugin:Plugin"})
    loader = ClassLoader() if kind == "class" else table
    plugin(1)
    before = type(loader.create("hot_plugin:Plugin"))
    assert type(loader.create("hot_plugin:Plugin")) is before

    loader.reload()

    assert type(loader.create("hot_plugin:Plugin")) is not before


def test_installed_packages_are_found_by_their_entry_points(tmp_path, monkeypatch):
    info = tmp_path / "swing-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: swing\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[station.controllers]\n"
        "swing/Swing = station.core.control.controller:ControllerBase\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))

    loader = EntryPointLoader()

    assert "swing/Swing" in loader.declared_types()
    assert type(loader.create("swing/Swing")) is ControllerBase


def test_entry_points_are_read_again_on_reload(tmp_path, monkeypatch):
    loader = EntryPointLoader("test.group")
    assert loader.declared_types() == []
    info = tmp_path / "late-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: late\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[test.group]\nlate/Late = a:B\n")
    monkeypatch.syspath_prepend(str(tmp_path))

    loader.reload()

    assert loader.declared_types() == ["late/Late"]


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
