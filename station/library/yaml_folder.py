"""YAML files in a folder of the user, one for each named thing: plot layouts, scenes.

Plot layouts are the plots that a page shows; scenes are the objects with a role.
"""

import os
import re
import tempfile
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from math import inf
from pathlib import Path
from typing import Generic, TypeVar

import yaml
from pydantic import TypeAdapter, ValidationError
from typing_extensions import override

from station.core.errors import (
    ConfigError,
    PlotLayoutError,
    PlotLayoutNotFoundError,
    SavedSceneError,
    SavedSceneNotFoundError,
    StationError,
    show,
    suggest,
)
from station.core.geometry.scene import read_object
from station.core.user_files import (
    changing,
    make_private_folder,
    read_regular,
    user_folder,
)
from station.core.yaml_reader import FILE, parse_yaml
from station.reports import DockSettings, PlotLayout, PlotSettings, SavedScene

ThingT = TypeVar("ThingT")
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")
_SUFFIX = ".yaml"
_REMEDY = "Correct or delete the file, or save it anew."


@dataclass(frozen=True, slots=True)
class FileKind:
    """The kind of files in a folder.

    Attributes:
        noun: Noun for an entry in messages, e.g. `gain set`.
        folder: Name of the folder below the folder of the station's data.
        not_found: Raised when no file has the name, or the name is not allowed.
        unusable: Raised when a file cannot be read or written, or is malformed.
    """

    noun: str
    folder: str
    not_found: type[StationError]
    unusable: type[StationError]

    @property
    def key(self) -> str:
        """Key under which the details of an error have the name, e.g. `gain_set`."""
        return self.noun.replace(" ", "_")


class YamlFolder:
    """The files of one kind. Any thread.

    Args:
        kind: Kind of the files, with its noun and its errors.
        folder: Folder of the files; the user's own one when None. It is made when the
            first file is written.
    """

    def __init__(self, kind: FileKind, folder: Path | None = None) -> None:
        self._kind = kind
        self._folder = folder

    @property
    def folder(self) -> Path:
        """Return the folder of the files."""
        return self._folder or user_folder(self._kind.folder)

    def names(self) -> list[str]:
        """Return the names of all files, sorted."""
        try:
            found = [p.stem for p in self.folder.glob(f"*{_SUFFIX}") if p.is_file()]
        except OSError:
            return []
        return sorted(name for name in found if _NAME.fullmatch(name))

    def read(self, name: str) -> Mapping[str, object]:
        """Return the content of a file.

        Raises:
            StationError: The file does not exist, cannot be read or holds no mapping.
                The type is one of the two that `kind` names.
        """
        path = self._path(name)
        try:
            text = read_regular(path, FILE.characters)
        except FileNotFoundError as error:
            raise self._kind.not_found(
                f"There is no {self._kind.noun} '{name}'.",
                remedy=suggest(name, self.names()),
                details={self._kind.key: name},
            ) from error
        except (OSError, UnicodeDecodeError) as error:
            raise self.unusable(name, error) from error
        try:
            return parse_yaml(text, path.name).values
        except ConfigError as error:
            raise self.unusable(name, error.message.rstrip(".")) from error

    def write(self, name: str, data: Mapping[str, object]) -> None:
        """Write a file; it replaces a file of the same name.

        Raises:
            StationError: The name is not allowed, or the file cannot be written. The
                type is one of the two that `kind` names.
        """
        path = self._path(name)
        text = yaml.safe_dump(dict(data), sort_keys=False)
        try:
            make_private_folder(path.parent)
            # Write under another name first, so that a reader, or a station that starts
            # after a crash, finds either the old file or the new one.
            with tempfile.NamedTemporaryFile(
                "w", dir=path.parent, suffix=".part", delete=False, encoding="utf-8"
            ) as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            Path(file.name).replace(path)
        except OSError as error:
            raise self.unusable(name, error) from error

    def delete(self, name: str) -> None:
        """Delete a file, if there is one.

        Raises:
            StationError: The name is not allowed, or the file cannot be deleted. The
                type is one of the two that `kind` names.
        """
        try:
            self._path(name).unlink(missing_ok=True)
        except OSError as error:
            raise self.unusable(name, error) from error

    @contextmanager
    def changing(self, name: str) -> Iterator[None]:
        """Keep other threads and stations from changing files in the body of a `with`.

        Args:
            name: The file that is to be changed.

        Raises:
            StationError: The folder cannot be used, or another process keeps its lock
                for too long. The type is `kind.unusable`.
        """
        with ExitStack() as stack:
            try:
                stack.enter_context(changing(self.folder))
            except OSError as error:
                raise self.unusable(name, error) from error
            yield

    def unusable(self, name: str, why: object) -> StationError:
        """Return the error that says why a file cannot be used."""
        path = self.folder / f"{name}{_SUFFIX}"
        return self._kind.unusable(
            f"The {self._kind.noun} in {path} cannot be used: {why}.", remedy=_REMEDY
        )

    def _path(self, name: str) -> Path:
        if not _NAME.fullmatch(name):
            raise self._kind.not_found(
                f"{show(name)} is no name of a {self._kind.noun}.",
                remedy="Use letters, digits, '_', '.' and '-', 100 at most.",
                details={self._kind.key: name},
            )
        return self.folder / f"{name}{_SUFFIX}"


class Library(Generic[ThingT]):
    """Things of one kind that an operator keeps by name, a YAML file each. Any thread.

    Args:
        kind: Kind of the things, with its noun and its errors.
        folder: Folder of the files; the user's own folder when None. It is made when
            the first thing is saved.
    """

    def __init__(self, kind: FileKind, folder: Path | None = None) -> None:
        self._files = YamlFolder(kind, folder)

    @property
    def folder(self) -> Path:
        """Return the folder of the files."""
        return self._files.folder

    def names(self) -> list[str]:
        """Return the names of all things, sorted."""
        return self._files.names()

    def get(self, name: str) -> ThingT:
        """Return a thing.

        Raises:
            StationError: No file has that name, or the file cannot be read or is
                malformed. The type is one of the two that `kind` names.
        """
        data = self._files.read(name)
        try:
            return self._parse(name, str(data.get("saved_at", "")), data)
        except ValidationError as error:
            first = error.errors()[0]
            place = "/".join(map(str, first["loc"])) or "its content"
            why = f"{place}: {first['msg']}"
            raise self._files.unusable(name, why) from error
        except (ValueError, StationError) as error:
            raise self._files.unusable(name, error) from error

    def delete(self, name: str) -> ThingT:
        """Delete a thing and return it.

        Raises:
            StationError: No file has that name, or the file cannot be read or deleted.
                The type is one of the two that `kind` names.
        """
        with self._files.changing(name):
            found = self.get(name)
            self._files.delete(name)
            return found

    @abstractmethod
    def _parse(self, name: str, saved_at: str, data: Mapping[str, object]) -> ThingT:
        """Return the thing in a file; raise `ValueError` if it is malformed."""

    def _write(self, name: str, content: Mapping[str, object]) -> str:
        """Write the content of a thing; return the time of the write, ISO 8601."""
        now = datetime.now(UTC).isoformat(timespec="seconds")
        self._files.write(name, {"saved_at": now, **content})
        return now


_PLOT_LAYOUT = FileKind(
    "plot layout", "plot-layouts", PlotLayoutNotFoundError, PlotLayoutError
)
_PLOTS = TypeAdapter(tuple[PlotSettings, ...])
_DOCKS = TypeAdapter(DockSettings | None)


class PlotLayouts(Library[PlotLayout]):
    """The plot layouts in a folder. Any thread.

    Args:
        folder: Folder of the files; the user's own folder when None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        super().__init__(_PLOT_LAYOUT, folder)

    def save(
        self,
        name: str,
        plots: Sequence[PlotSettings],
        docks: DockSettings | None = None,
    ) -> PlotLayout:
        """Save a layout; it replaces a layout of the same name.

        Args:
            name: Its name.
            plots: Its plots.
            docks: Folds and sizes of the docks; None keeps those of the layout.

        Raises:
            PlotLayoutNotFoundError: The name is not allowed.
            PlotLayoutError: The file cannot be written.
        """
        with self._files.changing(name):
            if docks is None and name in self.names():
                docks = self.get(name).docks
            content: dict[str, object] = {"plots": [asdict(plot) for plot in plots]}
            if docks is not None:
                content["docks"] = asdict(docks)
            now = self._write(name, content)
        return PlotLayout(name, now, tuple(plots), docks)

    @override
    def _parse(
        self, name: str, saved_at: str, data: Mapping[str, object]
    ) -> PlotLayout:
        plots = _PLOTS.validate_python(data.get("plots"))
        for number, plot in enumerate(plots, 1):
            if not 0.0 < plot.span < inf:
                raise ValueError(f"its plot {number} shows {plot.span} s")
        return PlotLayout(
            name, saved_at, plots, _DOCKS.validate_python(data.get("docks"))
        )


_SCENE = FileKind("scene", "scenes", SavedSceneNotFoundError, SavedSceneError)


class SavedScenes(Library[SavedScene]):
    """The scenes in a folder. Any thread.

    Args:
        folder: Folder of the files; the user's own folder when None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        super().__init__(_SCENE, folder)

    def save(self, name: str, objects: Sequence[Mapping[str, object]]) -> SavedScene:
        """Save the objects of a scene; they replace a scene of the same name.

        Args:
            name: Its name.
            objects: The objects, in the form of `scene/objects` in the configuration.

        Raises:
            SavedSceneNotFoundError: The name is not allowed.
            SavedSceneError: The file cannot be written.
        """
        entries = [dict(one) for one in objects]
        with self._files.changing(name):
            now = self._write(name, {"objects": entries})
        return SavedScene(name, now, entries)

    @override
    def _parse(
        self, name: str, saved_at: str, data: Mapping[str, object]
    ) -> SavedScene:
        objects = data.get("objects")
        if not isinstance(objects, list):
            raise ValueError("it has no list 'objects'")  # noqa: TRY004 - of a file
        for number, entry in enumerate(objects):
            read_object(entry, f"objects/{number}")
        return SavedScene(name, saved_at, objects)
