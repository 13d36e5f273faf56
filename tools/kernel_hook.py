"""Put a compiled kernel into the wheel, where the station looks for it.

Without a C compiler the wheel has none, is for any machine, and runs interpreted.
`STATION_WHEEL_KERNEL=1` makes that an error: wheels that are published carry a kernel.
"""

import os
import sys
import tempfile
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

REQUIRED = "STATION_WHEEL_KERNEL"


class KernelHook(BuildHookInterface):
    """Compiles the kernel while a wheel is built."""

    PLUGIN_NAME = "custom"

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile the kernel and name the wheel after the Python that can load it.

        Args:
            version: `standard` or `editable`; an editable station builds its own.
            build_data: What hatchling puts into the wheel.

        Raises:
            RuntimeError: A tool is missing, and a kernel is required.
        """
        if version == "editable":
            return
        self._folder = tempfile.TemporaryDirectory()
        built, scratch = (Path(self._folder.name) / n for n in ("kernel", "scratch"))
        scratch.mkdir()
        # The station is not installed yet, and its kernel needs nothing that it needs.
        os.environ["STATION_COMPILED"] = "0"
        sys.path.insert(0, self.root)
        from station.kernel.build import build_into
        from station.kernel.manifest import fingerprint
        from station.kernel.toolchain import missing_tool

        if (missing := missing_tool()) is not None:
            if os.environ.get(REQUIRED) == "1":
                raise RuntimeError(f"{REQUIRED}=1, and: {missing}")
            self.app.display_warning(f"The wheel has no compiled kernel. {missing}")
            return
        build_into(built, scratch, jobs=os.cpu_count() or 1)
        inside = f"station/kernel/compiled/{fingerprint()}"
        for file in built.iterdir():
            build_data["force_include"][str(file)] = f"{inside}/{file.name}"
        build_data["pure_python"] = False
        build_data["infer_tag"] = True

    def finalize(self, version: str, *_: object) -> None:
        """Remove what was compiled.

        Args:
            version: As in `initialize`.
        """
        if version != "editable":
            self._folder.cleanup()
