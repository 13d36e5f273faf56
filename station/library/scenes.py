"""Scenes on disk: the objects with a role, saved under a name."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from typing_extensions import override

from station.core.errors import SavedSceneError, SavedSceneNotFoundError
from station.core.geometry.scene import read_object
from station.library.yaml_folder import FileKind, Library
from station.reports import SavedScene

_KIND = FileKind("scene", "scenes", SavedSceneNotFoundError, SavedSceneError)


class SavedScenes(Library[SavedScene]):
    """The scenes in a folder. Any thread.

    Args:
        folder: Folder of the files; the user's own folder when None.
    """

    def __init__(self, folder: Path | None = None) -> None:
        super().__init__(_KIND, folder)

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
