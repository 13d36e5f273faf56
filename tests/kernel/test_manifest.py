"""A kernel fits what it was built from and for, and every damage is found."""

import pytest

from station.kernel.manifest import (
    MANIFEST,
    find_damage,
    fingerprint,
    module_file,
    read_manifest,
    target,
)
from tests.kernel.conftest import write_kernel

pytestmark = pytest.mark.usefixtures("sources")


@pytest.mark.parametrize("name", ["twice.py", "twice.pxd", "build.py"])
def test_another_source_needs_another_kernel(sources, name):
    before = fingerprint()

    path = sources / name
    path.write_text(path.read_text() + "\n")

    assert fingerprint() != before


def test_another_module_needs_another_kernel(sources):
    before = fingerprint()

    (sources / "thrice.py").touch()
    assert fingerprint() == before

    (sources / "thrice.pxd").touch()
    assert fingerprint() != before


def test_another_processor_needs_another_kernel(monkeypatch):
    before = fingerprint()

    monkeypatch.setattr("platform.machine", lambda: "riscv64")

    assert fingerprint() != before
    assert target().endswith("riscv64")


def test_another_python_needs_another_kernel(monkeypatch):
    before = fingerprint()

    monkeypatch.setattr("sysconfig.get_config_var", lambda _: "cpython-399-x86_64")

    assert fingerprint() != before


def test_a_kernel_as_it_was_built_is_sound(environment):
    assert find_damage(write_kernel(environment)) is None


def test_a_library_that_was_cut_short_is_damage(environment):
    directory = write_kernel(environment)

    (directory / module_file("twice")).write_text("a libr")

    assert "is not the file that was built" in find_damage(directory)


def test_a_library_that_is_missing_is_damage(environment):
    directory = write_kernel(environment)

    (directory / module_file("twice")).unlink()

    assert f"{module_file('twice')} is missing" in find_damage(directory)


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"sources": "", "target": "", "modules": 3}', "\x00"]
)
def test_a_broken_manifest_is_damage(environment, text):
    directory = write_kernel(environment)

    (directory / MANIFEST).write_text(text)

    assert read_manifest(directory) is None
    assert MANIFEST in find_damage(directory)
