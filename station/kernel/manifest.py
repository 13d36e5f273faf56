"""What a compiled kernel was built from and for, and what belongs to it."""

import hashlib
import json
import platform
import re
import sys
import sysconfig
from dataclasses import asdict, dataclass, field
from pathlib import Path

from station.kernel.places import SOURCES

MANIFEST = "kernel.json"
"""Name of the file that stands beside the compiled modules."""
_SUFFIXES = (".py", ".pxd")
_RECIPE = "build.py"
"""Compiled with other flags, the same sources are another kernel."""


@dataclass(frozen=True, slots=True)
class Manifest:
    """What a compiled kernel was built from and for.

    Attributes:
        sources: Hash of the sources and of how they are compiled.
        target: Python, operating system and processor that can load it.
        modules: Hash of each compiled module, by the name of its file.
        recipes: Hash of everything that the module was made of, by the same name.
    """

    sources: str
    target: str
    modules: dict[str, str]
    recipes: dict[str, str] = field(default_factory=dict)

    def write(self, directory: Path) -> None:
        """Write it beside the compiled modules."""
        text = json.dumps(asdict(self), indent=2)
        (directory / MANIFEST).write_text(text + "\n", encoding="utf-8")


def read_manifest(directory: Path) -> Manifest | None:
    """Return the manifest of a compiled kernel; None when there is no sound one."""
    try:
        found = json.loads((directory / MANIFEST).read_text(encoding="utf-8"))
        modules, recipes = (
            {str(name): str(digest) for name, digest in found.get(key, {}).items()}
            for key in ("modules", "recipes")
        )
        return Manifest(str(found["sources"]), str(found["target"]), modules, recipes)
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return None


def kernel_modules() -> list[str]:
    """Return the names of the modules that are compiled, sorted."""
    return sorted(path.stem for path in SOURCES.glob("*.pxd"))


def module_file(name: str) -> str:
    """Return the name of the file of a compiled module."""
    return f"{name}{sysconfig.get_config_var('EXT_SUFFIX')}"


def source_digest() -> str:
    """Return the hash of what a kernel is built from."""
    digest = hashlib.sha256()
    files = [f"{name}{suffix}" for name in kernel_modules() for suffix in _SUFFIXES]
    for name in (*files, _RECIPE):
        digest.update(f"{name}\n".encode())
        digest.update((SOURCES / name).read_bytes())
    return digest.hexdigest()


def module_recipes(how: str) -> dict[str, str]:
    """Return the hash of everything that a compiled module is made of, by its name.

    These are its source, the C types of its own and of all that it uses, this Python
    and this machine.

    Args:
        how: The tools and what they are told.
    """
    types = {
        name: (SOURCES / f"{name}.pxd").read_text(encoding="utf-8")
        for name in kernel_modules()
    }
    found = {}
    for name in types:
        used = {name}
        while (more := {each for one in used for each in _used_in(types[one])}) - used:
            used |= more
        text = (SOURCES / f"{name}.py").read_text(encoding="utf-8")
        whole = "\n".join((how, target(), text, *(types[one] for one in sorted(used))))
        found[name] = hashlib.sha256(whole.encode()).hexdigest()
    return found


def _used_in(types: str) -> list[str]:
    """Return the modules of the kernel whose C types others use."""
    return re.findall(r"^from station\.kernel\.(\w+) cimport", types, re.MULTILINE)


def target() -> str:
    """Return what a kernel must be built for: Python, system and processor."""
    abi = sysconfig.get_config_var("SOABI") or sys.implementation.cache_tag
    return f"{abi} {platform.system()} {platform.machine()}"


def fingerprint() -> str:
    """Return the name of the directory of a kernel that fits."""
    whole = f"{source_digest()}\n{target()}"
    return hashlib.sha256(whole.encode()).hexdigest()[:16]


def file_digest(path: Path) -> str:
    """Return the hash of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def find_damage(directory: Path) -> str | None:
    """Return what is wrong with a compiled kernel, one sentence; None if it is sound.

    A library that is cut short ends the process that loads it, so the hashes are looked
    at before.
    """
    manifest = read_manifest(directory)
    if manifest is None:
        return f"{MANIFEST} is missing or broken."
    for name in map(module_file, kernel_modules()):
        path = directory / name
        if not path.is_file():
            return f"{name} is missing."
        if file_digest(path) != manifest.modules.get(name):
            return f"{name} is not the file that was built."
    return None
