"""What the station imports it declares, so that nobody's upgrade removes it."""

import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import grimp
import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]

# Parts that their declared whole pins and documents as its own.
PART_OF = {"pydantic-core": "pydantic", "mcp-types": "mcp"}
# Imported by whoever has the package; the station runs without it.
BROUGHT_BY_USERS = {
    ("station.testing", "pytest"),
    ("station.client", "pandas"),
    ("station.pytest_plugin", "pytest"),
}


def third_party_imports() -> dict[str, str]:
    """Return each imported third-party package, with one module that imports it."""
    graph = grimp.build_graph("station", include_external_packages=True, cache_dir=None)
    imports: dict[str, str] = {}
    for module in graph.modules:
        if module.partition(".")[0] != "station":
            continue
        for imported in graph.find_modules_directly_imported_by(module):
            name = imported.partition(".")[0]
            if (".".join(module.split(".")[:2]), name) not in BROUGHT_BY_USERS:
                imports[name] = module
    return imports


def test_imported_packages_are_declared():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = [*settings["dependencies"]]
    for extra in settings["optional-dependencies"].values():
        lines += extra
    declared = {canonicalize_name(Requirement(line).name) for line in lines}
    providers = packages_distributions()

    undeclared = {}
    for package, module in third_party_imports().items():
        if package == "station" or package in sys.stdlib_module_names:
            continue
        names = {canonicalize_name(name) for name in providers.get(package, [package])}
        if not {PART_OF.get(name, name) for name in names} & declared:
            undeclared[package] = module

    assert not undeclared, "add these to the dependencies in pyproject.toml"


ALONE = """
import importlib.metadata, sys
from packaging.requirements import Requirement

wanted, needed = ["control-station"], set()
while wanted:
    name = wanted.pop()
    if name in needed:
        continue
    needed.add(name)
    for line in importlib.metadata.requires(name) or ():
        requirement = Requirement(line)
        if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
            wanted.append(requirement.name.lower().replace("_", "-"))
providers = importlib.metadata.packages_distributions()

class WithoutExtras:
    def __init__(self, finder):
        self.finder = finder

    def find_spec(self, name, path=None, target=None):
        owners = {owner.lower().replace("_", "-") for owner in providers.get(name, ())}
        if owners and not owners & needed:
            return None
        return self.finder.find_spec(name, path, target)

sys.meta_path[:] = map(WithoutExtras, sys.meta_path)
"""


def run_alone(code: str) -> subprocess.CompletedProcess[str]:
    """Run code that sees what `pip install control-station` installs, no extra."""
    return subprocess.run(
        [sys.executable, "-c", ALONE + code],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_package_of_an_extra_is_not_found():
    """With stale extensions the station looks for Cython, and runs the sources."""
    done = run_alone("import importlib.util as u; print(u.find_spec('Cython'))")

    assert done.stdout == "None\n", done.stderr


def test_client_and_command_line_need_no_extra():
    modules = [
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for folder in ("client", "cli", "wire", "config", "local")
        for path in sorted((ROOT / "station" / folder).rglob("*.py"))
        if path.name != "__init__.py"
    ]
    # It is a server, of the dashboard.
    modules.remove("station.cli.verbs.ui")

    done = run_alone(f"for m in {modules}: __import__(m)")

    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "arguments", [["run"], ["ui", "--connect", "http://127.0.0.1:9", "--token", "t"]]
)
def test_verb_that_misses_an_extra_says_how_to_get_it(arguments):
    done = run_alone(f"from station.cli import main; sys.exit(main({arguments}))")

    assert done.returncode == 1
    assert "control-station brings it with the extra" in done.stderr
    assert "uses the extra 'all'" in done.stderr


def test_station_in_a_program_names_its_extra_before_anything_is_fetched():
    done = run_alone("import station; station.open()")

    assert "MissingExtraError" in done.stderr
    assert "with the extra core or sim" in done.stderr
    assert "Fetching" not in done.stderr
