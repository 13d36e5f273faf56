"""What the station imports it declares, so that nobody's upgrade removes it."""

import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import grimp
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]

# Parts that their declared whole pins and documents as its own.
PART_OF = {"pydantic-core": "pydantic"}
# Suites of tests are imported by whoever has pytest; the station runs without it.
BROUGHT_BY_USERS = {"station.testing": "pytest"}


def third_party_imports() -> dict[str, str]:
    """Return each imported third-party package, with one module that imports it."""
    graph = grimp.build_graph("station", include_external_packages=True, cache_dir=None)
    imports: dict[str, str] = {}
    for module in graph.modules:
        if module.partition(".")[0] != "station":
            continue
        for imported in graph.find_modules_directly_imported_by(module):
            name = imported.partition(".")[0]
            if BROUGHT_BY_USERS.get(".".join(module.split(".")[:2])) != name:
                imports[name] = module
    return imports


def test_imported_packages_are_declared():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    declared = {
        canonicalize_name(Requirement(line).name) for line in settings["dependencies"]
    }
    providers = packages_distributions()

    undeclared = {}
    for package, module in third_party_imports().items():
        if package == "station" or package in sys.stdlib_module_names:
            continue
        names = {canonicalize_name(name) for name in providers.get(package, [package])}
        if not {PART_OF.get(name, name) for name in names} & declared:
            undeclared[package] = module

    assert not undeclared, "add these to the dependencies in pyproject.toml"
