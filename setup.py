"""Compile the modules that have a `.pxd` file beside them; see `station/compiled.py`.

`python setup.py build_ext --inplace` does it in a checkout, where an editable
installation leaves it to the first start of the station; a wheel carries what is
compiled.
Without a C compiler a wheel has none, is for any machine, and runs interpreted.
`STATION_COMPILED=1` makes that an error: wheels that are published have them.
"""

import os
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import ClassVar

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).parent
sys.path.insert(0, str(ROOT))

from station import compiled  # noqa: E402 - the package lies beside this file
from station.compiled_finder import SHARED, SUFFIX  # noqa: E402

# Nothing but the baseline of the processor's family, and no contraction to fused
# operations, which round differently.
FLAGS = ["-O2", "-g0", "-fwrapv", "-w", "-ffp-contract=off", "-fno-fast-math"]
# Cython counts the users of a view with atomic operations, some fifty in a cycle, each
# of which waits for a line of the cache. All of them hold the interpreter lock, where
# there is one.
PLAIN_COUNTS = [
    "-D__STDC_NO_ATOMICS__",
    "-D__sync_fetch_and_add(place, change)=((*(place) += (change)) - (change))",
    "-D__sync_fetch_and_sub(place, change)=((*(place) -= (change)) + (change))",
]
DIRECTIVES = {
    "language_level": 3,
    "boundscheck": False,
    "wraparound": False,
    "initializedcheck": False,
    "cdivision": True,
    "infer_types": True,
    # The types are those of the .pxd; `int` in the .py would be a Python object.
    "annotation_typing": False,
    # A sixth of the compiler's time, for what is never sent to another process.
    "auto_pickle": False,
}


def extensions() -> list[Extension]:
    """Return the extensions to build; none where a tool is missing.

    Raises:
        SystemExit: A tool is missing, and `STATION_COMPILED=1`.
    """
    if (missing := compiled.missing_tool()) is not None:
        if os.environ.get(compiled.SWITCH) == "1":
            raise SystemExit(f"{compiled.SWITCH}=1, but: {missing}")
        sys.stderr.write(f"station: not compiled. {missing}\n")
        return []
    sources = {
        name: [str(path.relative_to(ROOT))]
        for name, path in sorted(compiled.compiled_modules().items())
    }
    return [
        Extension(name, files, extra_compile_args=FLAGS + PLAIN_COUNTS, libraries=["m"])
        for name, files in {SHARED: [], **sources}.items()
    ]


class BuildExtensions(build_ext):
    """Builds all extensions, tries them, and records that they are complete."""

    user_options: ClassVar = [
        *build_ext.user_options,
        ("idle", None, "build in idle time alone"),
        ("lock=", None, "descriptor of the lock that the caller has taken"),
    ]
    boolean_options: ClassVar = [*build_ext.boolean_options, "idle"]

    def initialize_options(self) -> None:
        """Set the options to what they are without being asked for."""
        super().initialize_options()
        self.idle = False
        self.lock = None
        self.parallel = len(os.sched_getaffinity(0))

    def run(self) -> None:
        """Build; an editable installation does not wait for a compiler."""
        if self.editable_mode or not self.extensions:
            return
        if self.idle:
            # The control loop of the station beside it has the processors first.
            os.setpriority(os.PRIO_PROCESS, 0, 19)
            os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
        with compiled.building() if self.lock is None else nullcontext():
            self._build_and_record()

    def _build_and_record(self) -> None:
        package = (ROOT if self.inplace else Path(self.build_lib)) / "station"
        if self.inplace and compiled.find_misfit() is None and not self.force:
            return
        sources = compiled.source_digest(), compiled.recipe_digest() or ""
        compiled.record_path(package).unlink(missing_ok=True)
        is_for_here = self.inplace
        try:
            self._build()
            if compiled.source_digest() != sources[0]:
                raise SystemExit("The sources have changed during the build.")
            self._delete_others(package)
            compiled.built_record(package).write(package)
            if is_for_here:  # a wheel is built without the station's dependencies
                self._try_import()
        except BaseException as error:
            text = str(error).strip().splitlines() or [type(error).__name__]
            compiled.BuildRecord(*sources, "", {}, text[-1]).write(package)
            raise

    def _delete_others(self, package: Path) -> None:
        """Delete the extensions of modules that are compiled no longer, or are gone."""
        kept = {extension.name for extension in self.extensions}
        for path in package.rglob(f"*{SUFFIX}"):
            inside = path.relative_to(package.parent).as_posix().removesuffix(SUFFIX)
            if inside.replace("/", ".") not in kept:
                path.unlink()

    def _build(self) -> None:
        from Cython.Build import cythonize
        from Cython.Compiler import Options

        # A view in an object takes 64 bytes in place of 208 if an array has one
        # dimension.
        Options.buffer_max_dims = 2
        made = cythonize(
            self.extensions,
            build_dir=str(ROOT / "build" / "cython"),
            compiler_directives=DIRECTIVES,
            nthreads=self.parallel,
            quiet=True,
            shared_utility_qualified_name=SHARED,
        )
        c_files = {each.name: each for each in made}
        for extension in self.extensions:
            extension.sources = c_files[extension.name].sources
            extension.depends = [*c_files[extension.name].depends, "setup.py"]
        super().run()

    def _try_import(self) -> None:
        """Import every extension in another process.

        Raises:
            SystemExit: One of them cannot be imported.
        """
        names = ", ".join(extension.name for extension in self.extensions)
        environment = {**os.environ, compiled.SWITCH: "1"}
        result = subprocess.run(
            [sys.executable, "-c", f"import {names}"],
            cwd=ROOT,
            env=environment,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
        if result.returncode:
            raise SystemExit(result.stderr or f"Python ended: {result.returncode}.")


setup(ext_modules=extensions(), cmdclass={"build_ext": BuildExtensions})
