"""The lock files and pyproject.toml agree, and name public sources alone."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections import defaultdict
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
PYPI = "https://pypi.org/simple"
FILES = "https://files.pythonhosted.org/"

Pin = tuple[str, str]


@pytest.fixture(scope="module")
def locked() -> list[dict]:
    """Return the packages of uv.lock."""
    return tomllib.loads((ROOT / "uv.lock").read_text())["package"]


@pytest.fixture(scope="module")
def project(locked) -> dict:
    """Return the project's own entry in uv.lock."""
    (entry,) = [package for package in locked if package["source"] == {"editable": "."}]
    return entry


@pytest.fixture(scope="module")
def third_party(locked, project) -> list[dict]:
    """Return every package of uv.lock but the project."""
    return [package for package in locked if package is not project]


def files_of(package: dict) -> list[dict]:
    return [*package.get("wheels", []), *filter(None, [package.get("sdist")])]


def required_hashes(name: str) -> dict[Pin, set[str]]:
    """Return what a file of requirements pins, with the hashes it accepts."""
    hashes: dict[Pin, set[str]] = defaultdict(set)
    pin: Pin | None = None
    for line in (ROOT / name).read_text().splitlines():
        if match := re.match(r"([\w.-]+)==([\w.!+-]+)", line):
            pin = (match[1], match[2])
            hashes[pin] = set()
        elif match := re.match(r"\s+--hash=(sha256:[0-9a-f]{64})", line):
            assert pin is not None
            hashes[pin].add(match[1])
        else:
            assert re.match(r"\s*(#|$)", line), f"unexpected line: {line}"
    return hashes


def requirements(specifiers: list[dict]) -> set[tuple[str, str]]:
    return {(entry["name"], entry.get("specifier", "")) for entry in specifiers}


def declared(lines: list) -> set[tuple[str, str]]:
    parsed = [Requirement(line) for line in lines if isinstance(line, str)]
    return {(canonicalize_name(r.name), str(r.specifier)) for r in parsed}


def needed_to_run(project: dict, third_party: list[dict]) -> set[str]:
    """Return the names that the station and its installation lead to."""
    packages = {package["name"]: package for package in [project, *third_party]}
    frontier = [
        {"name": "control-station", "extra": ["all"]},
        *project["dev-dependencies"]["build"],
    ]
    found: set[tuple[str, str]] = set()
    while frontier:
        wanted = frontier.pop()
        package = packages[wanted["name"]]
        for extra in ("", *wanted.get("extra", [])):
            if (wanted["name"], extra) in found:
                continue
            found.add((wanted["name"], extra))
            if extra:
                frontier += package["optional-dependencies"][extra]
            else:
                frontier += package.get("dependencies", [])
    return {name for name, _ in found} - {"control-station"}


def test_requirements_accept_the_locked_files_alone(third_party):
    expected = {
        (package["name"], package["version"]): {f["hash"] for f in files_of(package)}
        for package in third_party
    }

    assert required_hashes("requirements-dev.lock") == expected
    assert all(expected.values())


def test_running_requires_what_the_station_needs_and_no_more(project, third_party):
    everything = required_hashes("requirements-dev.lock")
    needed = needed_to_run(project, third_party)

    assert required_hashes("requirements.lock") == {
        pin: hashes for pin, hashes in everything.items() if pin[0] in needed
    }


def test_lock_holds_the_declared_dependencies(project):
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    metadata = project["metadata"]

    lines = [*settings["project"]["dependencies"]]
    for extra in settings["project"]["optional-dependencies"].values():
        lines += extra
    assert requirements(metadata["requires-dist"]) == declared(lines)
    for group, lines in settings["dependency-groups"].items():
        locked_group = requirements(metadata["requires-dev"][group])
        assert locked_group >= declared(lines), group


def test_packages_come_from_the_public_index_alone(third_party):
    assert {package["source"].get("registry") for package in third_party} == {PYPI}
    urls = [file["url"] for package in third_party for file in files_of(package)]
    assert [url for url in urls if not url.startswith(FILES)] == []


@pytest.mark.parametrize(
    "name", ["uv.lock", "requirements.lock", "requirements-dev.lock", "pyproject.toml"]
)
def test_no_local_path_or_private_index_in(name):
    text = (ROOT / name).read_text()

    assert not re.findall(
        r"file:|--(?:extra-)?index-url|--find-links|://[^/\s]*@", text
    )


def test_lock_is_what_uv_would_write(tmp_path):
    uv = shutil.which("uv", path=str(Path(sys.executable).parent)) or shutil.which("uv")
    if uv is None:
        pytest.skip("uv is not installed")
    environment = {k: v for k, v in os.environ.items() if not k.startswith("UV_")}

    result = subprocess.run(
        [uv, "lock", "--check", "--offline", "--no-config", "--cache-dir", tmp_path],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )

    assert result.returncode == 0, result.stderr
