"""Every file is where a reader looks for it, says what it is, and stays readable."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = sorted((ROOT / "station").rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))

MAX_LINES = 400
GRAB_BAGS = {"common", "helper", "helpers", "misc", "stuff", "util", "utils"}

# Modules that may lack a test file of their own, each with the reason.
UNTESTED: dict[str, str] = {}


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def has_code(path: Path) -> bool:
    """Return whether the module defines a function or a class."""
    tree = ast.parse(path.read_text())
    definitions = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    return any(isinstance(node, definitions) for node in ast.walk(tree))


def has_test(path: Path) -> bool:
    """Return whether `tests/<same path>/test_<module>.py` or a folder for it exists."""
    inside = path.relative_to(ROOT / "station")
    if path.name == "__init__.py":
        name, folder = inside.parent.name or "station", inside.parent
    else:
        name, folder = inside.stem.strip("_"), inside.parent
    mirror = ROOT / "tests" / folder
    return (mirror / f"test_{name}.py").exists() or any(
        (mirror / name).glob("test_*.py")
    )


@pytest.mark.parametrize("path", MODULES + TESTS, ids=relative)
def test_module_says_what_it_is(path):
    assert ast.get_docstring(ast.parse(path.read_text())), (
        f"{relative(path)} needs a docstring in its first line"
    )


@pytest.mark.parametrize("path", MODULES + TESTS, ids=relative)
def test_module_is_short_enough_to_read(path):
    lines = len(path.read_text().splitlines())

    assert lines <= MAX_LINES, f"{relative(path)} has {lines} lines: split it"


@pytest.mark.parametrize("path", MODULES + TESTS, ids=relative)
def test_module_is_named_after_its_concept(path):
    names = {part.removeprefix("test_") for part in path.with_suffix("").parts[-3:]}

    assert not names & GRAB_BAGS, f"{relative(path)}: name the concept"


@pytest.mark.parametrize("path", [m for m in MODULES if has_code(m)], ids=relative)
def test_module_with_code_has_its_test_file(path):
    if relative(path) in UNTESTED:
        assert not has_test(path), f"{relative(path)} has a test: take it off UNTESTED"
        return

    assert has_test(path), (
        f"{relative(path)} needs tests/…/test_{path.stem.strip('_')}.py"
    )


def test_untested_modules_exist():
    missing = {name for name in UNTESTED if not (ROOT / name).exists()}

    assert not missing, "these are gone: take them off UNTESTED"


def test_mirrored_test_files_have_a_module():
    packages = {p.name for p in (ROOT / "station").iterdir() if p.is_dir()}
    folders = [ROOT / "tests" / name for name in packages]

    orphans = [
        relative(folder)
        for top in folders
        for folder in sorted(top.rglob("*"))
        if folder.is_dir()
        and folder.name != "__pycache__"
        and not mirrored(folder.relative_to(ROOT / "tests"))
    ]

    assert not orphans, "these test folders mirror nothing in station/"


def mirrored(folder: Path) -> bool:
    target = ROOT / "station" / folder
    return target.is_dir() or target.with_suffix(".py").exists()
