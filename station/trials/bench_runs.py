"""Keep the runs of the bench on disk, one JSON file each."""

import threading
from pathlib import Path

from pydantic import ValidationError

from station.core.errors import suggest
from station.core.user_files import make_private_folder, user_folder
from station.trials.bench_analysis import gain_names
from station.trials.errors import BenchRunNotFoundError, ExperimentError
from station.wire.excitations import BenchResponse, BenchRun

_SUFFIX = ".json"


class KeptRuns:
    """The kept runs in a folder. Any thread.

    Args:
        folder: Folder of the files; the user's own folder when None. It is made when
            the first run is kept.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        self._lock = threading.Lock()
        self._known: dict[str, tuple[int, BenchRun]] = {}

    @property
    def folder(self) -> Path:
        """Return the folder of the files."""
        return self._folder or user_folder("bench-runs")

    def keep(self, run: BenchResponse, name: str | None) -> BenchResponse:
        """Keep a run and return it with its name.

        Args:
            run: The run.
            name: Its name; it replaces a run of the same name. None makes a name of the
                kind and a number.

        Raises:
            ExperimentError: The file cannot be written.
        """
        with self._lock:
            if name is None:
                taken = {path.stem for path in self.folder.glob(f"*{_SUFFIX}")}
                number = len(taken) + 1
                while f"{run.kind}-{number}" in taken:
                    number += 1
                name = f"{run.kind}-{number}"
            kept = run.model_copy(update={"name": name})
            path = self._path(name)
            part = path.with_suffix(".part")
            try:
                make_private_folder(path.parent)
                # Write under another name first, so that a reader finds the old file or
                # the new one.
                part.write_text(kept.model_dump_json(), "utf-8")
                part.replace(path)
            except OSError as error:
                raise ExperimentError(f"{path} cannot be written: {error}.") from error
        return kept

    def list(self) -> list[BenchRun]:
        """Return all runs without their curves, the oldest first.

        Files that cannot be read are left out.
        """
        found = []
        with self._lock:
            for path in self.folder.glob(f"*{_SUFFIX}"):
                try:
                    stamp = path.stat().st_mtime_ns
                    known = self._known.get(path.stem)
                    if known is None or known[0] != stamp:
                        known = self._known[path.stem] = stamp, self._summary(path)
                except (OSError, ValueError):
                    continue  # a foreign file, or one deleted meanwhile
                found.append(known)
        return [run for _, run in sorted(found, key=lambda one: one[0])]

    def get(self, name: str) -> BenchResponse:
        """Return a run.

        Raises:
            BenchRunNotFoundError: There is no such run.
            ExperimentError: Its file cannot be read.
        """
        path = self._path(name)
        try:
            return self._read(path)
        except FileNotFoundError as error:
            raise BenchRunNotFoundError(
                f"There is no run '{name}' of the bench.",
                remedy=suggest(name, [run.name for run in self.list()]),
                details={"run": name},
            ) from error
        except (OSError, ValidationError) as error:
            raise ExperimentError(
                f"{path} cannot be read: {error}.", remedy="Delete it."
            ) from error

    def delete(self, name: str) -> BenchResponse:
        """Delete a run and return it.

        Raises:
            BenchRunNotFoundError: There is no such run.
            ExperimentError: Its file cannot be read.
        """
        found = self.get(name)
        with self._lock:
            self._path(name).unlink(missing_ok=True)
            self._known.pop(name, None)
        return found

    def _path(self, name: str) -> Path:
        return self.folder / f"{name}{_SUFFIX}"

    def _summary(self, path: Path) -> BenchRun:
        run = self._read(path)
        names = gain_names(run.gains, run.joint)
        gains = {key: run.gains[name] for key, name in names.items()}
        values = {
            name: getattr(run, name)
            for name in ("name", "created_at", "controller", "joint", "kind", "metrics")
        }
        return BenchRun(gains=gains, **values)

    @staticmethod
    def _read(path: Path) -> BenchResponse:
        return BenchResponse.model_validate_json(path.read_bytes())
