"""YAML files in a folder of the user, one for each thing that has a name."""

import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import yaml

from station.core.errors import ConfigError, StationError, show, suggest
from station.core.user_files import (
    changing,
    make_private_folder,
    read_regular,
    user_folder,
)
from station.core.yaml_reader import FILE, parse_yaml

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}")
_SUFFIX = ".yaml"
_REMEDY = "Correct or delete the file, or save it anew."


@dataclass(frozen=True, slots=True)
class FileKind:
    """The kind of files in a folder.

    Attributes:
        noun: Noun for an entry in messages, e.g. `gain set`.
        folder: Name of the folder among the data of the control station.
        not_found: Raised when there is none of a name, or a name is none.
        unusable: Raised when a file cannot be read or written, or is malformed.
    """

    noun: str
    folder: str
    not_found: type[StationError]
    unusable: type[StationError]

    @property
    def key(self) -> str:
        """Key of the name among the details of an error, e.g. `gain_set`."""
        return self.noun.replace(" ", "_")


class YamlFolder:
    """The files of one kind. Any thread.

    Args:
        kind: Noun for the entries in messages.
        folder: Where they are; the user's own folder when None. It is made when the
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
            StationError: There is no such file, or it cannot be read or has no mapping;
                of the kind's own types.
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
        """Write a file; one of that name is replaced.

        Raises:
            StationError: The name is none, or the file cannot be written; of the kind's
                own types.
        """
        path = self._path(name)
        text = yaml.safe_dump(dict(data), sort_keys=False)
        try:
            make_private_folder(path.parent)
            # Under another name first: readers meanwhile, and a station that starts
            # after a crash, find the old file or the new one.
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
            StationError: The name is none, or the file cannot be deleted; of the kind's
                own types.
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
            StationError: The folder cannot be used, or somebody else changes it for too
                long; of the kind's own type.
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
